"""The package itself: ``align`` on a batch, by each of its engines, as a user calls it."""

import inspect
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from benchmarks.methods.base import Method, Solution, typical_error
from benchmarks.problems import Problem, answers
from model import Parameters, Settings, align

# The field of ``Settings`` that leaves out the second run, which estimates the error.
_ESTIMATE = "estimate_error"


class Vibralign(Method):
    """``align`` with one engine; each set is run twice, which yields its error estimate."""

    package = "vibralign"
    batch = 256

    def __init__(self, name: str, formulation: str, **changes: Any) -> None:
        self.name, self.formulation, self.changes = name, formulation, changes

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``; ``align`` tells alignment times, but no states."""
        runs = align(
            cases,
            tolerance=tolerance,
            horizon=problem.horizon,
            may_settle=not problem.checkpoints,
            cores=1,
            **self.changes,
        )
        return Solution(runs.tau_align[:, np.newaxis], int(runs.rhs_evaluations.sum()))

    def error(self, problem: Problem, tolerance: float, deadline: float) -> float:
        """As ``Method.error``; states are those of ``simulate`` at the same tolerance."""
        if problem.checkpoints:
            return typical_error(answers(problem, problem.cases, tolerance), problem.truth)
        return super().error(problem, tolerance, deadline)


def engines() -> list[Vibralign]:
    """What the installed version offers, the one it is to be known by first."""
    twice = "align, two runs each with error estimate"
    if "engine" not in inspect.signature(align).parameters:
        return [Vibralign("vibralign", twice)]
    offered = [
        Vibralign("vibralign lanes", twice, engine="lanes"),
        Vibralign("vibralign scalar", twice, engine="scalar"),
    ]
    if _ESTIMATE in {field.name for field in fields(Settings)}:
        once = "align, one run each, no error estimate"
        offered.insert(
            1, Vibralign("vibralign lanes, one run", once, engine="lanes", **{_ESTIMATE: False})
        )
    return offered
