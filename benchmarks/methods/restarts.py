"""The loop that peers with events share: integrate in a mode, apply the event, restart."""

import math
from collections.abc import Callable, Sequence
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.equations import device
from benchmarks.methods.base import NotReachedError
from benchmarks.modes import ALIGNED, EVENTS, MODES, event_in, first_mode, next_mode, start
from benchmarks.problems import Problem, Solution
from model import Parameters

BATCH = 1024  # trajectories at once of methods that refill their lanes, so that few run empty
_MOST_EVENTS = 20_000  # of one trajectory; W3 has about 1,000
_AT_ONCE = 1e-12  # events closer than this take no time between them
CAREFUL = (1e-3, 1e-5, 1e-7)  # first steps to try then


class Event:
    """An event function as codes take it that step in Python: it ends the run where it falls."""

    terminal = 1
    direction = -1

    def __init__(self, function: Any) -> None:
        self.function = function

    def __call__(self, t: float, y: Any, p: Any) -> float:
        """Return the value of the function."""
        return float(self.function(t, y, p))


def events_of_modes() -> dict[int, list[Event]]:
    """Return the events of every mode."""
    return {mode: [Event(event_in(mode, which)) for which in EVENTS[mode]] for mode in MODES}


def longest_step(case: Parameters) -> float:
    """An eighth of the excitation's period, for codes that look for changes of sign.

    In flight steps would grow so long that a whole contact fits into one and goes unseen.
    """
    return 0.25 * math.pi / case.frequency


class Limits(NamedTuple):
    """First step, 0 for the method's own choice, and longest step."""

    first: float
    longest: float


# segment(mode, t, y, p, stop, limits) integrates in a mode from t up to a stop, under limits
# on its steps. It returns (t, y, the event function that ended it or None, right-hand sides
# evaluated).
Segment = Callable[..., tuple[float, NDArray[np.float64], int | None, int]]


def drive(
    segment: Segment, problem: Problem, cases: Sequence[Parameters], deadline: float
) -> Solution:
    """Solve ``cases`` one after the other: integrate, apply the event, restart.

    A mode starts where one of its functions is zero. If that rises and falls again within the first
    step, a code that looks at signs finds the event at the start once more; it is then sent again
    with a smaller first step. ``segment`` is the peer's own; ``p`` is the array of ``Device``.
    """
    answers, evaluations = [], 0
    for case in cases:
        p, y, t = np.array(device(case)), start(case), 0.0
        mode, events, aligned = first_mode(t, y, p), 0, np.nan
        states: list[Any] = []
        for stop in problem.stops:
            while t < stop and mode != ALIGNED:
                for first_step in (0.0, *CAREFUL):
                    limits = Limits(min(first_step, stop - t), longest_step(case))
                    end, y_end, which, counted = segment(mode, t, y, p, stop, limits)
                    evaluations += counted
                    if which is None or end - t > _AT_ONCE:
                        break
                t, y = end, y_end
                if which is not None:
                    mode = next_mode(t, y, p, mode, which)
                    events += 1
                if events > _MOST_EVENTS:
                    raise NotReachedError("endless events")
                if process_time() > deadline:
                    raise NotReachedError("out of time")
            if mode == ALIGNED:
                aligned = t
                break
            states.append(y.copy())
        if not problem.checkpoints:
            answers.append(np.array([aligned]))
        elif len(states) == len(problem.checkpoints):
            answers.append(np.concatenate(states))
        else:  # it aligned where nothing aligns
            answers.append(np.full(len(problem.checkpoints) * 6, np.nan))
    return problem.solution(np.array(answers), evaluations)
