"""Readings of the equations as printed: the engine agrees with the independent solution."""

import numpy as np
import pytest

from tests.verification.test_independent import DROPS_TWICE, RUNS
from verification.independent import solve_printed
from verification.independent.printed import CRITERION, READINGS
from vibralign import Trajectory, Variants, simulate

HORIZON = 6.0
# Bounces and landed corners, and contacts at the side; all readings together, and each alone.
SETS = ("lift-offs", "side contact, released and loaded again")
OF_SIDE = "side_gap", "side_force"  # act in the second set only
CASES = [
    (SETS[1], READINGS),
    *(
        pytest.param(name, (each,), marks=pytest.mark.nightly)
        for name in SETS
        for each in READINGS
        if name == SETS[1] or each not in OF_SIDE
    ),
    pytest.param(SETS[0], READINGS, marks=pytest.mark.nightly),
]


def end_of(run: Trajectory) -> tuple[float, np.ndarray]:
    """Return time and state of the alignment, or of the end: the independent run ends there."""
    end = min(run.time[-1], np.nan_to_num(run.tau_align, nan=np.inf))
    return float(end), run.state[run.time <= end][-1]


@pytest.mark.parametrize(("name", "printed"), CASES)
def test_it_agrees_with_the_integrator_in_printed_readings(device, name, printed):
    p = device.replace(**RUNS[name][0])
    readings = Variants(**dict.fromkeys(printed, "printed"))
    run = simulate(p, readings=readings, horizon=HORIZON, tolerance=1e-11, may_settle=False)
    end, state = end_of(run)
    solution = solve_printed(p, HORIZON if end == HORIZON else end + 1.0, printed, 1e-12)
    assert solution.time == pytest.approx(end, abs=1e-8)
    assert solution.state == pytest.approx(state, abs=1e-8)
    other_end, other = end_of(simulate(p, horizon=HORIZON, may_settle=False))
    acts = abs(other_end - end) + np.abs(other - state).max()
    assert acts > 1e-4, "the reading acts"


def test_as_printed_a_part_aligns_once_all_its_corners_are_inside():
    # R8. The first fall, from which the part is lifted out again, is no alignment.
    printed = Variants(alignment_criterion="printed")
    run = simulate(DROPS_TWICE, readings=printed, horizon=20.0, tolerance=1e-13)
    solution = solve_printed(DROPS_TWICE, 20.0, [CRITERION])
    assert solution.ending == "aligned"
    assert {"aligned", "right enters", "inside"} <= set(solution.events)
    assert solution.tau == pytest.approx(run.tau_align, abs=1e-12 + run.tau_error)
    assert run.tau_align > 10.0 > simulate(DROPS_TWICE).tau_align


def test_an_unknown_reading_is_refused(device):
    with pytest.raises(ValueError, match=r"printed = .'law'.: must be of"):
        solve_printed(device, 1.0, ["law"])
