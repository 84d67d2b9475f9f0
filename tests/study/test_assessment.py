"""Leeways of a device, against an oracle and against runs of the model."""

import numpy as np
import pytest

from model.runs.settings import Settings
from model.study import assessment
from model.study.assessment import STEP, STEPS, assess
from model.study.config import Ensemble
from model.study.starts import FromEveryStart, from_every_start, starts_of

ENSEMBLE = Ensemble(phases=3, tilts=[1.0, 3.0], every=1)
COARSE = Settings(horizon=60.0, tolerance=1e-7)


def oracle(monkeypatch, **limits):
    """Devices are reliable where each of ``limits`` (lowest, highest) holds; the calls are kept."""
    calls = []

    def every_start(device, swept, starts, *_):
        calls.append(swept)
        count = len(next(iter(swept.values())))
        reliable = np.ones(count, dtype=bool)
        for name, (low, high) in limits.items():
            values = swept.get(name, np.full(count, getattr(device, name)))
            reliable &= (low <= values) & (values <= high)
        aligned = np.ones((count, len(starts)), dtype=bool)
        aligned[:, 1] = reliable
        tau = np.where(aligned, np.arange(1.0, 1.0 + len(starts)), np.nan)
        return FromEveryStart(aligned, tau, np.zeros(count, dtype=np.int64))

    monkeypatch.setattr(assessment, "from_every_start", every_start)
    return calls


def test_a_leeway_ends_at_the_last_value_that_is_reliable(device, monkeypatch):
    device = device.replace(press_force=2.0, friction=0.1)
    oracle(monkeypatch, press_force=(1.5, 2.9), friction=(0.0, 0.15))
    found = assess(device, COARSE, ENSEMBLE)
    assert (found.reliable, found.starts, found.aligned) == (True, 6, 6)
    assert (found.tau_best, found.tau_worst) == (1.0, 6.0)
    force, friction = (
        next(each for each in found.leeways if each.parameter == name)
        for name in ("press_force", "friction")
    )
    assert force.low == pytest.approx(2.0 * STEP**-4)  # 1.587; the next is 1.498
    assert force.high == pytest.approx(2.0 * STEP**6)  # 2.828; the next is 2.997
    assert (force.bounded_below, force.bounded_above) == (True, True)
    assert friction.low == pytest.approx(0.1 * STEP**-STEPS)
    assert (friction.bounded_below, friction.bounded_above) == (False, True)


def test_one_parameter_varies_at_a_time_and_trials_stop_at_a_failure(device, monkeypatch):
    calls = oracle(monkeypatch, press_force=(0.99 * device.press_force, np.inf))
    found = assess(device, COARSE, ENSEMBLE)
    assert {each.parameter for each in found.leeways} == set(assessment.VARIED)
    for swept in calls[1:]:
        off = sum(values != getattr(device, name) for name, values in swept.items())
        assert (off == 1).all()
    below = [values < device.press_force for values in (each["press_force"] for each in calls[1:2])]
    later = [each["press_force"] for each in calls[2:] if "press_force" in each]
    assert below[0].any()
    assert all((values >= device.press_force).all() for values in later)


def test_trials_stop_at_the_bound_of_a_parameter(device, monkeypatch):
    device = device.replace(misalignment=0.9 * device.half_width * (2.0 + device.clearance))
    oracle(monkeypatch)
    found = assess(device, COARSE, ENSEMBLE)
    wide = next(each for each in found.leeways if each.parameter == "misalignment")
    assert wide.high < device.half_width * (2.0 + device.clearance) < wide.high * STEP
    assert not wide.bounded_above


def test_a_device_that_is_not_reliable_has_no_leeway(device, monkeypatch):
    oracle(monkeypatch, press_force=(100.0, np.inf))
    found = assess(device, COARSE, ENSEMBLE)
    assert not found.reliable
    assert (found.aligned, found.leeways) == (5, ())
    assert found.failing_start == starts_of(device, ENSEMBLE)[1]


def test_a_parameter_of_zero_has_no_leeway(device, monkeypatch):
    oracle(monkeypatch)
    found = assess(device.replace(friction=0.0), COARSE, ENSEMBLE)
    assert {each.parameter for each in found.leeways} == set(assessment.VARIED) - {"friction"}


def test_the_model_is_reliable_up_to_a_leeway_and_not_beyond(device):
    found = assess(device, COARSE, ENSEMBLE)
    assert found.reliable
    starts = starts_of(device, ENSEMBLE)
    tried = 0
    for leeway in found.leeways:
        for last, bounded, ratio in (
            (leeway.low, leeway.bounded_below, 1.0 / STEP),
            (leeway.high, leeway.bounded_above, STEP),
        ):
            values = {leeway.parameter: np.array([last, last * ratio if bounded else last])}
            reliable = from_every_start(device, values, starts, COARSE).reliable
            assert reliable.tolist() == [True, not bounded], (leeway.parameter, last)
            tried += bounded
    assert tried
