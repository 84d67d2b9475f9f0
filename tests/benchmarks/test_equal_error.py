from collections.abc import Callable, Sequence

import numpy as np
import pytest

from benchmarks.equal_error import (
    LOOSEST,
    TIGHTEST,
    Cost,
    Setting,
    cheapest,
    find_setting,
    loosest,
    time_in_turn,
    tolerance_of,
)
from benchmarks.methods.base import Method, NotReachedError
from benchmarks.problems import Problem, Solution
from benchmarks.trajectories import W1, W2
from model import Parameters, Settings


def proportional(factor: float) -> Callable[[int], float]:
    return lambda step: factor * tolerance_of(step)


def test_the_ladder_has_two_steps_a_decade() -> None:
    assert tolerance_of(-16) == 1e-8
    assert tolerance_of(-15) == pytest.approx(3.16e-8)


@pytest.mark.parametrize(
    ("factor", "step"),
    [(1.0, -16), (0.5, -16), (0.1, -14), (2.0, -17), (30.0, -19), (1e-20, LOOSEST)],
)
def test_the_loosest_tolerance_that_keeps_the_target_is_found(factor: float, step: int) -> None:
    assert loosest(proportional(factor), 1e-8, first=-16) == step


def test_a_coarser_ladder_keeps_the_target_too() -> None:
    assert loosest(proportional(2.0), 1e-8, first=-16, every=2) == -18


def test_no_tolerance_is_found_where_none_keeps_the_target() -> None:
    tried = []

    def error_at(step: int) -> float:
        tried.append(step)
        return 1.0

    assert loosest(error_at, 1e-8, first=-16) is None
    assert tried == list(range(-16, TIGHTEST - 1, -1))


class Pretended(Method):
    """Errs by its tolerance and counts its calls."""

    name = "pretended"
    formulation = "none"
    package = "none"

    def __init__(self, fails: bool = False) -> None:
        self.calls: list[tuple[int, float]] = []
        self.fails = fails

    def solve(
        self,
        problem: Problem,
        cases: Sequence[Parameters],
        tolerance: float,
        deadline: float,  # noqa: ARG002 - the interface
    ) -> Solution:
        if self.fails:
            raise NotReachedError("out of time")
        self.calls.append((len(cases), tolerance))
        return problem.solution(np.full((len(cases), 1), 5.0 + tolerance), 10 * len(cases))


@pytest.fixture
def problem(monkeypatch: pytest.MonkeyPatch) -> Problem:
    monkeypatch.setattr(Problem, "truth", property(lambda _: np.full((2, 1), 5.0)))
    return Problem("p", (W1, W2), Settings(horizon=1.0))


def test_a_setting_holds_the_error_measured_at_its_tolerance(problem: Problem) -> None:
    setting = find_setting(Pretended(), problem, 1.1e-8, budget=60.0)
    assert setting.tolerance == 1e-8
    assert setting.error == pytest.approx(1e-8, rel=1e-6)


def test_a_method_out_of_time_is_not_asked_for_more(problem: Problem) -> None:
    method = Pretended(fails=True)
    assert find_setting(method, problem, 1e-5, budget=60.0).reason == "out of time"
    method.fails = False
    assert np.isnan(find_setting(method, problem, 1e-8, budget=60.0).tolerance)
    assert method.calls == []


def test_times_are_of_one_trajectory_and_evaluations_too(problem: Problem) -> None:
    method = Pretended()
    setting = find_setting(method, problem, 1e-8, budget=60.0)
    (cost,) = time_in_turn([setting], rounds=3)
    assert cost.evaluations == 10.0
    assert 0.0 < cost.microseconds < 1e6
    assert {count for count, _ in method.calls[-3:]} == {2}


def test_a_method_that_fails_on_the_batch_is_told_apart_and_keeps_its_place(
    problem: Problem,
) -> None:
    lost, found = Pretended(), Pretended()
    settings = [find_setting(method, problem, 1e-8, budget=60.0) for method in (lost, found)]
    lost.fails = True
    first, second = time_in_turn(settings, rounds=1)
    assert np.isnan(first.microseconds)
    assert first.setting.reason == "out of time"
    assert second.setting is settings[1]
    assert second.microseconds > 0.0


def test_what_keeps_a_tighter_target_at_less_cost_keeps_the_looser_one() -> None:
    one, other = Pretended(), Pretended()
    first, second = (
        Problem("first", (W1,), Settings(horizon=10.0)),
        Problem("second", (W2,), Settings(horizon=10.0)),
    )

    def cost(method: Method, problem: Problem, target: float, microseconds: float) -> Cost:
        return Cost(Setting(method, problem, target, target, target / 2.0), microseconds, 1.0)

    costs = [
        cost(one, first, 1e-5, 6.0), cost(one, first, 1e-8, 5.0), cost(one, second, 1e-8, 1.0),
        cost(other, first, 1e-5, 3.0), cost(other, first, 1e-8, 4.0),
        cost(other, second, 1e-5, np.nan),
    ]  # fmt: skip
    found = cheapest(costs)
    assert [each.microseconds for each in found[:5]] == [5.0, 5.0, 1.0, 3.0, 4.0]
    assert np.isnan(found[5].microseconds)
    assert [each.setting.target for each in found] == [each.setting.target for each in costs]
    assert found[0].setting.tolerance == 1e-8
