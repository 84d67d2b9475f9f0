"""The table of ``make bench``: settings at the target error, times in turn, rows and remarks."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from verification.bench.methods.base import Method, NotReachedError
from verification.bench.problems import Problem, Solution
from verification.bench.table import TARGET, TOLERANCES, Row, compare, loosest, text
from verification.bench.trajectories import W1, W2
from vibralign import Parameters, Settings, simulate


class Pretended(Method):
    """Errs by ``factor`` times its tolerance and counts its calls.

    It fails on ``lost`` cases, and on all at tolerances above ``fails_above``.
    """

    def __init__(
        self,
        name: str = "ours",
        factor: float = 0.9,
        lost: int = 0,
        batch: int = 1,
        fails_above: float = 1.0,
    ) -> None:
        self.name, self.factor, self.lost, self.batch = name, factor, lost, batch
        self.fails_above = fails_above
        self.calls: list[tuple[int, float]] = []

    def solve(
        self,
        problem: Problem,
        cases: Sequence[Parameters],
        tolerance: float,
        deadline: float,  # noqa: ARG002 - the interface
    ) -> Solution:
        if len(cases) == self.lost or tolerance > self.fails_above:
            raise NotReachedError("endless events")
        self.calls.append((len(cases), tolerance))
        error = self.factor * tolerance
        return problem.solution(np.full((len(cases), 1), 5.0 + error), 10 * len(cases))


@pytest.fixture
def problem(monkeypatch: pytest.MonkeyPatch) -> Problem:
    monkeypatch.setattr(Problem, "truth", property(lambda _: np.full((2, 1), 5.0)))
    return Problem("p", (W1, W2), Settings(horizon=10.0))


@pytest.mark.parametrize(
    ("factor", "tolerance"), [(0.9, 1e-8), (0.1, 1e-7), (2.0, 3.16e-9), (30.0, 3.16e-10), (0, 1e-4)]
)
def test_the_loosest_tolerance_that_keeps_the_target_is_found(
    problem: Problem, factor: float, tolerance: float
) -> None:
    method = Pretended(factor=factor)
    row = loosest(method, problem, budget=60.0)
    assert row.tolerance == tolerance
    assert row.true_error == pytest.approx(factor * tolerance, rel=1e-6)
    assert row.true_error <= TARGET
    tried = [resolution for count, resolution in method.calls if count == 2]
    assert tried == TOLERANCES[: TOLERANCES.index(tolerance) + 1]


def test_a_method_that_fails_at_coarse_tolerances_is_asked_for_finer_ones(problem: Problem) -> None:
    assert loosest(Pretended(fails_above=2e-10), problem, budget=60.0).tolerance == 1e-10


def test_a_method_out_of_time_is_not_asked_for_more(problem: Problem) -> None:
    method = Pretended()
    assert loosest(method, problem, budget=1e-9).remark == "out of time"
    assert len([count for count, _ in method.calls if count == 2]) == 1


def test_times_are_of_one_trajectory_and_evaluations_too(problem: Problem) -> None:
    method = Pretended()
    (row,) = compare(problem, [method], budget=60.0, rounds=3)
    assert row.evaluations == 10.0
    assert row.ratio == 1.0
    assert 0.0 < row.microseconds < 1e6
    assert set(method.calls[-3:]) == {(2, 1e-8)}


def test_a_method_that_fails_on_the_batch_is_told_apart_and_comes_last(problem: Problem) -> None:
    found, lost = compare(
        problem, [Pretended("found"), Pretended("lost", lost=6, batch=6)], budget=60.0, rounds=1
    )
    assert np.isnan(lost.microseconds)
    assert lost.remark == "endless events"
    assert (found.method, found.ratio) == ("found", 1.0)
    assert found.events == np.mean([simulate(case, horizon=10.0).events for case in (W1, W2)])


def test_the_text_says_why_a_method_has_no_number() -> None:
    row = Row("W1", "theirs", 1e-9, 1e-9, 1.0, math.nan, 0.25, 8.0)
    late = Row("W1", "late", events=8.0, remark="out of time")
    head, _, first, last = text([row, late]).splitlines()
    assert head == "W1, true error 1e-08, 8.0 events"
    assert first.split() == ["theirs", "1", "0.25", "1e-09", "1e-09"]
    assert last.split(maxsplit=1) == ["late", "out of time"]
