"""The independent solution agrees with the integrator through every kind of switch."""

import math

import pytest

from model import Outcome, simulate
from model.study.independent import solve

# What differs from the device, and switches that the run must go through.
RUNS = {
    "slides one way": ({"friction": 0.0, "frequency": 1.0}, {"face end"}),
    "reversals and sticking": ({"frequency": 0.5, "press_force": 2.0}, {"slip"}),
    "hops": ({"frequency": 10.0}, {"slip", "face load", "face gap", "right enters"}),
    "corner landings, alignment in flight": (
        {"press_force": 0.5, "frequency": 1.7, "tilt_stiffness": 46.0, "friction": 0.05},
        {"right lands", "corner load", "corner gap", "aligned"},
    ),
    "side contact, released and loaded again": (
        {"frequency": 0.5},
        {"left enters", "side slip", "side load", "side reload"},
    ),
}


@pytest.mark.parametrize(("changes", "kinds"), RUNS.values(), ids=list(RUNS))
def test_it_agrees_with_the_integrator(device, changes, kinds):
    p = device.replace(**changes)
    run = simulate(p, tolerance=1e-13)
    solution = solve(p, run.tau_align + 1.0)
    assert solution.ending == "aligned"
    assert kinds <= set(solution.switches)
    # Both have errors of the order of their tolerance, 1e-13, times an amplification that
    # tau_error shows too.
    assert solution.tau == pytest.approx(run.tau_align, abs=1e-12 + run.tau_error)


def test_a_part_that_does_not_align_reaches_the_horizon(device):
    solution = solve(device, 0.5)
    assert (solution.ending, solution.time) == ("horizon", 0.5)
    assert math.isnan(solution.tau)


def test_it_says_how_the_scene_is_left(device):
    p = device.replace(tilt_stiffness=0.0, press_force=5.0)
    run = simulate(p)
    solution = solve(p, 300.0, tolerance=1e-10)
    assert run.outcome is Outcome.LEFT_SCENE
    assert solution.ending == "overturned"
    assert solution.time == pytest.approx(run.time[-1], abs=1e-6)
