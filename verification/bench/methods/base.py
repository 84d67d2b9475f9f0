"""The interface of methods: a method integrates a problem at a tolerance."""

import contextlib
import math
from collections.abc import Sequence

import numpy as np

from model.physics.parameters import Parameters
from verification.bench.problems import Floats, Problem, Solution


class NotReachedError(Exception):
    """Error: a method ran out of time, failed, or met endless events."""


class Method:
    """One way to solve the problems.

    Attributes:
        name: name in tables and legends.
        batch: number of trajectories in a call.
    """

    name: str
    batch: int = 1
    _is_warm: bool = False

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float, /
    ) -> Solution:
        """Integrate the cases; this call is timed.

        Raises:
            NotReachedError: the method fails, or ``process_time`` reaches ``deadline``.
        """
        raise NotImplementedError

    def answer(self, problem: Problem, tolerance: float, deadline: float = math.inf) -> Solution:
        """Integrate the cases of the problem to measure errors; by default as ``solve``."""
        return self.solve(problem, problem.cases, tolerance, deadline)

    def warm(self, problem: Problem, tolerance: float) -> None:
        """Compile what ``solve`` needs for the problem; this call is not timed."""
        if not self._is_warm:
            self._is_warm = True
            with contextlib.suppress(NotReachedError):
                self.solve(problem, problem.cases[:1], 1e-3, math.inf)


def typical_error(answers: Floats, truth: Floats) -> float:
    """Return the 90th percentile of the cases' largest errors."""
    errors = np.abs(answers - truth).max(axis=1)
    errors[np.isnan(errors)] = np.inf
    return float(np.quantile(errors, 0.9, method="inverted_cdf"))
