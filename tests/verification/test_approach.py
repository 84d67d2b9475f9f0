"""The independent solution agrees with the integrator on parts that are lowered, of both shapes."""

import os

import numpy as np
import pytest

from model.events.outcomes import Reason
from verification.accuracy import LEAVING
from verification.independent import insert, solve, solve_round
from vibralign import INSERTION, Batch, Outcome, Parameters, align, simulate

HORIZON = 12.0
# Log-uniform ranges, around the study's device; the part covers the edge and may be tipped over it.
RANGES = {
    "half_width": (0.7, 1.5), "half_height": (1.5, 4.0), "tilt_stiffness": (6.0, 30.0),
    "press_force": (0.8, 4.0), "friction": (0.03, 0.3), "frequency": (0.7, 6.0),
    "axial_damping": (0.1, 1.0), "tilt_damping": (0.5, 6.0), "approach_speed": (0.15, 5.0),
    "misalignment": (0.2, 0.4),
}  # fmt: skip
SETS = int(os.environ.get("VIBRALIGN_SETS", "200"))


def drawn(device: Parameters, number: int) -> Parameters:
    """Return a device by its number."""
    shares = np.random.default_rng([2007, number]).random(len(RANGES) + 2)
    values = {
        name: low * (high / low) ** share
        for (name, (low, high)), share in zip(RANGES.items(), shares, strict=False)
    }
    return device.replace(
        **values, phase=2.0 * np.pi * shares[-1], rest_tilt=0.02 * (2.0 * shares[-2] - 1.0)
    )


def disagreements(device: Parameters, start: str, shape: str, numbers: range) -> tuple[list, int]:
    """Return the sets whose ends or times differ, and how many have aligned."""
    sets = [drawn(device, number) for number in numbers]
    found = align(sets, start=start, shape=shape, horizon=HORIZON, may_settle=False, cores=1)
    wrong, aligned = [], 0
    for row, (number, p) in enumerate(zip(numbers, sets, strict=True)):
        if found.sensitive[row]:
            continue
        tau = float(found.tau_align[row])
        until = tau + 1.0 if start == "running" and tau > 0.0 else HORIZON
        solution = (solve if shape == "square" else solve_round)(p, until, 1e-11, start)
        outcome, reason = Outcome(found.outcome[row]), Reason(found.reason[row])
        if outcome is Outcome.ALIGNED:
            aligned += 1
            alike = solution.ending == "aligned" and (
                abs(solution.tau - tau) <= 1e-9 + 100.0 * found.tau_error[row]
            )
        elif outcome is Outcome.HORIZON_REACHED:
            alike = solution.ending == "horizon"
        else:
            alike = solution.ending in LEAVING[reason]
        if not alike:
            wrong.append((number, outcome.name, tau, solution.ending, solution.tau))
    return wrong, aligned


@pytest.mark.parametrize("shape", ["square", "round"])
@pytest.mark.parametrize("start", ["running", "still"])
@pytest.mark.parametrize("count", [5, pytest.param(SETS // 4, marks=pytest.mark.nightly)])
def test_it_agrees_with_the_integrator(device, start, shape, count):
    first = 1000 * (start == "still") + 10_000 * (shape == "round")
    wrong, aligned = disagreements(device, start, shape, range(first, first + count))
    assert not wrong
    assert aligned >= count // 4


# Sets whose right side meets A1 as they swing into the mouth, before B2 is below the plane.
MEETS_BY_ITS_SIDE, ROUND_MEETS_BY_ITS_SIDE = 4, 10_028


def test_a_part_that_meets_the_edge_by_its_side_slides_in(device):
    p = drawn(device, MEETS_BY_ITS_SIDE)
    run = simulate(
        p, start="running", shape="square", scene=INSERTION, horizon=HORIZON, tolerance=1e-11
    )
    solution = insert(p, HORIZON, float(Batch.stack([p]).insertion_depths()[0]), 1e-12, "running")
    assert (run.outcome, solution.ending) == (Outcome.INSERTED, "inserted")
    assert solution.tau == pytest.approx(run.tau_align, abs=1e-11 + run.tau_error)
    inserted = run.tau_align + run.tau_inserted
    assert solution.time == pytest.approx(inserted, abs=1e-11 + run.insertion_error)


def test_the_alignment_scene_has_no_contact_there(device):
    p = drawn(device, ROUND_MEETS_BY_ITS_SIDE)
    run = simulate(p, start="running", shape="round", horizon=HORIZON)
    solution = solve_round(p, HORIZON, 1e-9, "running")
    assert (run.reason, solution.ending) == (Reason.EDGE_ON_OTHER_FACE, "other face")
    assert solution.time == pytest.approx(run.time[-1], abs=1e-6)
    inserted = simulate(p, start="running", shape="round", scene=INSERTION, horizon=HORIZON)
    assert inserted.outcome is Outcome.INSERTED
    assert inserted.tau_align == pytest.approx(run.time[-1], abs=1e-9)
