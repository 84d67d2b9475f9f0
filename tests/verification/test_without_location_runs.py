"""Runs without event location: evaluations, ends, convergence."""

from math import isnan

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from model import Batch, align
from verification import without_location

FIXED = pytest.mark.parametrize(("scheme", "cost"), [("rk4", 4), ("semi_implicit_euler", 1)])


@pytest.fixture(scope="module")
def slow(device):
    """A device that slides only, for about five time units."""
    return device.replace(friction=0.02, press_force=2.0, frequency=0.5, tilt_stiffness=15.0)


@FIXED
def test_a_fixed_step_run_ends_with_the_step_in_which_the_part_fell(slow, scheme, cost):
    h = 0.01
    run = without_location.align([slow], scheme, h)
    steps = run.tau_align[0] / h
    assert steps == pytest.approx(round(steps), abs=1e-9)
    assert run.rhs_evaluations[0] == cost * round(steps)
    assert run.time[0] == run.tau_align[0]
    assert run.finished[0]
    # The step before, it had not.
    earlier = without_location.align([slow], scheme, h, horizon=(round(steps) - 1) * h)
    assert isnan(earlier.tau_align[0])
    assert without_location.initial_value_problem(slow).fall(0.0, earlier.state[0]) > 0.0
    assert without_location.initial_value_problem(slow).fall(0.0, run.state[0]) < 0.0


@pytest.mark.parametrize("scheme", ["rk4", "semi_implicit_euler", "dormand_prince"])
def test_they_converge_to_the_time_with_event_location(device, scheme):
    bouncing = device.replace(press_force=1.1)
    located = align([bouncing], tolerance=1e-12)
    assert located.separations[0] > 5, "events of every kind lie on the way"
    true = located.tau_align[0]
    finest, coarse = (1e-7, 1e-3) if scheme == "dormand_prince" else (1e-4, 2e-2)
    errors = [
        abs(without_location.align([bouncing], scheme, resolution).tau_align[0] - true)
        for resolution in (coarse, finest)
    ]
    # First order at best, of a motion whose velocities are of order 1.
    assert errors[1] < 0.05
    assert errors[1] < 0.1 * errors[0]


def test_the_adaptive_run_locates_the_fall(slow):
    run = without_location.align([slow], "dormand_prince", 1e-9)
    assert abs(without_location.initial_value_problem(slow).fall(0.0, run.state[0])) < 1e-9
    assert run.tau_align[0] == pytest.approx(align([slow]).tau_align[0], abs=1e-6)


@pytest.mark.parametrize("scheme", ["rk4", "semi_implicit_euler", "dormand_prince"])
def test_a_run_ends_at_the_horizon_or_when_its_evaluations_are_spent(slow, scheme):
    at_horizon = without_location.align([slow], scheme, 0.003, horizon=1.0)
    assert at_horizon.time[0] == 1.0
    assert at_horizon.finished[0]
    assert isnan(at_horizon.tau_align[0])
    spent = without_location.align([slow], scheme, 1e-6, horizon=1.0, max_evaluations=50)
    assert not spent.finished[0]
    assert 40 <= spent.rhs_evaluations[0] <= 50
    assert spent.time[0] < 1.0


def test_a_part_that_leaves_the_edge_or_turns_over_does_not_align(device):
    # From 160 on, Fig. 6's hard pressed parts turn over; the located run says so too.
    hard = device.replace(press_force=9.9, tilt_stiffness=5.0)
    run = without_location.align([hard], "rk4", 1e-3)
    assert isnan(run.tau_align[0])
    assert run.finished[0]
    assert run.time[0] < 300.0


@pytest.mark.parametrize("scheme", ["rk4", "dormand_prince"])
def test_a_batch_is_its_runs_one_by_one(device, scheme):
    batch = Batch.of(device, press_force=[1.0, 2.0, 3.0])
    together = without_location.align(batch, scheme, 1e-3)
    for row in range(len(batch)):
        alone = without_location.align([batch[row]], scheme, 1e-3)
        assert together.tau_align[row] == alone.tau_align[0]
        assert together.rhs_evaluations[row] == alone.rhs_evaluations[0]
        np.testing.assert_array_equal(together.state[row], alone.state[0])


def test_another_solver_gets_the_same_problem(slow):
    problem = without_location.initial_value_problem(slow)

    def fall(time, y):
        return problem.fall(time, y)

    fall.terminal, fall.direction = True, -1.0
    found = solve_ivp(problem.rates, (0.0, 20.0), problem.start, rtol=1e-8, atol=1e-8, events=fall)
    assert found.t_events[0][0] == pytest.approx(align([slow]).tau_align[0], abs=1e-4)
    assert problem.start[0] == slow.misalignment
    assert problem.start[2] == slow.initial_tilt
    assert np.all(problem.start[3:] == 0.0)


def test_faults_are_named(device):
    with pytest.raises(ValueError, match="scheme = 'rk5': must be one of rk4, semi_implicit"):
        without_location.align([device], "rk5", 0.1)
    for name, arguments in {"resolution": (0.0, 1.0), "horizon": (0.1, float("inf"))}.items():
        with pytest.raises(ValueError, match=rf"{name} = .*: must be a finite number > 0"):
            without_location.align([device], "rk4", arguments[0], horizon=arguments[1])
