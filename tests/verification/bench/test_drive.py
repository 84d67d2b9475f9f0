import numpy as np
import pytest

from verification.bench.equations import FACE_END, OPEN, SLIDE_NEGATIVE
from verification.bench.methods.base import NotReachedError
from verification.bench.methods.scipy_ivp import drive
from verification.bench.problems import Problem
from verification.bench.trajectories import W1
from vibralign import Settings

PROBLEM = Problem("p", (W1,), Settings(horizon=10.0))


def test_the_shared_loop_passes_events_and_stops_at_alignment() -> None:
    modes = []

    def segment(mode, t, y, *_):
        modes.append(mode)
        if t == 0.0:  # slides, then the load vanishes with the gap open
            y = y.copy()
            y[1] += 0.1
            return 0.5, y, 0, 3
        y = y.copy()
        y[0], y[1], y[2] = 0.0, 0.9, 0.0  # inside the slot
        return 0.75, y, FACE_END, 4

    solution = drive(segment, PROBLEM, [W1], deadline=np.inf)
    assert modes == [SLIDE_NEGATIVE, OPEN]
    assert solution.tau_align.tolist() == [0.75]
    assert solution.evaluations == 7


def test_the_shared_loop_gives_up_on_endless_events() -> None:
    def segment(_, t, y, *__):
        return t, y, 0, 1

    with pytest.raises(NotReachedError, match="endless"):
        drive(segment, PROBLEM, [W1], deadline=np.inf)
