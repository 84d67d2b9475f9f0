"""Speed against error: every method on one case of each kind of motion, from coarse to fine.

``make bench`` also uses ``climbed``, the ladder of resolutions, and ``cpu_microseconds``, the time
of a trajectory. The true solution is that of DOP853 with located events at a far smaller
tolerance. Errors and evaluations are the same in every build; CPU times are not, and are kept in a
table of their own.
"""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.methods import METHODS
from benchmarks.methods.base import Method, NotReachedError
from benchmarks.plans import PrecisionPlan
from benchmarks.problems import Floats, Problem, Solution, Verdict, neighbours
from model.events.outcomes import OUTCOME_TEXT, Outcome
from model.physics.parameters import Parameters
from model.runs.simulate import Trajectory, simulate
from model.study.csv_tables import read_records, records_text


class CaseError(ValueError):
    """Error: a case does not end as its configuration says."""


@dataclass(frozen=True)
class Setting:
    """Result of one method on one case at one resolution, a length of steps or a tolerance.

    ``error`` is that of the alignment time, or of the state where the case never aligns. ``events``
    is the number of events that the package locates. ``microseconds`` is the CPU time of one
    trajectory, NaN if its outcome is wrong.
    """

    case: str
    method: str
    resolution: float
    error: float
    rhs_evaluations: int
    verdict: Verdict
    events: int
    microseconds: float = math.nan


@dataclass(frozen=True)
class Truth:
    """True run of a case: outcome, alignment time (NaN if not aligned), state at the end (6,)."""

    outcome: Outcome
    tau_align: float
    state: Floats

    @classmethod
    def of(cls, run: Trajectory) -> "Truth":
        """Return the truth from a trajectory."""
        return cls(run.outcome, run.tau_align, run.state[-1])

    @property
    def size(self) -> float:
        """Largest absolute value of the compared numbers."""
        if self.outcome == Outcome.ALIGNED:
            return self.tau_align
        return float(np.abs(self.state).max())


def problem_of(plan: PrecisionPlan, name: str) -> Problem:
    """Return the case ``name`` of the plan."""
    case = plan.cases[name]
    settings = replace(
        plan.settings.settings,
        horizon=case.until or plan.settings.horizon,
        max_evaluations=plan.ladder.max_evaluations,
        may_settle=False,
    )
    parameters = Parameters(**case.parameters)  # type: ignore[arg-type]
    limit = plan.ladder.max_evaluations_scipy
    return Problem(name, (parameters,), settings, interpreted_evaluations=limit)


def true_run(plan: PrecisionPlan, name: str) -> Trajectory:
    """Return the case ``name`` at the true tolerance.

    Raises:
        CaseError: the case aligns and should not, or should and does not, or is sensitive.
    """
    problem, case = problem_of(plan, name), plan.cases[name]
    truth = simulate(
        problem.cases[0],
        problem.settings,
        tolerance=plan.ladder.true_tolerance,
        max_evaluations=plan.settings.settings.max_evaluations,  # not the ladder's, for methods
    )
    expected = Outcome.ALIGNED if case.until is None else Outcome.HORIZON_REACHED
    place = f"precision.cases.{name}"
    if truth.outcome != expected:
        remedy = "state `until`" if case.until is None else "leave out `until` or make it smaller"
        raise CaseError(
            f"{place}: {OUTCOME_TEXT[truth.outcome]}, expected: {OUTCOME_TEXT[expected]}. Choose "
            f"another operating point, or {remedy}"
        )
    if truth.sensitive:
        raise CaseError(
            f"{place}: is sensitive, so there is no error to measure. Choose another operating "
            "point"
        )
    return truth


def error_of(solution: Solution, truth: Truth) -> tuple[float, Verdict]:
    """Return ``deviation_of``, with an error not below the rounding of the compared number."""
    error, verdict = deviation_of(solution, truth)
    if verdict == Verdict.RIGHT_OUTCOME:
        error = max(error, float(np.spacing(truth.size)))
    return error, verdict


def deviation_of(solution: Solution, truth: Truth) -> tuple[float, Verdict]:
    """Return (error, verdict): the error of the alignment time, or of the state without one."""
    if solution.failure is not None:
        return math.nan, solution.failure
    tau, state = float(solution.tau_align[0]), solution.states[0, -1]
    aligns = truth.outcome == Outcome.ALIGNED
    if math.isnan(tau) == aligns:
        return math.nan, Verdict.WRONG_OUTCOME
    error = abs(tau - truth.tau_align) if aligns else float(np.abs(state - truth.state).max())
    return error, Verdict.RIGHT_OUTCOME


def climbed(
    how: Method, problem: Problem, resolutions: Iterable[float], budget: float = math.inf
) -> Iterator[tuple[float, Solution, float]]:
    """Yield (resolution, solution, CPU seconds) from coarse to fine; a failed solution is NaN.

    Raises:
        NotReachedError: the solutions take more than ``budget`` seconds.
    """
    for resolution in resolutions:
        if budget <= 0.0:
            raise NotReachedError("out of time")
        started = time.thread_time()
        try:
            solution = how.answer(problem, resolution, time.process_time() + budget)
        except NotReachedError:  # a finer resolution may get there
            solution = problem.solution(np.full_like(problem.truth, math.nan), None)
        seconds = time.thread_time() - started
        budget -= seconds
        yield resolution, solution, seconds


def measured(plan: PrecisionPlan, case: str, method: str, truth: Truth) -> Iterator[Setting]:
    """Yield a method's settings on one case from coarse to fine, up to the first over the limit."""
    problem, how = problem_of(plan, case), METHODS[method]
    events = round(problem.events)
    warm = False  # the first run may include compilation
    resolutions = plan.ladder.steps if how.fixed else plan.ladder.tolerances
    for resolution, solution, seconds in climbed(how, problem, resolutions):
        error, verdict = error_of(solution, truth)
        microseconds = math.nan
        if verdict == Verdict.RIGHT_OUTCOME:

            def work(count: int, resolution: float = resolution) -> None:
                how.solve(problem, neighbours(problem.cases, count), resolution, math.inf)

            together = least_batch(how, seconds) if warm else how.batch
            known = seconds if warm and how.batch == 1 else None
            microseconds = cpu_microseconds(work, together, known)
        warm = True
        evaluations = solution.evaluations or 0
        yield Setting(case, method, resolution, error, evaluations, verdict, events, microseconds)
        if verdict == Verdict.TOO_MANY_EVALUATIONS:
            return


# --- Times and tables ---------------------------------------------------------------------------

_REPEATS = 5
_PATIENCE = 0.02  # seconds; a run that takes longer is timed once
_LONG_ENOUGH = 0.005  # seconds that a timed batch should take
_LARGEST_BATCH = 16
_WORTHWHILE = 0.05  # seconds of runs that share the cost of a call, one or two milliseconds


def least_batch(how: Method, seconds: float) -> int:
    """Return the number of runs to time together, where one takes about ``seconds``.

    Without vectors, a batch only spreads the cost of a call, which is negligible for long runs.
    """
    if how.vectorized:
        return how.batch
    return max(1, min(how.batch, int(_WORTHWHILE / max(seconds, 1e-9))))


def cpu_microseconds(
    work: Callable[[int], object], together: int = 1, known: float | None = None
) -> float:
    """Return the CPU time (µs) of a run, the median of batches.

    Args:
        work: ``work(count)`` makes ``count`` runs; it must be compiled.
        together: smallest number of runs in a batch.
        known: seconds that ``together`` runs took before; long runs are then not repeated.
    """
    once = _cpu_seconds(work, together) if known is None else known
    if once > _PATIENCE:
        return 1e6 * once / together
    fitting = int(_LONG_ENOUGH * together / max(once, 1e-9))
    count = max(together, min(_LARGEST_BATCH, fitting))
    repeats = [_cpu_seconds(work, count) / count for _ in range(_REPEATS)]
    return 1e6 * float(np.median(repeats))


def _cpu_seconds(work: Callable[[int], object], count: int) -> float:
    started = time.thread_time()
    work(count)
    return time.thread_time() - started


_FORMATS = {"resolution": "g", "error": ".3e", "microseconds": ".1f"}


def table_of(settings: Sequence[Setting], *, times: bool) -> str:
    """Return the settings as CSV, with or without CPU times, which differ between builds."""
    return records_text(Setting, settings, _FORMATS, without="" if times else "microseconds")


def read_settings(path: Path) -> list[Setting]:
    """Return the settings of a table by ``table_of``; missing times are NaN.

    Raises:
        TableError: the file is missing or no such table.
    """
    return read_records(path, "speed against error", Setting)
