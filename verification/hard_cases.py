"""Hard cases: what every method of the comparison makes of scenes that are hard to integrate.

A method is stable on a case where it comes to the right outcome within the accuracy asked for,
inaccurate where it answers, but wrongly or less accurately, and broken where it gives no answer.
The true solution is the default method's at a far smaller tolerance; where two such tolerances
disagree, errors of a state mean nothing and only the outcome is judged.

The batch engine, which steps by Taylor series, is judged on the bases beside the methods of the
speed-against-error comparison, as ``BATCH``.
"""

import math
import time
from dataclasses import dataclass, fields, replace
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.engines.batch.scheduling import integrate_all, new_many
from model.engines.queue import new_queue
from model.engines.record import STATE
from model.engines.results import RunResult
from model.engines.scalar.loop import integrate_each, new_single
from model.engines.scalar.tableaux import DOP853
from model.events.outcomes import Outcome, Reason
from model.physics.notation import STATE_SIZE
from model.physics.parameters import Batch, Parameters
from model.runs.engines import NO_TRACK, batch_engine
from model.runs.errors import estimate
from model.runs.settings import Settings
from model.study.csv_tables import csv_text, read_rows
from verification.plans import HardCasesPlan
from verification.work_precision import METHODS, Passed, Problem, Verdict, failure_of

DEFAULT, BATCH = "dop853_located", "batch"

_COARSER_TRUTH = 100.0  # tolerance of the second true run over that of the first
_TRUE_EVALUATIONS = 2_000_000_000  # the limit is for the others


class Mark(Enum):
    """What a method is on a case."""

    STABLE = "stable"
    INACCURATE = "inaccurate"
    BROKEN = "broken"


@dataclass(frozen=True)
class Run:
    """How one run ended: outcome, alignment time (NaN if not aligned), final state, shape (6,)."""

    outcome: Outcome
    tau_align: float
    state: NDArray[np.float64]


@dataclass(frozen=True)
class Truth:
    """The true run of a case; ``uncertainty`` of its alignment time or final state."""

    run: Run
    uncertainty: float


@dataclass(frozen=True)
class Judged:
    """One method on one case.

    ``outcome`` is the true one, ``error`` NaN where there is none to measure, ``uncertainty`` that
    of the truth, and ``microseconds`` the CPU time of this one run.
    """

    case: str
    method: str
    outcome: str
    verdict: Verdict
    mark: Mark
    error: float
    uncertainty: float
    rhs_evaluations: int
    microseconds: float


def problem_of(plan: HardCasesPlan, name: str) -> Problem:
    """The case ``name`` as methods get it."""
    case = plan.spec.all_cases[name]
    parameters = Parameters(**plan.parameters).replace(**case.at)  # type: ignore[arg-type]
    settings = replace(
        plan.settings.settings,
        horizon=case.until,
        max_evaluations=case.max_evaluations or plan.spec.max_evaluations,
        may_settle=False,
    )
    return Problem(parameters, settings, plan.spec.max_evaluations_scipy)


def run_once(parameters: Parameters, settings: Settings, *, batch: bool = False) -> Run:
    """One run by the reference or the batch engine, without an estimate of its error or a track."""
    rows = Batch.stack([parameters]).constants(settings.readings)
    tolerances, queue = np.array([settings.tolerance]), new_queue(waiting=1, threads=1)
    endings = np.empty((1, len(RunResult._fields)))
    if batch:
        many = new_many(settings.may_settle)
        integrate_all(rows, tolerances, *settings.for_kernels, queue, endings, many)
        runs = many.runs
    else:
        single = new_single(settings.method.method)
        integrate_each(rows, tolerances, *settings.for_kernels, NO_TRACK, queue, endings, single)
        runs = single.runs
    ending = RunResult(*endings[0].tolist())
    state = runs[0, STATE : STATE + STATE_SIZE].copy()
    return Run(Outcome(int(ending.outcome)), ending.tau_align, state)


def batch_run(problem: Problem, tolerance: float) -> Passed:
    """The batch engine; the runs that estimate its error count."""
    settings = replace(problem.settings, tolerance=tolerance)
    rows = Batch.stack([problem.parameters]).constants(settings.readings)
    found = estimate(batch_engine(settings), rows, tolerance)
    finer = replace(settings, tolerance=float(found.tolerance[0]))
    run = run_once(problem.parameters, finer, batch=True)
    reason = Reason(int(found.columns()["reason"][0]))
    failure = failure_of(run.outcome, reason)
    return Passed(run.tau_align, run.state, int(found.rhs_evaluations[0]), failure)


def methods_for(plan: HardCasesPlan, name: str) -> list[str]:
    """Names of the methods judged on the case ``name``: all, and BATCH on the bases."""
    return [*METHODS, *([BATCH] if name not in plan.spec.cases else [])]


def compile_batch(plan: HardCasesPlan) -> None:
    """Run the batch engine on the first case, so that no case's time holds the compilation."""
    batch_run(problem_of(plan, next(iter(plan.spec.all_cases))), plan.spec.tolerance)


def true_run(plan: HardCasesPlan, name: str) -> Truth:
    """The case ``name`` at the true tolerance, and how far a coarser one is from it."""
    problem, tolerance = problem_of(plan, name), plan.spec.true_tolerance
    settings = replace(problem.settings, method=DOP853, max_evaluations=_TRUE_EVALUATIONS)
    fine, coarse = (
        run_once(problem.parameters, replace(settings, tolerance=factor * tolerance))
        for factor in (1.0, _COARSER_TRUTH)
    )
    if fine.outcome != coarse.outcome:
        return Truth(fine, math.inf)
    if fine.outcome == Outcome.ALIGNED:
        return Truth(fine, abs(fine.tau_align - coarse.tau_align))
    return Truth(fine, float(np.abs(fine.state - coarse.state).max()))


def judge(plan: HardCasesPlan, name: str, method: str, truth: Truth) -> Judged:
    """Run ``method``, of ``methods_for`` the case ``name``, on it and mark it."""
    problem, spec = problem_of(plan, name), plan.spec
    started = time.thread_time()
    if method == BATCH:
        passed = batch_run(problem, spec.tolerance)
    else:
        how = METHODS[method]
        passed = how.run(problem, spec.step if how.fixed else spec.tolerance)
    seconds = time.thread_time() - started
    error, verdict, mark = mark_of(passed, truth, plan.spec.accurate)
    return Judged(
        case=name,
        method=method,
        outcome=truth.run.outcome.name.lower(),
        verdict=verdict,
        mark=mark,
        error=error,
        uncertainty=truth.uncertainty,
        rhs_evaluations=passed.rhs_evaluations,
        microseconds=1e6 * seconds,
    )


def mark_of(passed: Passed, truth: Truth, accurate: float) -> tuple[float, Verdict, Mark]:
    """(error, verdict, mark) of a run; the error is NaN where only the outcome can be judged."""
    if passed.failure is None and not np.isfinite(passed.state).all():
        return math.nan, Verdict.FAILED, Mark.BROKEN
    error, verdict = _error_of(passed, truth.run)
    if verdict in (Verdict.FAILED, Verdict.TOO_MANY_EVALUATIONS):
        return math.nan, verdict, Mark.BROKEN
    if verdict == Verdict.WRONG_OUTCOME:
        return math.nan, verdict, Mark.INACCURATE
    # A part that leaves the scene does so at a switch that the others do not have.
    if truth.run.outcome == Outcome.LEFT_SCENE or truth.uncertainty > 0.1 * accurate:
        return math.nan, verdict, Mark.STABLE
    return error, verdict, Mark.STABLE if error <= accurate else Mark.INACCURATE


def _error_of(passed: Passed, truth: Run) -> tuple[float, Verdict]:
    """As ``precision.error_of``: of the alignment time, or else of the state at the end."""
    if passed.failure is not None:
        return math.nan, passed.failure
    aligns = truth.outcome == Outcome.ALIGNED
    if math.isnan(passed.tau_align) == aligns:
        return math.nan, Verdict.WRONG_OUTCOME
    if aligns:
        return abs(passed.tau_align - truth.tau_align), Verdict.RIGHT_OUTCOME
    return float(np.abs(passed.state - truth.state).max()), Verdict.RIGHT_OUTCOME


# ------------------------------------------------------------------------------------------ tables

_COLUMNS = tuple(field.name for field in fields(Judged))


def table_of(judged: list[Judged], *, times: bool) -> str:
    """The judged runs as CSV, with or without their CPU times, which are new in every build."""
    columns = _COLUMNS if times else _COLUMNS[:-1]
    rows = map(_row, judged)
    return csv_text(columns, ({name: row[name] for name in columns} for row in rows))


def _row(judged: Judged) -> dict[str, Any]:
    return vars(judged) | {
        "verdict": judged.verdict.name.lower(),
        "mark": judged.mark.value,
        "error": f"{judged.error:.3e}",
        "uncertainty": f"{judged.uncertainty:.1e}",
        "microseconds": f"{judged.microseconds:.0f}",
    }


def read_table(path: Path) -> list[Judged]:
    """What ``table_of`` wrote to ``path``; times that are not there are NaN.

    Raises:
        TableError: a file that is missing or not such a table.
    """
    return read_rows(path, "hard cases", _judged)


def _judged(row: dict[str, str]) -> Judged:
    return Judged(
        case=row["case"],
        method=row["method"],
        outcome=row["outcome"],
        verdict=Verdict[row["verdict"].upper()],
        mark=Mark(row["mark"]),
        error=float(row["error"]),
        uncertainty=float(row["uncertainty"]),
        rhs_evaluations=int(row["rhs_evaluations"]),
        microseconds=float(row.get("microseconds", "nan")),
    )
