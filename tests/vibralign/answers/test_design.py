"""Designs: settings tried by devices around them, and checked as assess does; a full grid."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model.events.outcomes import Unvibrated
from model.runs.unvibrated import UnvibratedEnds
from vibralign import Settings
from vibralign.answers import design as designs
from vibralign.answers import design_trials, reliability
from vibralign.answers.design import Limiting, as_printed, search, tried_of, with_tolerances
from vibralign.answers.design_trials import FARTHEST, MEASURES, Trials
from vibralign.answers.reliability import DeviceResults
from vibralign.device import Tolerance, load_device

PEG = Path(__file__).resolve().parents[2] / "square" / "peg.yaml"
COARSE = Settings(horizon=60.0, tolerance=1e-6)
STARTS = [{"phase": phase, "gripper_tilt": 0.001} for phase in (0.0, 2.0, 4.0)]
MEASURE = {name: 2 + place for place, name in enumerate(MEASURES)}  # in the results of a setting
FREE = {"press_force": (4.0, 24.0), "tilt_stiffness": (0.1, 0.9)}


def trials(limits=None):
    stated = load_device(PEG, {"contact_stiffness": 3e5, "friction": "0.15 ± 0.05"})
    return Trials(replace(stated, free=FREE, limits=limits or {}), STARTS, COARSE, devices=64)


def tried(of: Trials, points):
    return tried_of(points, of.quick(np.array(points)), FREE)


def oracle(monkeypatch, fails=lambda force, friction: friction >= 0.1 + force / 100.0):
    """Devices go in below a friction of 0.1 + f0/100; time 1/f0, force 2 f0; the calls' sizes."""
    calls = []

    def run(_, values, *_settings):
        force, friction = values["press_force"], values["friction"]
        calls.append(force.size)
        goes_in = ~fails(force, friction)
        time = np.where(goes_in, 1.0 / force, np.nan)
        nothing = np.where(goes_in, -1, 0)
        no = np.zeros(force.size, bool)
        return DeviceResults(
            values, goes_in, time, time[:, None], 2.0 * force, 0.1 * force, nothing,
            {"edge": force, "side": 2.0 * force}, no, time, no, no,
        )  # fmt: skip

    monkeypatch.setattr(design_trials, "run_devices", run)
    monkeypatch.setattr(design_trials, "are_reliable", lambda _, v, *__: run(None, v).goes_in)
    return calls


def test_a_setting_that_the_vibrator_cannot_give_is_not_run(monkeypatch):
    calls = oracle(monkeypatch)
    of = trials({"acceleration": 150.0})  # at 50 Hz: up to 1.52 mm
    of = replace(of, stated=replace(of.stated, free={"amplitude": (5e-4, 4e-3), **FREE}))
    settings = np.array([[1.5e-3, 24.0, 0.5], [1.6e-3, 24.0, 0.5]])
    found = tried_of(settings.tolist(), of.quick(settings), of.stated.free)
    assert found.share.tolist() == [1.0, 0.0]
    before = len(calls)
    of.quick(settings[1:])
    assert len(calls) == before
    width = {"amplitude": Tolerance("uniform", 0.02, relative=True)}  # 1.53 mm at its end
    wide = replace(of, stated=replace(of.stated, tolerances=of.stated.tolerances | width))
    assert wide.quick(settings[:1])[0][0] == 0.0


def test_a_limit_is_not_exceeded_where_nothing_goes_in(monkeypatch):
    oracle(monkeypatch, lambda force, _: force > 0.0)
    best = search(trials({"contact_force": 40.0, "stroke": 1.0, "acceleration": 1.0}), 1, 5)
    # 1 mm at 50 Hz: 99 m/s², and a stroke of 2 mm; a force is not known.
    passed = {each.name: each.passed for each in best.limiting if each.kind == "limit"}
    assert passed == {"contact_force": False, "stroke": False, "acceleration": True}


def test_what_file_states_in_place_of_parameters_has_assumed_tolerances():
    stated = load_device(PEG, {"play": "20 um", "tilt_frequency": "20 Hz"})
    assumed = with_tolerances(replace(stated, free=FREE)).tolerances
    assert {"play", "tilt_frequency"} <= {*assumed}


def test_share_margin_and_measures_are_those_of_the_devices_around(monkeypatch):
    oracle(monkeypatch)
    found = tried(trials(), [[24.0, 0.5], [9.0, 0.5], [4.0, 0.5]])
    # friction 0.15 ± 0.05: fails from 0.34, 0.19 and 0.14 on, 3.8, 0.8 and -0.2 tolerances off
    assert found.margin[0] == FARTHEST
    assert 0.7 <= found.margin[1] <= 1.0
    assert found.share[0] == 1.0
    assert found.share[1] == pytest.approx(0.9, abs=0.07)
    assert found.margin[2] == 0.0
    assert found.measures["time"] == pytest.approx(1.0 / np.array([24.0, 9.0, 4.0]))


def test_a_margin_is_known_to_an_eighth_of_a_tolerance(monkeypatch):
    oracle(monkeypatch)
    one = trials()
    friction = {"friction": one.stated.tolerances["friction"]}
    one = replace(one, stated=replace(one.stated, tolerances=friction))
    forces = np.array([[6.0, 0.5], [8.0, 0.5], [11.0, 0.5], [14.0, 0.5], [18.0, 0.5]])
    exact = (0.1 + forces[:, 0] / 100.0 - 0.15) / 0.05
    found = tried(one, forces)
    assert (found.margin >= exact).all()
    assert (found.margin <= exact + 0.125)[found.share == 1.0].all()
    assert np.count_nonzero(found.share == 1.0) == 3


def test_vibration_may_be_asked_for_or_not(monkeypatch, tmp_path):
    oracle(monkeypatch)

    def controls(batch, *_):  # a dimensionless press force of 4 is one of 12 N
        aligns = batch.values["press_force"] > 4.0
        return UnvibratedEnds(np.where(aligns, Unvibrated.ALIGNS, Unvibrated.RESTS), None)

    monkeypatch.setattr(reliability, "unvibrated", controls)
    needed, not_needed = (
        search(trials({"vibration": share, "contact_force": 40.0}), 8, 12) for share in (1.0, 0.0)
    )
    assert needed.feasible
    assert not_needed.feasible
    assert needed.setting["press_force"] < 12.0 < not_needed.setting["press_force"]
    one = trials({"vibration": 0.0, "contact_force": 22.0})
    none = search(one, 4, 12)
    assert not none.feasible
    assert {each.name for each in none.limiting} >= {"vibration", "contact_force"}
    text = PEG.read_text() + "limits: {vibration: needed}\n"
    (tmp_path / "peg.yaml").write_text(text)
    assert load_device(tmp_path / "peg.yaml").limits == {"vibration": 1.0}
    (tmp_path / "peg.yaml").write_text(text.replace("needed", "often"))
    with pytest.raises(ValueError, match="vibration = 'often': must be needed or not needed"):
        load_device(tmp_path / "peg.yaml")


def test_the_best_setting_has_the_largest_margin_and_keeps_the_limits(monkeypatch):
    oracle(monkeypatch)
    best = search(trials({"contact_force": 40.0}), 8, 12)
    assert best.feasible
    assert best.check.devices == 64
    assert best.setting["press_force"] == pytest.approx(20.0, abs=1.0)  # 2 f0 = 40
    assert best.limiting == [Limiting("limit", "contact_force")]
    assert (best.check.forces["side"], best.check.forces["edge"]) == pytest.approx(
        (best.tried.measures["contact_force"][best.best], 0.5 * best.check.forces["side"])
    )


def test_a_small_part_of_the_ranges_in_which_devices_go_in_is_found(monkeypatch):
    # 4 % of a range: the first settings miss it, and a generation that fails alike ends no search.
    oracle(monkeypatch, lambda force, _: abs(force - 6.3) > 0.4)
    best = search(trials(), 8, 5)
    assert best.feasible
    assert not best.tried.share[:5].any()


def test_limits_that_none_keeps_are_named_with_the_numbers_of_the_nearest_setting(monkeypatch):
    oracle(monkeypatch)
    one = trials({"time": 0.08, "contact_force": 22.0})
    best = search(one, 8, 12)
    assert not best.feasible
    assert best.check.devices == 64  # its numbers are those of all devices
    assert {each.name for each in best.limiting} >= {"time", "contact_force"}
    # The time asks for f0 >= 12.5, a force of 25; the force for f0 <= 11, a time of 1/11.
    assert 11.0 <= best.setting["press_force"] <= 12.5
    row = one.check(best.setting).row
    for name in ("time", "contact_force"):
        assert best.tried.measures[name][best.best] == row[MEASURE[name]]


def test_an_end_of_a_range_that_binds_is_named(monkeypatch):
    oracle(monkeypatch)
    one = trials({"time": 0.2})
    narrow = replace(one, stated=replace(one.stated, free={**FREE, "press_force": (4.0, 8.0)}))
    best = search(narrow, 4, 12)
    assert Limiting("upper end", "press_force") in best.limiting


def test_tolerances_are_named_where_some_devices_within_them_fail(monkeypatch):
    oracle(monkeypatch, lambda _, friction: friction > 0.18)
    one = trials()
    best = search(one, 1, 5)
    assert 0.0 < best.tried.share[best.best] < 1.0
    assert {each.kind for each in best.limiting} == {"tolerance"}


def test_a_setting_that_the_quick_trial_takes_and_assess_does_not_is_not_recommended(monkeypatch):
    def fails(force, friction):  # between the quick trial's devices, above 10 N
        return (force > 10.0) & (friction > 0.152) & (friction < 0.1545)

    oracle(monkeypatch, fails)
    one = trials({"contact_force": 40.0})
    assert tried(one, [[20.0, 0.5], [9.0, 0.5]]).share.tolist() == [1.0, 1.0]
    found = search(one, 6, 12)
    assert found.feasible
    assert found.setting["press_force"] <= 10.0
    assert (found.check.going_in, found.check.devices) == (64, 64)
    assert found.interval == pytest.approx((0.9434, 1.0), abs=1e-4)  # 64 / (64 + 1.96²)
    assert len(found.checks) > 1
    for force in (12.0, 16.0, 20.0):
        assert one.check({"press_force": force, "tilt_stiffness": 0.5}).row[0] < 1.0


def test_times_are_expected_to_grow_as_at_the_nearest_check(monkeypatch):
    """Of the devices, the quick trial misses the slowest; a limit of the time is kept by all."""
    oracle(monkeypatch, lambda _, friction: friction > 9.0)
    one = trials({"time": 0.1})
    quick = Trials.quick

    def optimistic(self, points):
        return [(*row[:2], 0.7 * row[2], *row[3:]) for row in quick(self, points)]

    monkeypatch.setattr(Trials, "quick", optimistic)
    found = search(one, 6, 12)
    assert found.feasible
    assert found.setting["press_force"] > 10.0  # the time is 1/f0, of the lightest press
    assert len(found.checks) < 6


def test_a_setting_is_tried_as_it_is_printed():
    assert as_printed(13.2197, 4.0, 24.0) == 13.22
    assert as_printed(4.00011, 4.0001, 24.0) == 4.001  # within the range
    assert as_printed(23.99996, 4.0, 23.99997) == 23.99
    assert f"{as_printed(0.123456, 0.1, 0.9):.4g}" == str(as_printed(0.123456, 0.1, 0.9))


def test_a_device_without_tolerances_gets_ten_per_cent():
    stated = replace(load_device(PEG), free=FREE)
    assert set(with_tolerances(stated).tolerances) == set(designs.ASSUMED_OF)
    with pytest.raises(ValueError, match="nothing is free"):
        with_tolerances(load_device(PEG))


def test_the_design_of_the_peg_is_not_beaten_by_a_full_grid():
    limits = {"contact_force": 30.0, "time": 0.12}
    best = search(trials(limits), 6, 12)
    assert best.feasible
    force, tilt = np.meshgrid(np.linspace(4.0, 24.0, 6), np.linspace(0.1, 0.9, 6))
    grid = tried(trials(limits), np.stack([force.ravel(), tilt.ravel()], axis=1))
    assert grid.keeps(limits).any()
    assert best.tried.score(limits)[best.best] <= grid.score(limits).min()
