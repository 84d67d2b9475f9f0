"""The package itself: ``align`` on a batch, by each of its engines, as a user calls it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.methods.base import BATCH, Method, Solution, typical_error
from benchmarks.problems import Problem, answers
from model import Batch, Parameters, Settings, align
from model.runs.align import run_once
from model.runs.engines import Engine


class Vibralign(Method):
    """``align`` with one engine: two runs of each set, or more, which yields its error estimate."""

    package = "vibralign"
    batch = BATCH
    formulation = "align, two runs each with error estimate"

    def __init__(self, engine: Engine) -> None:
        self.name, self.engine = f"vibralign {engine}", engine

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``; ``align`` tells alignment times, but no states."""
        settings = _settings(problem, tolerance)
        runs = align(cases, settings, cores=1, engine=self.engine)
        return Solution(runs.tau_align[:, np.newaxis], int(runs.rhs_evaluations.sum()))

    def error(self, problem: Problem, tolerance: float, deadline: float) -> float:
        """As ``Method.error``; states are those of ``simulate`` at the same tolerance."""
        if problem.checkpoints:
            return typical_error(answers(problem, problem.cases, tolerance), problem.truth)
        return super().error(problem, tolerance, deadline)


class OneRun(Vibralign):
    """The batch engine, one run of each set up to alignment without an error estimate, as peers."""

    formulation = "one run each up to alignment, no error estimate"

    def __init__(self) -> None:
        super().__init__("batch")
        self.name = "vibralign batch, one run"

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""
        settings = replace(_settings(problem, tolerance), alignment_only=True, may_settle=False)
        runs = run_once(Batch.stack(cases), settings, cores=1)
        return Solution(runs["tau_align"][:, np.newaxis], int(runs["rhs_evaluations"].sum()))


def _settings(problem: Problem, tolerance: float) -> Settings:
    return Settings(
        tolerance=tolerance, horizon=problem.horizon, may_settle=not problem.checkpoints
    )


def engines() -> list[Vibralign]:
    """The one it is to be known by first."""
    return [Vibralign("batch"), OneRun(), Vibralign("scalar")]
