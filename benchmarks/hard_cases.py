"""Hard cases: every method on scenes that are hard to integrate.

A method is *stable* on a case if its outcome is right and its error within the required accuracy,
*inaccurate* if it gives another answer, *over budget* if it needs more evaluations than it may, and
*broken* if it gives no answer otherwise. The true solution is that of DOP853 with located events
at a far smaller tolerance. If two such tolerances disagree, only the outcome is judged.

Every method of the speed-against-error comparison runs the cases of ``spec.every_method``, all
within the same budget; the compiled ones run the others too. The batch engine (Taylor series) is
judged as ``BATCH``, on the cases that vary the base.
"""

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

import numpy as np

from benchmarks.methods import METHODS
from benchmarks.methods.base import Method
from benchmarks.methods.package import BatchEngine
from benchmarks.plans import HardCasesPlan
from benchmarks.problems import Problem, Solution, Verdict, last_state
from benchmarks.work_precision import Truth, deviation_of
from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.study.csv_tables import read_records, records_text

BATCH = "batch"

_COARSER_TRUTH = 100.0  # tolerance of the second true run over that of the first
_TRUE_EVALUATIONS = 2_000_000_000  # true runs have no practical limit


class Mark(Enum):
    """Mark of a method on a case."""

    STABLE = "stable"
    INACCURATE = "inaccurate"
    OVER_BUDGET = "over budget"
    BROKEN = "broken"


@dataclass(frozen=True)
class CertainTruth(Truth):
    """The true run of a case; ``uncertainty`` is the error of its alignment time or final state."""

    uncertainty: float


@dataclass(frozen=True)
class Judged:
    """Result of one method on one case.

    ``outcome`` and ``uncertainty`` are those of the true run. ``error`` is NaN if only the outcome
    is judged. ``microseconds`` is the CPU time of this single run.
    """

    case: str
    method: str
    outcome: str
    verdict: Verdict
    mark: Mark
    error: float
    uncertainty: float
    rhs_evaluations: int
    microseconds: float = math.nan


HARD_METHODS: Mapping[str, Method] = {
    **METHODS,
    BATCH: BatchEngine("batch engine (Taylor series), events located"),
}


def problem_of(plan: HardCasesPlan, name: str) -> Problem:
    """Return the case ``name`` of the plan."""
    case, shared = plan.spec.all_cases[name], plan.spec.every_method
    limit = case.max_evaluations or plan.spec.max_evaluations
    if name in shared.cases:
        limit = shared.max_evaluations
    parameters = Parameters(**plan.parameters).replace(**case.at)  # type: ignore[arg-type]
    settings = replace(
        plan.settings.settings,
        horizon=case.until,
        max_evaluations=limit,
        may_settle=False,
    )
    return Problem(name, (parameters,), settings, interpreted_evaluations=limit)


def methods_for(plan: HardCasesPlan, name: str) -> list[str]:
    """Return the names of the methods judged on a case, with BATCH if it varies the base."""
    is_shared = name in plan.spec.every_method.cases
    methods = [each for each in METHODS if is_shared or METHODS[each].package != "scipy"]
    return [*methods, *([BATCH] if name not in plan.spec.cases else [])]


def compile_batch(plan: HardCasesPlan) -> None:
    """Run the batch engine on the first case, so that no time includes the compilation."""
    problem = problem_of(plan, next(iter(plan.spec.all_cases)))
    HARD_METHODS[BATCH].answer(problem, plan.spec.tolerance)


def true_run(plan: HardCasesPlan, name: str) -> CertainTruth:
    """Return the case ``name`` at the true tolerance, and its distance from a coarser run."""
    problem, tolerance = problem_of(plan, name), plan.spec.true_tolerance
    settings = replace(problem.settings, max_evaluations=_TRUE_EVALUATIONS)
    rows = settings.rows(Batch.stack(problem.cases))
    (result, state), (coarse, coarse_state) = (
        last_state(settings, rows, np.array([factor * tolerance]))
        for factor in (1.0, _COARSER_TRUTH)
    )
    outcome = Outcome(int(result.outcome))
    uncertainty = float(np.abs(state - coarse_state).max())
    if result.outcome != coarse.outcome:
        uncertainty = math.inf
    elif outcome == Outcome.ALIGNED:
        uncertainty = abs(result.tau_align - coarse.tau_align)
    return CertainTruth(outcome, result.tau_align, state, uncertainty)


def judge(plan: HardCasesPlan, name: str, method: str, truth: CertainTruth) -> Judged:
    """Run ``method`` on the case ``name`` and mark its result."""
    problem, spec, how = problem_of(plan, name), plan.spec, HARD_METHODS[method]
    started = time.thread_time()
    solution = how.answer(problem, spec.step if how.fixed else spec.tolerance)
    seconds = time.thread_time() - started
    error, verdict, mark = mark_of(solution, truth, spec.accurate)
    return Judged(
        case=name,
        method=method,
        outcome=truth.outcome.name.lower(),
        verdict=verdict,
        mark=mark,
        error=error,
        uncertainty=truth.uncertainty,
        rhs_evaluations=solution.evaluations or 0,
        microseconds=1e6 * seconds,
    )


def mark_of(
    solution: Solution, truth: CertainTruth, accurate: float
) -> tuple[float, Verdict, Mark]:
    """Return (error, verdict, mark); the error is NaN if only the outcome can be judged."""
    if solution.failure is None and not np.isfinite(solution.states).all():
        return math.nan, Verdict.FAILED, Mark.BROKEN
    error, verdict = deviation_of(solution, truth)
    if verdict == Verdict.TOO_MANY_EVALUATIONS:
        return math.nan, verdict, Mark.OVER_BUDGET
    if verdict == Verdict.FAILED:
        return math.nan, verdict, Mark.BROKEN
    if verdict == Verdict.WRONG_OUTCOME:
        return math.nan, verdict, Mark.INACCURATE
    # Other methods do not locate the event at which a part leaves: its state there has no error.
    if truth.outcome == Outcome.LEFT_SCENE or truth.uncertainty > 0.1 * accurate:
        return math.nan, verdict, Mark.STABLE
    return error, verdict, Mark.STABLE if error <= accurate else Mark.INACCURATE


# ------------------------------------------------------------------------------------------ tables

_FORMATS = {"error": ".3e", "uncertainty": ".1e", "microseconds": ".0f"}


def table_of(judged: list[Judged], *, times: bool) -> str:
    """Return the judged runs as CSV, with or without CPU times, which differ between builds."""
    return records_text(Judged, judged, _FORMATS, without="" if times else "microseconds")


def read_judged(path: Path) -> list[Judged]:
    """Return the judged runs of a table by ``table_of``; missing times are NaN.

    Raises:
        TableError: the file is missing or no such table.
    """
    return read_records(path, "hard cases", Judged)
