"""Error against cost: cases and their truths, errors, settings, times."""

import math

import numpy as np
import pytest

from model.events.outcomes import Outcome
from model.physics.parameters import Parameters
from model.runs.simulate import simulate
from study.config import load_study, study_path
from verification.bench.plans import CasePlan, PrecisionPlan, precision_plan
from verification.bench.problems import Floats, Solution, Verdict
from verification.bench.work_precision import (
    Truth,
    error_of,
    measured,
    problem_of,
    true_run,
)
from verification.independent import solve

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
HARD = ("base_10000_10000",)
NAMES = ("frequency", "press_force", "friction", "tilt_stiffness")


def ended(tau: float, state: Floats, evaluations: int, failure: Verdict | None = None) -> Solution:
    return Solution(np.array([tau]), state.reshape(1, 1, 6), evaluations, failure)


@pytest.fixture(scope="module")
def plan() -> PrecisionPlan:
    full = precision_plan(load_study(study_path()))
    ladder = full.cases["aligned"].ladder.model_copy(
        update={"tolerances": [1e-4, 1e-7], "max_evaluations": 25_000}
    )
    cases = {
        name: CasePlan(
            parameters=full.cases["aligned"].parameters
            | DEVICE
            | dict(zip(NAMES, point, strict=True)),
            until=30.0,
            ladder=ladder,
            independent=name == "aligned",
        )
        for name, point in POINTS.items()
    }
    hard = {name: full.cases[name] for name in HARD}
    return full.model_copy(update={"cases": cases | hard})


@pytest.fixture(scope="module")
def truths(plan: PrecisionPlan) -> dict[str, Truth]:
    return {name: true_run(plan, name) for name in plan.cases}


def test_the_cases_of_the_study_are_of_the_kinds_they_stand_for() -> None:
    plan = precision_plan(load_study(study_path()))
    problems = [problem_of(plan, name) for name in POINTS]
    aligned, sticking, bouncing, never = (
        simulate(each.cases[0], each.settings, tolerance=1e-10) for each in problems
    )
    assert (aligned.separations, sticking.separations) == (0, 0)
    assert aligned.sticking_share == 0.0
    assert sticking.sticking_share > 0.75
    assert bouncing.separations > 5
    assert never.outcome == Outcome.HORIZON_REACHED
    assert never.separations > 1
    for each in (aligned, sticking, bouncing):
        assert each.outcome == Outcome.ALIGNED
        assert each.sensitive == 0


def test_every_stiffness_meets_every_damping_and_a_case_may_have_a_limit_of_its_own() -> None:
    study = load_study(study_path())
    plan, hard = precision_plan(study), study.precision.hard
    bases = len(hard.base.stiffness) * len(hard.base.damping)
    assert len(plan.cases) == len(POINTS) + bases + len(hard.cases)
    parameters = plan.cases["base_10000_0"].parameters
    assert (parameters["contact_stiffness"], parameters["contact_damping"]) == (1e4, 0.0)
    assert plan.cases["unloaded"].ladder.max_evaluations == hard.ladder.max_evaluations
    assert plan.cases["many_lift_offs"].ladder.max_evaluations == 4_000_000


def test_a_ladder_goes_from_coarse_to_fine_and_ends_where_it_costs_too_much(
    plan: PrecisionPlan, truths: dict[str, Truth]
) -> None:
    coarse, fine = measured(plan, "aligned", truths["aligned"])
    assert (coarse.verdict, fine.verdict) == (Verdict.RIGHT_OUTCOME,) * 2
    assert (coarse.tolerance, fine.tolerance) == (1e-4, 1e-7)
    assert fine.error < 1e-5
    assert coarse.microseconds > 0.0
    ladder = plan.cases["bouncing"].ladder.model_copy(update={"max_evaluations": 50})
    case = plan.cases["bouncing"].model_copy(update={"ladder": ladder})
    (only,) = measured(plan.model_copy(update={"cases": {"bouncing": case}}), "bouncing",
                       truths["bouncing"])  # fmt: skip
    assert only.verdict == Verdict.TOO_MANY_EVALUATIONS
    assert math.isnan(only.error)


@pytest.mark.parametrize(
    ("outcome", "uncertainty"), [(Outcome.LEFT_SCENE, 1e-9), (Outcome.HORIZON_REACHED, 0.5)]
)
def test_an_error_is_unknown_where_the_part_leaves_or_two_true_runs_differ(
    outcome: Outcome, uncertainty: float
) -> None:
    truth = Truth(outcome, math.nan, 30.0, STATE, uncertainty, 3)
    error, verdict = error_of(ended(math.nan, STATE + 1.0, 1), truth)
    assert math.isnan(error)
    assert verdict == Verdict.RIGHT_OUTCOME
    assert error_of(ended(3.0, STATE, 1), truth)[1] == Verdict.WRONG_OUTCOME


def test_a_truth_is_the_independent_solution_beside_the_engines_run(
    plan: PrecisionPlan, truths: dict[str, Truth]
) -> None:
    case, truth = plan.cases["aligned"], truths["aligned"]
    parameters = Parameters(**case.parameters)  # type: ignore[arg-type]
    assert truth.tau_align == solve(parameters, case.until).tau
    run = simulate(parameters, tolerance=1e-13)
    assert truth.uncertainty == pytest.approx(abs(run.tau_align - truth.tau_align), abs=1e-13)
    assert 0.0 < truth.uncertainty < 1e-10
    assert truths["never_aligning"].end == plan.cases["never_aligning"].until
    assert 0.0 < truths["never_aligning"].uncertainty < 1e-5
    assert not plan.cases["base_10000_10000"].independent


def test_an_error_is_that_of_the_time_or_of_the_state(truths: dict[str, Truth]) -> None:
    aligned, never = truths["aligned"], truths["never_aligning"]
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
    assert error_of(ended(math.nan, STATE * math.nan, 1), never)[1] == Verdict.FAILED
    failed = ended(aligned.tau_align, STATE, 10, Verdict.FAILED)
    assert error_of(failed, aligned)[1] == Verdict.FAILED
