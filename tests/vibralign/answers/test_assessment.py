"""Verdicts, bases and leeways of a device, against oracles and against runs of the model."""

import importlib
import math
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from model.sweeps.settings import Ensemble
from model.sweeps.starts import every_start, starts_of
from vibralign import Settings
from vibralign.answers import leeways as module
from vibralign.answers import reliability
from vibralign.answers.assess import Assessment, assess
from vibralign.answers.cases import cases_of
from vibralign.answers.causes import Cause, first_change
from vibralign.answers.leeways import (
    ADDED,
    AT_ONCE,
    BEYOND,
    FINEST,
    PARTS,
    STEP,
    STEPS,
    VARIED,
    a_step_inside,
    leeways,
    nearest,
)
from vibralign.answers.reliability import are_reliable, reliable_at, run_devices
from vibralign.answers.sheet import sheet_rows
from vibralign.answers.si import written_words
from vibralign.answers.verdicts import Base, Verdict
from vibralign.device import load_device
from vibralign.device.batches import devices_of

PEG = Path(__file__).resolve().parents[2] / "square" / "peg.yaml"
NEAR = STEP ** (1.0 / PARTS[0]) * 1.001  # ratio within which a nearest value is known
ENSEMBLE = Ensemble(phases=3, tilts=[1.0, 3.0], every=1)
COARSE = Settings(horizon=60.0, tolerance=1e-7)
OWN_BASE = {"contact_stiffness": "300 kN/m", "gripper_tilt": "0.1 deg"}
EVERY = {"mass", "axial_stiffness", "amplitude", *VARIED, *ADDED}


@pytest.fixture
def device():
    """A square peg on a stated base, lowered suddenly."""
    return load_device(PEG, OWN_BASE)


def oracle(device, **limits):
    """A device reliable where each of ``limits`` (lowest, highest) holds, and the calls."""
    calls, own = [], {**device.values, **device.quantities}

    def is_reliable(swept):
        calls.append(swept)
        count = len(next(iter(swept.values())))
        reliable = np.ones(count, dtype=bool)
        for name, (low, high) in limits.items():
            values = swept.get(name, np.full(count, own[name]))
            reliable &= (low <= values) & (values <= high)
        return reliable

    return is_reliable, calls


def test_a_leeway_ends_less_than_half_a_per_cent_before_a_failure(device):
    device = device.changed(press_force=2.0, friction=0.1)
    is_reliable, _ = oracle(device, press_force=(1.5, 2.9), friction=(0.0, 0.15))
    found = {each.parameter: each for each in leeways(device, is_reliable)}
    force, friction = found["press_force"], found["friction"]
    assert FINEST < 0.005
    assert force.low / (1.0 + FINEST) < 1.5 <= force.low
    assert force.high <= 2.9 < force.high * (1.0 + FINEST)
    assert None not in (force.fails_below, force.fails_above)
    assert friction.low == pytest.approx(0.1 * STEP**-STEPS)
    assert friction.high <= 0.15 < friction.high * (1.0 + FINEST)
    assert (friction.fails_below, friction.fails_above is None) == (None, False)


def test_one_parameter_varies_at_a_time_and_few_values_beyond_an_end(device):
    own = {**device.values, **device.quantities}
    is_reliable, calls = oracle(device, press_force=(9.9, np.inf))
    assert {each.parameter for each in leeways(device, is_reliable)} == EVERY
    for swept in calls:
        assert (sum(values != own[name] for name, values in swept.items()) == 1).all()
    # Steps, parts of one, parts of such a part, values about the end.
    assert len(calls) == STEPS // AT_ONCE + 3
    lower = [value for swept in calls for value in swept["press_force"] if value < 9.9]
    assert len(lower) <= AT_ONCE + sum(PARTS) + BEYOND


def test_steps_may_be_tried_roughly_and_an_end_never_is(device):
    """The end of a range is the true one, although its rough trials are off by 5 %."""
    device = device.changed(press_force=2.0)
    roughly, steps = oracle(device, press_force=(0.0, 2.9 * 0.95))
    is_reliable, parts = oracle(device, press_force=(0.0, 2.9))
    found = leeways(device, is_reliable, roughly=roughly)
    # Two steps of which one only seemed to fail, parts, parts of a part, about the end.
    assert (len(steps), len(parts)) == (STEPS // AT_ONCE, 5)
    assert found == leeways(device, is_reliable)


def test_an_end_moves_inwards_past_the_failures_of_a_ragged_border(device):
    """Failing values between the own value and the end are found to some 3 %, near it to 0.4 %."""
    device = device.changed(press_force=2.0)

    def ragged(*holes):
        def is_reliable(swept):
            force = swept["press_force"]
            fails = [(low <= force) & (force <= high) for low, high in holes]
            return (force < 3.0) & ~np.logical_or.reduce(fails)

        [found] = leeways(device, is_reliable, held=EVERY - {"press_force"})
        return found

    clean = ragged()
    assert (clean.ragged_above, clean.fails_below) == (False, None)
    assert clean.fails_above <= clean.high * (1.0 + FINEST)
    near = ragged((2.94, 2.952))
    assert near.ragged_above
    assert near.high < 2.94 <= near.fails_above <= 2.952
    far = ragged((2.94, 2.952), (2.3, 2.35))  # between two steps
    assert far.high < 2.3 <= far.fails_above <= 2.35
    own = ragged((2.94, 2.952), (2.001, 2.11))
    assert (own.high, own.ragged_above) == (2.0, True)
    again = ragged((3.0, 3.005), (3.01, np.inf))
    assert not again.ragged_above  # all beyond fails


def test_trials_stop_at_the_bound_of_a_parameter_and_zero_has_no_leeway(device):
    most = 5e-3 * 2.04
    device = device.changed(misalignment=0.9 * most, friction=0.0)
    found = {each.parameter: each for each in leeways(device, oracle(device)[0])}
    assert found.keys() == EVERY - {"friction"}
    wide = found["misalignment"]
    assert wide.high < most < wide.high * STEP
    assert wide.fails_above is None


def test_the_nearest_reliable_values_have_a_direction(device):
    device = device.changed(press_force=2.0)
    [force] = nearest(device, oracle(device, press_force=(2.3, 5.0))[0])
    assert (force.parameter, force.below) == ("press_force", None)
    assert force.above / NEAR < 2.3 <= force.above
    [force] = nearest(device, oracle(device, press_force=(1.0, 1.7))[0])
    assert force.below <= 1.7 < force.below * NEAR
    assert nearest(device, oracle(device, press_force=(100.0, 200.0))[0]) == ()


def test_values_that_may_not_hold_and_those_beyond_one_that_holds_are_not_tried(device):
    device = device.changed(press_force=2.0)
    is_reliable, asked = oracle(device, press_force=(2.3, 5.0))
    may_be = oracle(device, press_force=(2.25, 6.0))[0]
    found = nearest(device, is_reliable, (), may_be)
    tried = [force for swept in asked for force in swept["press_force"].tolist()]
    assert tried == [2.378, 2.278, 2.311]  # a step that holds, and parts of it up to one that does
    assert found == nearest(device, is_reliable)


@pytest.mark.parametrize(
    ("reliable", "border", "advised"),
    [((2.3, 5.0), 2.3, 2.437), ((1.0, 1.7), 1.7, 1.605), ((2.3, 2.4), 2.3, 2.3)],
)
def test_the_first_change_is_a_step_inside_where_that_is_reliable(
    device, reliable, border, advised
):
    device = device.changed(press_force=2.0)
    is_reliable, _ = oracle(device, press_force=reliable)
    found = a_step_inside(device, is_reliable, {"press_force": border})
    assert found == {"press_force": advised}
    assert a_step_inside(device, is_reliable, {}) == {}


def test_the_model_is_reliable_up_to_a_leeway_and_not_beyond(device, monkeypatch):
    monkeypatch.setattr(module, "VARIED", ("press_force", "tilt_stiffness", "friction"))
    monkeypatch.setattr(module, "UNITS", ())
    found = assess(device, COARSE, ENSEMBLE)
    assert (found.reliable, found.starts, found.aligned) == (True, 3, 3)
    starts = cases_of(device, ENSEMBLE)
    bounded = [each for each in found.leeways if each.fails_above is not None]
    assert bounded
    for leeway in bounded:
        values = {leeway.parameter: np.array([leeway.high, leeway.high * (1.0 + FINEST)])}
        reliable = are_reliable(device, values, starts, COARSE)
        assert reliable.tolist() == [True, False], leeway.parameter


def test_an_unreliable_device_is_reliable_at_its_nearest_values(device):
    device = device.changed(tilt_stiffness=30.0)
    found = assess(device, COARSE, ENSEMBLE)
    assert not found.reliable
    assert found.leeways == ()
    assert found.nearest
    starts = cases_of(device, ENSEMBLE)
    for each in found.nearest:
        ends = [end for end in (each.below, each.above) if end is not None]
        values = {each.parameter: np.array(ends)}
        assert are_reliable(device, values, starts, COARSE).all(), each.parameter


SHAFT = PEG.parent / "devices" / "shaft.yaml"
SI = ["mass", "axial_stiffness", "amplitude", "lateral_stiffness", "inertia", "press_force"]


def test_a_device_in_si_units_is_varied_in_all_of_them_as_set_does():
    stated = load_device(SHAFT)
    asked = []

    def is_reliable(values):
        asked.append(values)
        return np.ones(len(next(iter(values.values()))), dtype=bool)

    found = {each.parameter: each for each in leeways(stated, is_reliable)}
    assert set(found) == EVERY
    for name in SI:
        assert found[name].value == stated.quantities[name]
        assert found[name].high == pytest.approx(4.0 * stated.quantities[name])
        assert found[name].low == pytest.approx(stated.quantities[name] / 4.0)
    for values in asked:  # what follows from others, such as the base, follows still
        some = {name: column[:40:7] for name, column in values.items()}
        own = {**stated.values, **stated.quantities}
        for i, parameters in enumerate(devices_of(stated, some)[0]):
            changes = {n: v[i] for n, v in some.items() if v[i] != own[n]}
            assert parameters == load_device(SHAFT, changes).parameters


def test_what_a_file_states_in_place_of_a_parameter_is_varied_and_named():
    stated = load_device(PEG, {"play": "20 um", "tilt_frequency": "20 Hz"})
    asked = []

    def is_reliable(values):
        asked.append(values)
        return values["play"] < 30e-6

    found = {each.parameter: each for each in leeways(stated, is_reliable)}
    assert not {"clearance", "tilt_stiffness"} & {*found, *asked[0]}
    assert found["play"].high == pytest.approx(30e-6, rel=FINEST)
    assert written_words("play", found["play"].high, stated) == f"{1e6 * found['play'].high:.4g} um"
    near = nearest(stated, lambda values: values["play"] > 30e-6)
    cause = Cause("it wedges", (("clearance", 1),))
    assert [*first_change(cause, near)] == ["play"]


def test_verdicts_do_not_depend_on_failures_before_and_cases_that_failed_come_first(
    device, monkeypatch
):
    values = {"press_force": np.array([2.0, 8.0, 30.0])}
    starts = cases_of(device, Ensemble(phases=6, tilts=[1.0], every=1))
    expected = are_reliable(device, values, starts, COARSE)
    assert expected.any()
    assert not expected.all()
    run, tried = reliability.every_start, []

    def recorded(devices, starts, *rest):
        tried.append(starts)
        return run(devices, starts, *rest)

    monkeypatch.setattr(reliability, "every_start", recorded)
    failures = np.array([0, 5, 0, 4, 7, 6])
    again = are_reliable(device, values, starts, COARSE, failures=failures)
    np.testing.assert_array_equal(again, expected)
    assert tried[0] == [starts[i] for i in (4, 5, 1, 3)]
    assert failures.sum() > 22


def test_a_reliable_device_may_have_to_keep_limits():
    stated = load_device(PEG, OWN_BASE)
    cases = cases_of(stated, Ensemble())
    values = {"press_force": np.array([9.5, 10.0])}
    runs = run_devices(stated, values, cases, COARSE)
    assert runs.goes_in.all()
    drive = {"acceleration": np.full(2, 1e-3 * (100.0 * np.pi) ** 2), "stroke": np.full(2, 2e-3)}
    for name, most in {**runs.measures, **drive}.items():
        for limit in (1.001 * most.max(), 0.5 * most.sum(), 0.999 * most.min()):
            kept = are_reliable(stated, values, cases, COARSE, 1, {name: limit})
            assert kept.tolist() == (most <= limit).tolist(), name


def advised(monkeypatch, holds, changes=MappingProxyType({})):
    """Assess a peg that fails; ``holds(values, limits, whole)`` says which others are reliable."""
    monkeypatch.setattr(
        importlib.import_module("vibralign.answers.assess"), "are_reliable",
        lambda *given: holds(given[1], given[5], "vibrates" in given[2][0]),
    )  # fmt: skip
    stated = load_device(PEG, {**OWN_BASE, "tilt_stiffness": "30 N m/rad", **changes})
    return assess(replace(stated, limits={"acceleration": 12.0 * 9.80665}), COARSE, ENSEMBLE)


def test_advice_keeps_the_limits_or_names_those_that_it_exceeds(monkeypatch):
    def holds(values, limits, _):
        return (values.get("amplitude", np.zeros(1)) > 1.3e-3) & ("acceleration" not in limits) | (
            values.get("friction", np.ones(1)) < least
        )

    least = 0.1
    found = advised(monkeypatch, holds)
    assert [each.parameter for each in found.nearest] == ["friction"]
    assert found.change["friction"] < 0.1
    assert not found.change_exceeds
    least = 0.0
    found = advised(monkeypatch, holds)
    assert found.change["amplitude"] > 1.3e-3
    assert found.change_exceeds == ("acceleration",)
    words = "no change that was tried keeps the limits: this one exceeds the limit of acceleration"
    rows = dict(sheet_rows(found))
    assert rows["first to change"].endswith(words)
    assert rows["reliable with"].endswith("; each of these exceeds a limit")


def test_what_helps_with_one_approach_only_is_no_advice(monkeypatch):
    """The peg is lowered: a change is sought with the worst approach, and holds with all."""
    least = 0.1

    def holds(values, _limits, whole):
        return (values.get("press_force", np.zeros(1)) > 12.0) & (not whole) | (
            values.get("friction", np.ones(1)) < least
        )

    found = advised(monkeypatch, holds, {"approach_speed": "10 mm/s"})
    assert [each.parameter for each in found.nearest] == [*found.change] == ["friction"]
    least = 0.0
    found = advised(monkeypatch, holds, {"approach_speed": "10 mm/s"})
    assert not found.nearest
    assert not found.change
    assert "reliable with" not in dict(sheet_rows(found))


def test_a_horizon_in_seconds_holds_for_devices_of_any_mass():
    stated = load_device(PEG, {"contact_stiffness": 3e5, "tilt_stiffness": 0.3})
    starts = starts_of(stated.parameters, ENSEMBLE)
    masses = np.array([0.3, 0.15, 0.6])
    times = run_devices(stated, {"mass": masses}, starts, COARSE).time
    slowest = 0.5 * (np.sort(times)[1] + times.max())
    held = replace(stated, horizon=slowest)
    assert (run_devices(held, {"mass": masses}, starts, COARSE).goes_in == (times < slowest)).all()
    own = {"friction": np.array([0.15])}
    each = [replace(stated.changed(mass=mass), horizon=slowest) for mass in masses.tolist()]
    alone = [are_reliable(one, own, starts, COARSE)[0] for one in each]
    assert alone == (times < slowest).tolist()


def verdict(stiffness, restitution=0.5, aligned=8, worst=3.0):
    return Verdict(Base(stiffness, restitution), 8, aligned, 2.0, worst)


def test_a_verdict_holds_on_every_base_or_depends_on_it():
    def of(*bases, failing=None):
        return Assessment(
            load_device(PEG), 8, 8 if failing is None else 0, 2.0, 3.0, failing, bases=bases
        )

    everywhere = of(verdict(1e2), verdict(1e4))
    assert (everywhere.reliable, everywhere.depends_on_base) == (True, False)
    somewhere = of(verdict(1e2), verdict(1e4, aligned=0), failing={"phase": 0.0})
    assert (somewhere.reliable, somewhere.depends_on_base) == (False, True)
    nowhere = of(verdict(1e2, aligned=0), failing={"phase": 0.0})
    assert (nowhere.reliable, nowhere.depends_on_base) == (False, False)


def test_an_open_base_is_tried_up_to_that_of_steel_and_a_stated_one_is_not():
    for changes, count in (({}, 9), ({"contact_stiffness": 3e5}, 0)):
        stated = load_device(PEG, {"tilt_stiffness": 0.3, **changes})
        found = assess(stated, COARSE, ENSEMBLE, vary=False)
        assert len(found.bases) == count
        assert found.reliable
    found = load_device(PEG, {"contact_damping": 20.0})
    bases = assess(found, COARSE, ENSEMBLE, vary=False).bases
    assert [each.of.restitution for each in bases] == [None] * 5


def test_reliable_forces_are_asked_in_si_units():
    peg = load_device(PEG, {"tilt_stiffness": 0.3})
    found = reliable_at(peg, COARSE, press_force=[10.0, 40.0])
    assert found.tolist() == [True, False]
    with pytest.raises(ValueError, match="Did you mean 'press_force'"):
        reliable_at(peg, presforce=[1.0])
    assert math.isclose(peg.units.force, 3.0)


def test_python_asks_what_assess_asks():
    stated = load_device(PEG, {"contact_stiffness": 3e5})
    pressed = stated.changed(vibrator="still", approach_speed="3 mm/s")
    asked = []

    def every(*arguments):
        asked.append(arguments[2])
        return every_start(*arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("vibralign.answers.reliability.every_start", every)
        reliable_at(pressed)
        reliable_at(stated)
    assert {each.scene.name for each in asked} == {"insertion"}
    assert [*dict.fromkeys(each.start for each in asked)] == ["still", "simultaneous"]
