"""Designs: judged by devices around a setting, against a full grid, continued, and advised."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model import Settings
from model.device import design as designs
from model.device import design_judges, load_device
from model.device.design import Search, as_printed, at_other_friction
from model.device.design_files import design_dataset, known_in
from model.device.design_judges import FARTHEST, Judges
from model.device.reliability import DeviceResults
from model.events.outcomes import Unvibrated
from model.runs.unvibrated import UnvibratedEnds
from model.sweeps.io import write_dataset

PEG = Path(__file__).resolve().parents[2] / "docs" / "peg.yaml"
COARSE = Settings(horizon=60.0, tolerance=1e-6)
STARTS = [{"phase": phase, "initial_tilt": 0.001} for phase in (0.0, 2.0, 4.0)]
FREE = {"press_force": (4.0, 24.0), "tilt_stiffness": (0.1, 0.9)}


def search(limits=None, **changes):
    stated = load_device(PEG, {"contact_stiffness": 3e5, "friction": "0.15 ± 0.05", **changes})
    stated = replace(stated, free=FREE, limits=limits or {})
    return Search(Judges(stated, STARTS, COARSE, devices=64))


def oracle(monkeypatch, fails=lambda force, friction: friction >= 0.1 + force / 100.0):
    """Devices go in below a friction of 0.1 + f0/100; time 1/f0, force 2 f0; the calls' sizes."""
    calls = []

    def run(_, values, *_settings):
        force, friction = values["press_force"], values["friction"]
        calls.append(force.size)
        goes_in = ~fails(force, friction)
        time = np.where(goes_in, 1.0 / force, np.nan)
        nothing = np.where(goes_in, -1, 0)
        return DeviceResults(
            values, goes_in, time, time[:, None], 2.0 * force, 0.1 * force, nothing
        )

    monkeypatch.setattr(design_judges, "run_devices", run)
    monkeypatch.setattr(design_judges, "are_reliable", lambda _, v, *__: run(None, v).goes_in)
    return calls


def test_share_margin_and_measures_are_those_of_the_devices_around(monkeypatch):
    oracle(monkeypatch)
    found = search().judge(np.array([[24.0, 0.5], [9.0, 0.5], [4.0, 0.5]]))
    # friction 0.15 ± 0.05: fails from 0.34, 0.19 and 0.14 on, 3.8, 0.8 and -0.2 tolerances off
    assert found.margin[0] == FARTHEST
    assert 0.7 <= found.margin[1] <= 1.0
    assert found.share[0] == 1.0
    assert found.share[1] == pytest.approx(0.9, abs=0.07)
    assert found.margin[2] == 0.0
    assert found.measures["time"] == pytest.approx(1.0 / np.array([24.0, 9.0, 4.0]))


def test_a_margin_is_known_to_an_eighth_of_a_tolerance(monkeypatch):
    oracle(monkeypatch)
    one = search()
    friction = {"friction": one.stated.tolerances["friction"]}
    one.judges = replace(one.judges, stated=replace(one.stated, tolerances=friction))
    forces = np.array([[6.0, 0.5], [8.0, 0.5], [11.0, 0.5], [14.0, 0.5], [18.0, 0.5]])
    exact = (0.1 + forces[:, 0] / 100.0 - 0.15) / 0.05
    margin = one.judge(forces).margin
    assert (margin >= exact).all()
    assert (margin <= exact + 0.125).all()


def test_vibration_may_be_asked_for_or_not(monkeypatch, tmp_path):
    oracle(monkeypatch)

    def controls(batch, *_):  # a dimensionless press force of 4 is one of 12 N
        aligns = batch.values["press_force"] > 4.0
        return UnvibratedEnds(np.where(aligns, Unvibrated.ALIGNS, Unvibrated.RESTS), None)

    monkeypatch.setattr(design_judges, "unvibrated", controls)
    needed, not_needed = (
        search({"vibration": share, "contact_force": 40.0}).run(8, 12) for share in (1.0, 0.0)
    )
    assert needed.feasible
    assert not_needed.feasible
    assert needed.setting["press_force"] < 12.0 < not_needed.setting["press_force"]
    none = search({"vibration": 0.0, "contact_force": 20.0}).run(4, 12)
    assert not none.feasible
    assert set(none.to_relax()) == {"vibration", "contact_force"}
    text = PEG.read_text() + "limits: {vibration: needed}\n"
    (tmp_path / "peg.yaml").write_text(text)
    assert load_device(tmp_path / "peg.yaml").limits == {"vibration": 1.0}
    (tmp_path / "peg.yaml").write_text(text.replace("needed", "often"))
    with pytest.raises(ValueError, match="vibration = 'often': must be needed or not needed"):
        load_device(tmp_path / "peg.yaml")


def test_the_best_setting_has_the_largest_margin_and_keeps_the_limits(monkeypatch):
    oracle(monkeypatch)
    best = search({"contact_force": 40.0}).run(8, 12)
    assert best.feasible
    assert best.setting["press_force"] == pytest.approx(20.0, abs=1.0)  # 2 f0 = 40
    assert best.binding(FREE) == ["limit of contact_force"]
    times = best.tried.measures["time"][best.front]
    assert (np.diff(times) > 0.0).all()
    assert (np.diff(best.tried.margin[best.front]) > 0.0).all()


def test_a_limit_that_none_keeps_is_named_with_what_it_would_take(monkeypatch):
    oracle(monkeypatch)
    best = search({"time": 0.08, "contact_force": 22.0}).run(8, 12)
    assert not best.feasible
    relaxed = best.to_relax()  # time <= 0.08 asks for f0 >= 12.5, and a force of 25
    assert relaxed["contact_force"] == pytest.approx(25.0, rel=0.1)
    assert relaxed["time"] == pytest.approx(1.0 / 11.0, rel=0.1)  # at f0 = 11


def test_an_interrupted_search_is_continued_and_ends_alike(monkeypatch, tmp_path):
    calls = oracle(monkeypatch)
    expected = search().run(4, 8)
    whole = sum(calls)
    first = search()

    def stop(generation):
        if generation == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        first.run(4, 8, stop)
    before = sum(calls) - whole
    path = tmp_path / "design.nc"
    dataset = design_dataset(first, designs.Design(first.tried(), 0, {}))
    write_dataset(dataset, path)
    again = search()
    again.known, again.checked = known_in(path, again)
    assert known_in(path, search(press_force=11.0)) == ({}, {})
    calls.clear()
    found = again.run(4, 8)
    assert found.setting == expected.setting
    assert sum(calls) <= whole - before


def test_a_setting_that_the_quick_judge_takes_and_assess_does_not_is_not_recommended(monkeypatch):
    seen = []

    def fails(force, friction):  # between the quick judge's devices, above 10 N
        seen.append(friction.size)
        return (force > 10.0) & (friction > 0.152) & (friction < 0.1545)

    oracle(monkeypatch, fails)
    one = search({"contact_force": 40.0})
    quick = one.judge(np.array([[20.0, 0.5], [9.0, 0.5]]))
    assert quick.share.tolist() == [1.0, 1.0]
    found = one.run(6, 12)
    assert found.feasible
    assert found.setting["press_force"] <= 10.0
    assert (found.thorough.going_in, found.thorough.devices) == (64, 64)
    assert found.interval == pytest.approx((0.9434, 1.0), abs=1e-4)  # 64 / (64 + 1.96²)
    assert found.judged > 1
    for _, force in zip(range(3), (12.0, 16.0, 20.0), strict=True):
        assert one.judges.thorough({"press_force": force, "tilt_stiffness": 0.5}).row[0] < 1.0


def test_a_setting_is_judged_as_it_is_printed():
    assert as_printed(13.2197, 4.0, 24.0) == 13.22
    assert as_printed(4.00011, 4.0001, 24.0) == 4.001  # within the range
    assert as_printed(23.99996, 4.0, 23.99997) == 23.99
    assert f"{as_printed(0.123456, 0.1, 0.9):.4g}" == str(as_printed(0.123456, 0.1, 0.9))


def test_a_misjudged_friction_moves_the_recommendation(monkeypatch):
    oracle(monkeypatch)
    one = search({"contact_force": 40.0})
    one.run(6, 12)
    rough = at_other_friction(one, 0.3, 6, 12)
    assert (rough.feasible, rough.keeps) == (False, False)  # 0.35 asks for f0 > 25
    smooth = at_other_friction(one, 0.1, 6, 12)
    assert (smooth.feasible, smooth.keeps, smooth.share) == (True, True, 1.0)


def test_a_device_without_tolerances_is_judged_with_ten_per_cent():
    stated = replace(load_device(PEG), free=FREE)
    assert set(Search(Judges(stated, STARTS, COARSE)).stated.tolerances) == set(designs.ASSUMED_OF)
    with pytest.raises(ValueError, match="nothing is free"):
        Search(Judges(load_device(PEG), STARTS, COARSE))


def test_the_design_of_the_peg_is_not_beaten_by_a_full_grid():
    limits = {"contact_force": 30.0, "time": 0.12}
    peg = search(limits)
    best = peg.run(6, 12)
    assert best.feasible
    force, tilt = np.meshgrid(np.linspace(4.0, 24.0, 9), np.linspace(0.1, 0.9, 9))
    grid = search(limits).judge(np.stack([force.ravel(), tilt.ravel()], axis=1))
    assert grid.keeps(limits).any()
    assert best.tried.score(limits)[best.best] <= grid.score(limits).min()
