"""What every method offers to the benchmark, and the loop that event-locating peers share."""

import contextlib
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.equations import device
from benchmarks.modes import ALIGNED, first_mode, next_mode, start
from benchmarks.problems import Problem
from model import Parameters

BATCH = 1024  # trajectories at once of methods that refill their lanes, so that few run empty
_MOST_SWITCHES = 20_000  # of one trajectory; W3 has about 1,000
_AT_ONCE = 1e-12  # a switch sooner than this after the one before is none that took time
CAREFUL = (1e-3, 1e-5, 1e-7)  # first steps to try then


def cpu_seconds() -> float:
    """CPU time of this process and of those it has waited for: the clock of deadlines."""
    return sum(os.times()[:4])


class NotReachedError(Exception):
    """A method cannot answer: it ran out of time, failed or went round in circles."""


@dataclass(frozen=True)
class Solution:
    """``answers`` as in ``Problem.truth``, shape (cases, answers), NaN where it does not align.

    ``evaluations`` of the right-hand side, of all cases together; None where a method cannot tell.
    ``seconds`` of CPU time, where it was not spent in this process.
    """

    answers: NDArray[np.float64]
    evaluations: int | None
    seconds: float | None = None


class Method:
    """One way to solve the problems.

    Attributes:
        name: as it stands in the table.
        formulation: how the problem is put to it, in a few words.
        package: the distribution whose version is reported.
        batch: how many trajectories it is given at once; 1 if one after the other.
        ladder_step: half decades between the tolerances tried.
        errors: what ``error`` has answered, by problem and step of the ladder.
        given_up: problems on which a target was not reached in time.
    """

    name: str
    formulation: str
    package: str
    batch: int = 1
    ladder_step: int = 1
    _is_warm: bool = False

    @cached_property
    def errors(self) -> dict[tuple[str, int], float]:
        """Empty at first."""
        return {}

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """Solve every case by integrating with ``tolerance``.

        Raises:
            NotReachedError: it cannot, or not before ``deadline`` (of ``cpu_seconds``).
        """
        raise NotImplementedError

    @cached_property
    def given_up(self) -> set[str]:
        """Empty at first."""
        return set()

    def warm(self, problem: Problem, tolerance: float) -> None:
        """Compile what solving ``problem`` at ``tolerance`` needs; its time is not counted."""
        if not self._is_warm:
            self._is_warm = True
            with contextlib.suppress(NotReachedError):
                self.solve(problem, problem.cases[:1], 1e-3, math.inf)

    def error(self, problem: Problem, tolerance: float, deadline: float) -> float:
        """The error that nine of ten cases keep; infinite where a method does not answer."""
        answers = self.solve(problem, problem.cases, tolerance, deadline).answers
        return typical_error(answers, problem.truth)


def typical_error(answers: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    """Of each case's largest error, that which nine of ten cases do not exceed."""
    errors = np.abs(answers - truth).max(axis=1)
    errors[np.isnan(errors)] = np.inf
    return float(np.quantile(errors, 0.9, method="inverted_cdf"))


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
# on its steps. It returns (t, y, the switching function that ended it or None, right-hand sides
# evaluated).
Segment = Callable[..., tuple[float, NDArray[np.float64], int | None, int]]


def drive(
    segment: Segment, problem: Problem, cases: Sequence[Parameters], deadline: float
) -> Solution:
    """Solve ``cases`` one after the other: integrate, switch, restart.

    A mode starts where one of its functions is zero. If that rises and falls again within the first
    step, a code that looks at signs finds the switch at the start once more; it is then sent again
    with a smaller first step. ``segment`` is the peer's own; ``p`` is the array of ``Device``.
    """
    answers, evaluations = [], 0
    for case in cases:
        p, y, t = np.array(device(case)), start(case), 0.0
        mode, switches, aligned = first_mode(t, y, p), 0, np.nan
        states: list[Any] = []
        for stop in problem.checkpoints or (problem.horizon,):
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
                    switches += 1
                if switches > _MOST_SWITCHES:
                    raise NotReachedError("endless switching")
                if cpu_seconds() > deadline:
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
    return Solution(np.array(answers), evaluations)
