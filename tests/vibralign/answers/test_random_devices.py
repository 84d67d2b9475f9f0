"""Random devices, with and without a stated base: ends hold, forces agree, advice cures."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import yaml

from model.physics.parameters import Batch
from model.runs.simulate import simulate_once
from model.sweeps.settings import Ensemble
from vibralign import INSERTION, Settings, load_device, simulate
from vibralign.answers import leeways
from vibralign.answers.assess import Assessment, assess
from vibralign.answers.cases import cases_of, on_bases, parameters_in, stated_case
from vibralign.answers.design import search
from vibralign.answers.design_trials import Trials
from vibralign.answers.leeways import FINEST
from vibralign.answers.reliability import FORCES, are_reliable, run_devices
from vibralign.answers.yields import drawn, interval, yield_of
from vibralign.device import StatedDevice

SQUARE = Path(__file__).resolve().parents[2] / "square"
ROUND = Path(__file__).resolve().parents[3] / "docs"
FEW = Ensemble(phases=4, tilts=[1.0], every=1)
SETTINGS = Settings(scene=INSERTION, tolerance=1e-6, horizon=60.0)
OF_A_BASE = ("edge_radius", "plate_thickness", "plate_radius", "restitution")
CHANGED = (
    "press_force", "frequency", "mass", "amplitude", "tilt_stiffness", "friction", "misalignment",
)  # fmt: skip
ASKED = ("press_force", "tilt_stiffness", "friction")


def random_device(folder: Path, number: int, origin: Path = SQUARE, **lines: str) -> Path:
    """Write a worked device with its quantities changed at random; every other has no base."""
    rng = np.random.default_rng(5400 + number)
    stated = load_device(origin / "devices" / ("pin.yaml", "peg.yaml", "shaft.yaml")[number % 3])
    given: dict[str, object] = dict(stated.quantities) | {"materials": stated.materials}
    for name in CHANGED:
        given[name] = float(f"{stated.quantities[name] * np.exp(rng.normal(0.0, 0.25)):.4g}")
    if number % 2:
        given = {name: each for name, each in given.items() if name not in OF_A_BASE}
        del given["materials"]
    given |= {name: f"{given[name]} {text}" for name, text in lines.items()}
    given |= {"shape": stated.shape, "approach_speed": "sudden"}
    path = folder / f"device{number}.yaml"
    path.write_text(yaml.safe_dump(given, allow_unicode=True), encoding="utf-8")
    return path


def reliable(path: Path, changes: Mapping[str, object], ensemble: Ensemble) -> bool:
    """Return whether the device is reliable with --set of these changes."""
    device = load_device(path, changes)
    own = {"friction": np.array([device.quantities["friction"]])}
    return bool(are_reliable(device, own, cases_of(device, ensemble), SETTINGS)[0])


def are(path: Path, name: str, values: Iterable[float], ensemble: Ensemble) -> list[bool]:
    """Return where the device is reliable with --set of each of the values."""
    return [reliable(path, {name: f"{value:.4g}"}, ensemble) for value in values]


def ends_hold(path: Path, found: Assessment, ensemble: Ensemble) -> tuple[int, int]:
    """Check printed ends and advice; return the numbers of ends and of ragged ones."""
    ends = ragged = 0
    for each in found.leeways:
        for end, fails, rough in (
            (each.low, each.fails_below, each.ragged_below),
            (each.high, each.fails_above, each.ragged_above),
        ):
            if fails is None:
                continue
            ends, ragged = ends + 1, ragged + rough
            out = (1.0 + FINEST) ** np.sign(end * (fails - end))  # a low end may be negative
            just = [end / out**k for k in range(3)]
            inside = [value for value in just if (value - each.value) * (fails - end) > 0.0]
            assert all(are(path, each.parameter, inside, ensemble)), (each, inside)
            adds = each.parameter == "gripper_tilt"  # in steps that add, not of a ratio
            beyond = [fails] if rough or adds else [fails, end * out]
            assert not any(are(path, each.parameter, beyond, ensemble)), (each, beyond)
    for each in found.nearest:
        for end in (each.below, each.above):
            assert end is None or all(are(path, each.parameter, [end], ensemble))
    if found.change:
        assert reliable(path, {n: f"{v:.4g}" for n, v in found.change.items()}, ensemble)
    assert found.reliable == reliable(path, {}, ensemble)
    assert bool(found.cause) != found.reliable
    return ends, ragged


def asked(
    folder: Path,
    devices: Iterable[tuple[int, Path]],
    ensemble: Ensemble,
    least: int,
    kinds: int = 4,
) -> int:
    """Check the ends of random devices, at least so many, and return how many are ragged."""
    ends, ragged, verdicts = 0, 0, set()
    for number, origin in devices:
        path = random_device(folder, number, origin)
        found = assess(load_device(path), SETTINGS, ensemble)
        counts = ends_hold(path, found, ensemble)
        ends, ragged = ends + counts[0], ragged + counts[1]
        verdicts.add((found.reliable, bool(found.bases)))
    assert len(verdicts) >= kinds  # of both kinds, with and without a base
    assert ends >= least
    return ragged


def test_printed_ends_hold_on_every_base(tmp_path, monkeypatch):
    monkeypatch.setattr(leeways, "VARIED", ASKED)
    monkeypatch.setattr(leeways, "UNITS", ())
    asked(tmp_path, product(range(2), [SQUARE]), FEW, 3, kinds=2)
    asked(tmp_path, product([16], [ROUND]), FEW, 0, kinds=1)


@pytest.mark.nightly
def test_ends_are_ragged_of_round_parts(tmp_path, monkeypatch):
    monkeypatch.setattr(leeways, "VARIED", ASKED)
    monkeypatch.setattr(leeways, "UNITS", ())
    assert asked(tmp_path, product(range(14), [SQUARE]), FEW, 20) <= 2
    assert asked(tmp_path, product(range(16, 34), [ROUND]), FEW, 15) > 4


@pytest.mark.nightly
def test_all_printed_ends_hold_on_every_base(tmp_path):
    many = Ensemble(phases=8, tilts=[1.0, 3.0], every=1)
    asked(tmp_path, product(range(30, 45), [SQUARE]), many, 60)
    asked(tmp_path, product(range(30, 60), [ROUND]), many, 100)


def test_a_case_is_the_device_that_set_states(tmp_path):
    for number in (1, 3, 5):
        path = random_device(tmp_path, number)
        device = load_device(path)
        cases = cases_of(device, FEW)
        columns = on_bases(Batch.stack([device.parameters]), [device.units], cases, device.shape)
        steel = 1.05 * (6.0 * 1.154e11**2 * device.quantities["half_width"]) ** (1.0 / 3.0)
        for row, case in enumerate(cases):
            stated = stated_case(device, case)
            again = load_device(path, stated).parameters
            for name, column in columns.items():
                assert column[0, row] == pytest.approx(getattr(again, name), rel=1e-12)
            assert parameters_in(device, case) == again
            most = steel * device.quantities["press_force"] ** (1.0 / 3.0)
            assert stated.get("contact_stiffness", 0.0) <= most


def test_forces_are_those_of_all_places_in_every_command(tmp_path):
    """Of assess, of drawn devices, and of single runs of the same cases."""
    for number, origin in ((0, SQUARE), (1, SQUARE), (2, ROUND), (3, ROUND)):
        device = load_device(random_device(tmp_path, number, origin, friction="± 10 %"))
        cases = cases_of(device, FEW)
        found = assess(device, SETTINGS, FEW, vary=False)
        settings = replace(SETTINGS, shape=device.shape)
        runs = [simulate_once(parameters_in(device, case), settings) for case in cases]
        by_place = {place: max(getattr(r, name) for r in runs) for place, name in FORCES.items()}
        assert found.forces == pytest.approx(by_place, rel=0.02, abs=1e-6)
        assert found.contact_force_max == max(found.forces.values())
        own = {"friction": np.array([device.quantities["friction"]])}
        one, newton = run_devices(device, own, cases, SETTINGS), device.units.force
        assert one.force[0] == pytest.approx(found.contact_force_max * newton)
        forces = {place: each[0] / newton for place, each in one.forces.items()}
        assert forces == pytest.approx(found.forces)
        many = run_devices(device, drawn(device, 8), cases, SETTINGS)
        assert (many.force == np.max([*many.forces.values()], axis=0)).all()


def test_an_overshoot_is_not_inserted_and_a_dip_is_held():
    """A part that counts as inserted stays at depth; no press holds one deeper than it reaches."""
    device = load_device(SQUARE / "peg.yaml", {"tilt_stiffness": 0.3})
    reach = float(Batch.stack([device.parameters]).reaches()[0])
    usual = simulate(device, SETTINGS)
    deep = replace(SETTINGS, insertion_depth=0.98 * reach)
    beyond = replace(SETTINGS, insertion_depth=1.02 * reach)
    assert simulate(device, deep).depth[-1] == pytest.approx(0.98 * reach, rel=1e-6)
    run = simulate(device, beyond)
    assert run.depth.max() > 1.02 * reach  # it overshoots
    assert run.outcome.name in ("JAMMED", "HORIZON_REACHED")
    late = run.time > run.tau_align + usual.tau_inserted + 10.0
    assert late.any()
    assert (run.depth[late] > 0.5 * reach).all()  # where it counts as inserted it stays


def test_devices_that_start_inside_are_not_counted():
    stated = load_device(SQUARE / "devices" / "peg.yaml", {"misalignment": "0.4 mm ± 0.39 mm"})
    found, results = yield_of(stated, cases_of(stated, FEW), SETTINGS, devices=64, indices=False)
    values = drawn(stated, 64)
    inside = values["misalignment"] <= values["clearance"] * stated.quantities["half_width"]
    assert found.inside == inside.sum() > 10
    assert found.devices == 64 - inside.sum() == len(results.goes_in)
    assert (results.times > 0.0).all()
    assert found.time[0] > 0.0


def test_what_is_stated_of_a_device_without_a_base_holds_for_the_worst():
    """The peg of the tutorial, near its border: reliable on its own base, not on a stiffer one."""
    path = SQUARE / "peg.yaml"
    changes = {"friction": 0.215}
    usual = replace(SETTINGS, horizon=300.0)
    found = assess(load_device(path, changes), usual, Ensemble(), 2, vary=False)
    assert found.depends_on_base
    assert not found.reliable
    assert found.failing_start is not None
    assert found.failing_start["contact_stiffness"] > 3e5
    on_it = load_device(path, {**changes, **found.failing_start})
    assert isinstance(on_it, StatedDevice)
    assert simulate(on_it, usual).outcome is not usual.success


def limits_are_kept(folder: Path, number: int, devices: int) -> bool:
    """Design a device, run others that are drawn at the setting, and return if one was found.

    No more of them exceed the limit of force, at any place, than the interval of none allows.
    """
    path = random_device(folder, number, friction="± 10 %", press_force="± 5 %")
    stated = load_device(path)
    own = stated.quantities
    cases = cases_of(stated, FEW)
    values = {"friction": np.array([own["friction"]])}
    force = float(run_devices(stated, values, cases, SETTINGS).force[0])
    free = {name: (0.5 * own[name], 2.0 * own[name]) for name in ("press_force", "tilt_stiffness")}
    wanted = replace(stated, free=free, limits={"contact_force": 1.2 * force})
    found = search(Trials(wanted, cases, SETTINGS, devices=devices), 2, 8)
    if not found.feasible:
        return False
    there = stated.changed(**found.setting)
    runs = run_devices(there, drawn(there, devices, seed=1), cases, SETTINGS)
    exceeding = int((runs.force > wanted.limits["contact_force"]).sum())
    assert exceeding / devices <= interval(0, devices)[1]
    assert found.check is not None
    assert max(found.check.forces.values()) <= wanted.limits["contact_force"]
    return True


def test_a_recommended_setting_keeps_the_limit_of_force_at_every_place(tmp_path):
    assert sum(limits_are_kept(tmp_path, number, 32) for number in (60, 62, 64)) > 0


@pytest.mark.nightly
def test_recommended_settings_keep_the_limit_of_force_at_every_place(tmp_path):
    assert sum(limits_are_kept(tmp_path, number, 128) for number in range(70, 100)) > 10
