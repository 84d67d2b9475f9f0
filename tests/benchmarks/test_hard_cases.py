"""Hard cases: the mark of a method on a case, from its runs and from made-up ones."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.hard_cases import (
    BATCH,
    CertainTruth,
    Judged,
    Mark,
    judge,
    mark_of,
    methods_for,
    problem_of,
    read_judged,
    table_of,
    true_run,
)
from benchmarks.methods import METHODS
from benchmarks.plans import hard_cases_plan
from benchmarks.problems import Solution, Verdict
from model.events.outcomes import Outcome
from model.study.config import load_study, study_path

STATE = np.zeros(6)
NAN = math.nan
ALIGNS = CertainTruth(Outcome.ALIGNED, 5.0, STATE, 1e-9)
STAYS = CertainTruth(Outcome.HORIZON_REACHED, NAN, STATE, 1e-9)
LEAVES = CertainTruth(Outcome.LEFT_SCENE, NAN, STATE, 1e-9)
WILD = CertainTruth(Outcome.HORIZON_REACHED, NAN, STATE, 0.5)


def ended(tau, state, evaluations, failure=None):
    return Solution(np.array([tau]), state.reshape(1, 1, 6), evaluations, failure)


@pytest.mark.parametrize(
    ("solution", "truth", "mark", "verdict", "error"),
    [
        (ended(5.00001, STATE, 1), ALIGNS, Mark.STABLE, Verdict.RIGHT_OUTCOME, 1e-5),
        (ended(5.01, STATE, 1), ALIGNS, Mark.INACCURATE, Verdict.RIGHT_OUTCOME, 1e-2),
        (ended(NAN, STATE, 1), ALIGNS, Mark.INACCURATE, Verdict.WRONG_OUTCOME, NAN),
        (ended(NAN, STATE + 1e-5, 1), STAYS, Mark.STABLE, Verdict.RIGHT_OUTCOME, 1e-5),
        (ended(NAN, STATE + 1e-3, 1), STAYS, Mark.INACCURATE, Verdict.RIGHT_OUTCOME, 1e-3),
        (ended(3.0, STATE, 1), STAYS, Mark.INACCURATE, Verdict.WRONG_OUTCOME, NAN),
        (ended(NAN, STATE * NAN, 1), STAYS, Mark.BROKEN, Verdict.FAILED, NAN),
        (ended(NAN, STATE + 1.0, 1), LEAVES, Mark.STABLE, Verdict.RIGHT_OUTCOME, NAN),
        (ended(NAN, STATE + 1.0, 1), WILD, Mark.STABLE, Verdict.RIGHT_OUTCOME, NAN),
        (ended(NAN, STATE, 1, Verdict.FAILED), STAYS, Mark.BROKEN, Verdict.FAILED, NAN),
        (
            ended(NAN, STATE, 1, Verdict.TOO_MANY_EVALUATIONS), ALIGNS, Mark.OVER_BUDGET,
            Verdict.TOO_MANY_EVALUATIONS, NAN,
        ),
    ],
)  # fmt: skip
def test_a_run_is_marked_by_its_outcome_and_error(solution, truth, mark, verdict, error):
    found = mark_of(solution, truth, 1e-4)
    assert found[1:] == (verdict, mark)
    assert found[0] == pytest.approx(error, rel=1e-6, nan_ok=True)


@pytest.fixture(scope="module")
def plan():
    study = load_study(study_path())
    few = {name: study.hard_cases.cases[name] for name in ("no_friction", "unloaded")}
    base = study.hard_cases.base.model_copy(update={"stiffness": [1e4], "damping": [0.0, 1e4]})
    spec = study.hard_cases.model_copy(update={"cases": few, "base": base})
    return hard_cases_plan(study.model_copy(update={"hard_cases": spec}))


def test_every_stiffness_meets_every_damping(plan):
    names = list(plan.spec.all_cases)
    assert names == ["base_10000_0", "base_10000_10000", "no_friction", "unloaded"]
    at = plan.spec.all_cases["base_10000_0"].at
    assert (at["contact_stiffness"], at["contact_damping"]) == (1e4, 0.0)


def test_every_method_has_the_same_budget_on_a_shared_case(plan):
    problem, shared = problem_of(plan, "no_friction"), plan.spec.every_method
    assert problem.settings.max_evaluations == problem.interpreted_evaluations
    assert problem.interpreted_evaluations == shared.max_evaluations
    assert problem_of(plan, "unloaded").settings.max_evaluations == plan.spec.max_evaluations
    truth = true_run(plan, "no_friction")
    judged = [
        judge(plan, "no_friction", method, truth) for method in methods_for(plan, "no_friction")
    ]
    assert all(each.rhs_evaluations <= shared.max_evaluations + 1 for each in judged)
    assert all(each.mark is not Mark.BROKEN for each in judged)


def test_the_located_method_is_stable_where_a_coarse_step_is_not(plan):
    truth = true_run(plan, "base_10000_10000")
    assert truth.uncertainty < 1e-7
    judged = {name: judge(plan, "base_10000_10000", name, truth) for name in METHODS
              if not name.startswith("scipy")}  # fmt: skip
    assert judged["dop853_located"].mark is Mark.STABLE
    # h_a h = 10: far outside the region in which RK4 and Euler are stable.
    assert judged["rk4_fixed"].mark is not Mark.STABLE
    assert judged["semi_implicit_euler_fixed"].mark is not Mark.STABLE


def test_the_batch_engine_is_judged_beside_the_default_on_bases_only(plan):
    assert methods_for(plan, "no_friction") == list(METHODS)
    name = "base_10000_10000"
    compiled = [each for each in METHODS if METHODS[each].package != "scipy"]
    assert methods_for(plan, name) == [*compiled, BATCH]
    truth = true_run(plan, name)
    batch, default = (judge(plan, name, method, truth) for method in (BATCH, "dop853_located"))
    assert batch.mark is default.mark is Mark.STABLE
    assert batch.error < 1e-7 > default.error


def test_a_table_comes_back_as_it_was_written(tmp_path):
    judged = [
        Judged("a", "rk4_fixed", "aligned", Verdict.RIGHT_OUTCOME, Mark.STABLE, 1e-5, 1e-9, 7, 3.0),
        Judged("b", "rk4_fixed", "settled", Verdict.FAILED, Mark.BROKEN, NAN, math.inf, 8, 4.0),
    ]
    timed, plain = tmp_path / "timed.csv", tmp_path / "plain.csv"
    timed.write_text(table_of(judged, times=True), encoding="utf-8")
    plain.write_text(table_of(judged, times=False), encoding="utf-8")
    assert [vars(replace(each, error=0.0)) for each in read_judged(timed)] == [
        vars(replace(each, error=0.0)) for each in judged
    ]
    assert math.isnan(read_judged(plain)[0].microseconds)
    assert "microseconds" not in plain.read_text(encoding="utf-8")
