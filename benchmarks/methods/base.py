"""What every method is: a way to integrate problems, from a resolution to a ``Solution``."""

import contextlib
import math
from collections.abc import Sequence

import numpy as np

from benchmarks.problems import Floats, Problem, Solution
from model.physics.parameters import Parameters


class NotReachedError(Exception):
    """A method has no answer: it ran out of time, failed or met the same event without end."""


class Method:
    """One way to solve the problems.

    Attributes:
        name: name in tables and legends.
        formulation: how the problem is put to it, in a few words.
        package: the distribution whose version is reported.
        fixed: whether its resolution is the length of a step; else it is a tolerance.
        located: whether it locates every event.
        batch: how many trajectories it is given at once; 1 if one after the other.
        vectorized: whether those of a batch run in vectors; else it spreads the cost of a call.
    """

    name: str
    formulation: str = ""
    package: str = "vibralign"
    fixed: bool = False
    located: bool = True
    batch: int = 1
    vectorized: bool = False
    _is_warm: bool = False

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, deadline: float, /
    ) -> Solution:
        """Integrate every case as fast as the method can.

        Raises:
            NotReachedError: it cannot, or not before ``deadline`` (of ``process_time``).
        """
        raise NotImplementedError

    def answer(self, problem: Problem, resolution: float, deadline: float = math.inf) -> Solution:
        """Integrate the cases of the problem for their answers: by default as ``solve`` does."""
        return self.solve(problem, problem.cases, resolution, deadline)

    def warm(self, problem: Problem, resolution: float) -> None:
        """Compile what solving ``problem`` needs; its time is not counted."""
        if not self._is_warm:
            self._is_warm = True
            with contextlib.suppress(NotReachedError):
                self.solve(problem, problem.cases[:1], 1e-3, math.inf)


def typical_error(answers: Floats, truth: Floats) -> float:
    """Return the 90th percentile, over the cases, of each case's largest error."""
    errors = np.abs(answers - truth).max(axis=1)
    errors[np.isnan(errors)] = np.inf
    return float(np.quantile(errors, 0.9, method="inverted_cdf"))
