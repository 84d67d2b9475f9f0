"""Runs that start at rest under the press."""

import numpy as np
import pytest

from vibralign import Batch, Outcome, Reason, align, simulate


def test_without_vibration_the_part_stays_at_rest(device):
    p = device.replace(press_force=0.8, frequency=0.0)
    run = simulate(p, start="pressed", tolerance=1e-12)
    assert run.outcome is Outcome.SETTLED
    np.testing.assert_allclose(run.state[-1], run.state[0], atol=1e-10)
    assert run.separations == 0
    assert run.sticking_share == 1.0


def test_the_vibration_sets_in_at_its_phase(device):
    p = device.replace(press_force=0.8)
    runs = [simulate(p.replace(phase=phase), start="pressed", horizon=1.0) for phase in (0.0, 2.0)]
    first, other = runs
    np.testing.assert_allclose(first.state[0], other.state[0], atol=1e-14)
    assert np.abs(first.state[1] - other.state[1]).max() > 1e-6


def test_the_initial_tilt_has_no_effect(device):
    p = device.replace(press_force=0.8)
    one, other = (simulate(p.replace(initial_tilt=t), start="pressed") for t in (0.001, -0.01))
    assert one.tau_align == other.tau_align


def test_a_part_without_rest_says_so(device):
    run = simulate(device.replace(press_force=4.0, tilt_stiffness=5.0), start="pressed")
    assert (run.outcome, run.reason) == (Outcome.LEFT_SCENE, Reason.NO_REST)
    assert "does not come to rest on the edge" in run.message
    assert "lower press_force" in run.remedy
    assert run.time[-1] == 0.0


def test_a_part_over_the_slot_needs_no_rest(device):
    run = simulate(device.replace(misalignment=0.01), start="pressed")
    assert run.outcome is Outcome.ALIGNED
    assert run.tau_align == 0.0


def test_estimates_hold_from_a_pressed_start(device):
    batch = Batch.of(device, press_force=np.linspace(0.3, 2.0, 12))
    one, other = (align(batch, start="pressed", tolerance=each) for each in (1e-10, 1e-13))
    np.testing.assert_array_equal(one.outcome, other.outcome)
    np.testing.assert_array_equal(one.reason, other.reason)
    assert {Outcome.ALIGNED, Outcome.LEFT_SCENE} <= set(one.outcome.tolist())
    aligned = one.outcome == Outcome.ALIGNED
    error = (one.tau_error + other.tau_error)[aligned]
    assert (np.abs(one.tau_align - other.tau_align)[aligned] <= error).all()
    assert one.tilt_max[aligned] == pytest.approx(other.tilt_max[aligned], rel=1e-6)
