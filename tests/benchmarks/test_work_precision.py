"""The comparison of methods: errors against the truth, settings, times."""

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks import work_precision
from benchmarks.methods import METHODS
from benchmarks.methods.package import Package
from benchmarks.plans import CasePlan, PrecisionPlan, precision_plan
from benchmarks.problems import Floats, Solution, Verdict
from benchmarks.work_precision import (
    CaseError,
    Setting,
    Truth,
    cpu_microseconds,
    error_of,
    least_batch,
    measured,
    read_settings,
    table_of,
    true_run,
)
from model.events.outcomes import Outcome
from model.runs.simulate import Trajectory
from model.study.config import load_study, study_path

STATE = np.zeros(6)

# Cases of a device of their own, so that another device of the study changes no number below.
DEVICE = {
    "half_width": 0.8891, "half_height": 4.067, "inertia": 5.863, "lateral_stiffness": 0.359,
    "lateral_damping": 0.1073, "axial_damping": 0.1553, "tilt_damping": 0.2513,
}  # fmt: skip
POINTS = {
    "aligned": (0.5729, 2.0, 0.02, 21.59),
    "sticking": (0.5729, 3.0, 0.25, 21.59),
    "bouncing": (12.0, 1.738, 0.1858, 3.0),
    "never_aligning": (0.5729, 1.0, 0.3, 21.59),
}
NAMES = ("frequency", "press_force", "friction", "tilt_stiffness")


def ended(tau: float, state: Floats, evaluations: int, failure: Verdict | None = None) -> Solution:
    return Solution(np.array([tau]), state.reshape(1, 1, 6), evaluations, failure)


@pytest.fixture(scope="module")
def plan() -> PrecisionPlan:
    full = precision_plan(load_study(study_path()))
    ladder = full.ladder.model_copy(
        update={
            "tolerances": [1e-4, 1e-7],
            "steps": [0.01, 0.001, 0.0001],
            "max_evaluations": 25_000,
            "max_evaluations_scipy": 2_000,
        }
    )
    cases = {
        name: CasePlan(
            parameters=full.cases["aligned"].parameters
            | DEVICE
            | dict(zip(NAMES, point, strict=True)),
            until=30.0 if name == "never_aligning" else None,
        )
        for name, point in POINTS.items()
    }
    return full.model_copy(update={"ladder": ladder, "cases": cases})


@pytest.fixture(scope="module")
def truths(plan: PrecisionPlan) -> dict[str, Trajectory]:
    return {name: true_run(plan, name) for name in plan.cases}


def test_the_cases_of_the_study_are_of_the_kinds_they_stand_for() -> None:
    plan = precision_plan(load_study(study_path()))
    truths = {name: true_run(plan, name) for name in plan.cases}
    aligned, sticking, bouncing = (truths[each] for each in ("aligned", "sticking", "bouncing"))
    assert (aligned.separations, sticking.separations) == (0, 0)
    assert aligned.sticking_share == 0.0
    assert sticking.sticking_share > 0.75
    assert bouncing.separations > 5
    never = truths["never_aligning"]
    assert never.outcome == Outcome.HORIZON_REACHED
    assert never.separations > 1
    for truth in (aligned, sticking, bouncing):
        assert truth.outcome == Outcome.ALIGNED
        assert truth.tau_error < 1e-11


def test_a_case_that_does_not_do_as_stated_is_refused(plan: PrecisionPlan) -> None:
    def with_case(name: str, **changes: object) -> PrecisionPlan:
        cases = plan.cases | {name: plan.cases[name].model_copy(update=changes)}
        return plan.model_copy(update={"cases": cases})

    with pytest.raises(CaseError, match=r"precision.cases.aligned: the part fell .* leave out"):
        true_run(with_case("aligned", until=30.0), "aligned")
    with pytest.raises(CaseError, match=r"precision.cases.never_aligning: .* or state `until`"):
        true_run(with_case("never_aligning", until=None), "never_aligning")


@pytest.mark.parametrize("method", METHODS)
def test_every_method_comes_near_the_truth_where_the_motion_is_smooth(
    plan: PrecisionPlan, truths: dict[str, Trajectory], method: str
) -> None:
    settings = list(measured(plan, "aligned", method, Truth.of(truths["aligned"])))
    assert settings[0].verdict == Verdict.RIGHT_OUTCOME
    assert settings[0].error < 0.1
    if METHODS[method].located:
        assert settings[-1].error < 1e-5
    assert [setting.resolution for setting in settings] == sorted(
        (setting.resolution for setting in settings), reverse=True
    )


def test_a_ladder_ends_at_the_first_setting_that_costs_too_much(
    plan: PrecisionPlan, truths: dict[str, Trajectory]
) -> None:
    settings = list(measured(plan, "bouncing", "rk4_fixed", Truth.of(truths["bouncing"])))
    assert [setting.resolution for setting in settings] == [0.01, 0.001]
    assert settings[0].rhs_evaluations == pytest.approx(4 * 8.01 / 0.01, rel=0.01)
    assert [setting.verdict for setting in settings] == [
        Verdict.RIGHT_OUTCOME, Verdict.TOO_MANY_EVALUATIONS,
    ]  # fmt: skip
    (only,) = measured(plan, "sticking", "scipy_rk45", Truth.of(truths["sticking"]))
    assert only.verdict == Verdict.TOO_MANY_EVALUATIONS
    assert only.rhs_evaluations == 2_001
    assert math.isnan(only.error)


def test_an_error_is_that_of_the_time_or_of_the_state(truths: dict[str, Trajectory]) -> None:
    aligned, never = Truth.of(truths["aligned"]), Truth.of(truths["never_aligning"])
    late = ended(aligned.tau_align + 0.25, STATE, 10)
    assert error_of(late, aligned) == (pytest.approx(0.25), Verdict.RIGHT_OUTCOME)
    exact, _ = error_of(ended(aligned.tau_align, STATE, 10), aligned)
    assert 0.0 < exact < 1e-14, "no error is below rounding"
    off = never.state + np.array([0.0, 0.0, 0.1, 0.0, -0.3, 0.0])
    assert error_of(ended(math.nan, off, 10), never) == (pytest.approx(0.3), 0)
    for solution, truth in ((ended(math.nan, STATE, 1), aligned), (late, never)):
        error, verdict = error_of(solution, truth)
        assert verdict == Verdict.WRONG_OUTCOME
        assert math.isnan(error)
    failed = ended(aligned.tau_align, STATE, 10, Verdict.FAILED)
    assert error_of(failed, aligned)[1] == Verdict.FAILED


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """A clock in place of the processor's; what runs moves it."""
    now = [0.0]
    monkeypatch.setattr(work_precision.time, "thread_time", lambda: now[0])
    return now


def test_a_short_run_is_timed_in_batches_and_a_long_one_once(clock: list[float]) -> None:
    calls: list[int] = []

    def takes(seconds: float):
        def work(count: int) -> None:
            calls.append(count)
            clock[0] += seconds * count * (1.0 if len(calls) != 3 else 50.0)  # one disturbed batch

        return work

    assert cpu_microseconds(takes(1e-3)) == pytest.approx(1000.0)
    assert calls == [1, 5, 5, 5, 5, 5]
    calls.clear()
    assert cpu_microseconds(takes(1.0)) == pytest.approx(1e6)
    assert calls == [1]
    calls.clear()
    assert cpu_microseconds(takes(1.0), known=2.0) == pytest.approx(2e6)
    assert calls == []
    assert cpu_microseconds(takes(1e-4), together=16) == pytest.approx(100.0)
    assert calls == [16, 16, 16, 16, 16, 16]
    calls.clear()
    assert cpu_microseconds(takes(1e-2), together=16) == pytest.approx(1e4)
    assert calls == [16]


def test_only_vectors_need_a_batch_where_runs_take_long() -> None:
    in_vectors, one_by_one = Package("batch", "batch", batch=16), METHODS["dop853_located"]
    located = in_vectors, one_by_one
    assert [least_batch(how, 1e-3) for how in located] == [16, 16]
    assert [least_batch(how, 0.01) for how in located] == [16, 5]
    assert [least_batch(how, 1.0) for how in located] == [16, 1]
    assert least_batch(METHODS["scipy_rk45"], 1e-6) == 1


def test_settings_survive_the_disk(tmp_path: Path) -> None:
    settings = [
        Setting("aligned", "rk4_fixed", 0.01, 1.234e-3, 100, Verdict.RIGHT_OUTCOME, 7, 12.3),
        Setting("bouncing", "scipy_radau", 1e-4, math.nan, 5, Verdict.FAILED, 7),
    ]
    path = tmp_path / "precision.csv"
    path.write_text(table_of(settings, times=True), encoding="utf-8")
    first, second = read_settings(path)
    assert first == settings[0]
    assert second.verdict == Verdict.FAILED
    assert math.isnan(second.error)
    assert math.isnan(second.microseconds)
    path.write_text(table_of(settings, times=False), encoding="utf-8")
    assert math.isnan(read_settings(path)[0].microseconds)
