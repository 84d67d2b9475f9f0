"""The package as a method: ``align``, and single runs."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from model.physics.parameters import Batch, Parameters
from model.runs.align import align, run_once
from model.runs.settings import Settings
from verification.bench.methods.base import Method
from verification.bench.problems import Problem, Solution, ran_once, simulated


class Package(Method):
    """``align``: all events located, with an error estimate, mostly in one run of a set.

    States come from single runs, because ``align`` returns none.
    """

    def __init__(self, name: str, batch: int = 1024) -> None:
        self.name, self.batch = name, batch

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        runs = align(cases, _settings(problem, tolerance), cores=1)
        return _of_times(problem, runs.tau_align, runs.rhs_evaluations)

    def answer(self, problem: Problem, tolerance: float, _deadline: float = math.inf) -> Solution:
        """As ``Method.answer``."""
        return simulated(problem, _settings(problem, tolerance))


class OneRun(Package):
    """The package used like a peer: one run of a set up to alignment, no error estimate."""

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        settings = replace(_settings(problem, tolerance), alignment_only=True, may_settle=False)
        runs = run_once(Batch.stack(cases), settings, cores=1)
        return _of_times(problem, runs["tau_align"], runs["rhs_evaluations"])

    def answer(self, problem: Problem, tolerance: float, deadline: float = math.inf) -> Solution:
        """As ``Method.answer``; without checkpoints as ``solve``."""
        if problem.checkpoints:
            return ran_once(problem, _settings(problem, tolerance))
        return self.solve(problem, problem.cases, tolerance, deadline)


def _settings(problem: Problem, tolerance: float) -> Settings:
    return replace(problem.settings, tolerance=tolerance)


def _of_times(problem: Problem, tau: np.ndarray, evaluations: np.ndarray) -> Solution:
    states = np.full((tau.size, len(problem.stops), 6), math.nan)
    return Solution(tau, states, int(evaluations.sum()))
