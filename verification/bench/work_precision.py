"""Error against cost: the package on every case, from coarse to fine.

Cases are an operating point of each kind of motion, and scenes that are hard to integrate. The true
solution is the independent one (``verification.independent``), or, where that takes too long, that
of the package at a far smaller tolerance. Errors and evaluations are the same in every build; CPU
times are not, and are kept in a table of their own.

``make bench`` also uses ``climbed``, the ladder of tolerances, and ``cpu_microseconds``, the time
of a trajectory.
"""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.physics.variants import Variants
from study.csv_tables import read_records, records_text
from verification.bench.methods.base import Method, NotReachedError
from verification.bench.methods.package import Package
from verification.bench.plans import PrecisionPlan
from verification.bench.problems import Floats, Problem, Solution, Verdict, last_state, neighbours
from verification.independent.stored import solution_of

_COARSER_TRUTH = 100.0  # tolerance of the second true run over that of the first
_TOGETHER = 16  # runs that spread the cost of a call, where they are short
_TRUE_EVALUATIONS = 2_000_000_000  # true runs have no practical limit
_CERTAIN = 1e-5  # largest uncertainty of a truth with which errors are measured
# How the independent solution ends, by the engine's outcome.
_ENDINGS = {Outcome.ALIGNED: "aligned", Outcome.HORIZON_REACHED: "horizon"}
_ROUNDING = float(np.finfo(float).eps)  # of numbers of order one; no error is below it


@dataclass(frozen=True)
class Truth:
    """True solution of a case.

    ``uncertainty`` is the distance of a second solution: in alignment time, or in the final state.
    That is the package's beside an independent solution, a coarser run beside one of the
    engine; infinite if they end in different ways.
    """

    outcome: Outcome
    tau_align: float  # NaN if not aligned
    end: float  # time of alignment, of leaving the scene, or the horizon
    state: Floats  # at the end, shape (6,)
    uncertainty: float
    events: int

    @property
    def certain(self) -> bool:
        """True if errors can be measured; where a part leaves, outcomes are compared alone."""
        return self.outcome != Outcome.LEFT_SCENE and self.uncertainty <= _CERTAIN


@dataclass(frozen=True)
class Setting:
    """Result of the package on one case at one tolerance.

    ``outcome``, ``uncertainty`` and ``events``, the number of events, are those of the true run.
    ``error`` is that of the alignment time, or of the state where the case does not align; NaN
    where the outcome is wrong, or where only the outcome can be compared. ``microseconds`` is the
    CPU time of one trajectory, NaN if its outcome is wrong.
    """

    case: str
    outcome: str
    uncertainty: float
    events: int
    tolerance: float
    error: float
    rhs_evaluations: int
    verdict: Verdict
    microseconds: float = math.nan


def problem_of(plan: PrecisionPlan, name: str) -> Problem:
    """Return the case ``name`` of the plan."""
    case = plan.cases[name]
    settings = replace(
        plan.settings.settings,
        horizon=case.until,
        max_evaluations=case.ladder.max_evaluations,
        may_settle=False,
    )
    parameters = Parameters(**case.parameters)  # type: ignore[arg-type]
    return Problem(name, (parameters,), settings)


def true_run(plan: PrecisionPlan, name: str) -> Truth:
    """Return the true solution of the case ``name``.

    The independent one has the consistent equations, and press and vibration set in together.
    """
    problem, case = problem_of(plan, name), plan.cases[name]
    settings = replace(problem.settings, max_evaluations=_TRUE_EVALUATIONS)
    (row,), tolerance = settings.rows(Batch.stack(problem.cases)), case.ladder.true_tolerance
    result, state = last_state(settings, row, tolerance)
    outcome, tau = Outcome(int(result.outcome)), float(result.tau_align)
    if case.independent and settings.readings == Variants() and settings.start != "pressed":
        solution = solution_of(problem.cases[0], case.until)
        alike = solution.ending == _ENDINGS.get(outcome)
        tau, other, state, other_state = solution.tau, tau, solution.state, state
    else:
        coarse, other_state = last_state(settings, row, _COARSER_TRUTH * tolerance)
        alike, other = coarse.outcome == outcome, float(coarse.tau_align)
    uncertainty = math.inf
    if alike:
        aligns = outcome == Outcome.ALIGNED
        uncertainty = abs(tau - other) if aligns else float(np.abs(state - other_state).max())
    end = tau if outcome == Outcome.ALIGNED else float(result.time)
    return Truth(outcome, tau, end, state, uncertainty, int(result.events))


def error_of(solution: Solution, truth: Truth) -> tuple[float, Verdict]:
    """Return (error, verdict): the error of the alignment time, or of the state without one."""
    if solution.failure is not None:
        return math.nan, solution.failure
    tau, state = float(solution.tau_align[0]), solution.states[0, -1]
    if not np.isfinite(state).all():
        return math.nan, Verdict.FAILED
    aligns = truth.outcome == Outcome.ALIGNED
    if math.isnan(tau) == aligns:
        return math.nan, Verdict.WRONG_OUTCOME
    if not truth.certain:
        return math.nan, Verdict.RIGHT_OUTCOME
    error = abs(tau - truth.tau_align) if aligns else float(np.abs(state - truth.state).max())
    return max(error, _ROUNDING), Verdict.RIGHT_OUTCOME


def climbed(
    how: Method, problem: Problem, tolerances: Iterable[float], budget: float = math.inf
) -> Iterator[tuple[float, Solution]]:
    """Yield (tolerance, solution) from coarse to fine; a failed solution is NaN.

    Raises:
        NotReachedError: the solutions take more than ``budget`` CPU seconds.
    """
    for tolerance in tolerances:
        if budget <= 0.0:
            raise NotReachedError("out of time")
        started = time.process_time()
        try:
            solution = how.answer(problem, tolerance, time.process_time() + budget)
        except NotReachedError:  # a finer tolerance may get there
            solution = problem.solution(np.full_like(problem.truth, math.nan), None)
        budget -= time.process_time() - started
        yield tolerance, solution


def measured(plan: PrecisionPlan, case: str, truth: Truth) -> Iterator[Setting]:
    """Yield the settings of one case from coarse to fine, up to the first over the limit."""
    problem, how = problem_of(plan, case), Package("vibralign", _TOGETHER)
    tolerances = plan.cases[case].ladder.tolerances
    how.warm(problem, tolerances[0])
    for tolerance, solution in climbed(how, problem, tolerances):
        error, verdict = error_of(solution, truth)
        microseconds = math.nan
        if verdict == Verdict.RIGHT_OUTCOME:

            def work(count: int, tolerance: float = tolerance) -> None:
                how.solve(problem, neighbours(problem.cases, count), tolerance, math.inf)

            microseconds = cpu_microseconds(work, _TOGETHER)
        yield Setting(
            case, truth.outcome.name.lower(), truth.uncertainty, truth.events, tolerance, error,
            solution.evaluations or 0, verdict, microseconds,
        )  # fmt: skip
        if verdict == Verdict.TOO_MANY_EVALUATIONS:
            return


# --- Times and tables ---------------------------------------------------------------------------

_REPEATS = 5
_PATIENCE = 0.02  # seconds; a run that takes longer is timed once
_LONG_ENOUGH = 0.005  # seconds that a timed batch should take
_LARGEST_BATCH = 16


def cpu_microseconds(work: Callable[[int], object], together: int = 1) -> float:
    """Return the CPU time (µs) of a run, the median of batches.

    Args:
        work: ``work(count)`` makes ``count`` runs; it must be compiled.
        together: smallest number of runs in a batch.
    """
    once = _cpu_seconds(work, together)
    if once > _PATIENCE:
        return 1e6 * once / together
    fitting = int(_LONG_ENOUGH * together / max(once, 1e-9))
    count = max(together, min(_LARGEST_BATCH, fitting))
    repeats = [_cpu_seconds(work, count) / count for _ in range(_REPEATS)]
    return 1e6 * float(np.median(repeats))


def _cpu_seconds(work: Callable[[int], object], count: int) -> float:
    started = time.process_time()
    work(count)
    return time.process_time() - started


_FORMATS = {"uncertainty": ".1e", "tolerance": "g", "error": ".3e", "microseconds": ".1f"}


def table_of(settings: Sequence[Setting], *, times: bool) -> str:
    """Return the settings as CSV, with or without CPU times, which differ between builds."""
    return records_text(Setting, settings, _FORMATS, without="" if times else "microseconds")


def read_settings(path: Path) -> list[Setting]:
    """Return the settings of a table by ``table_of``; missing times are NaN.

    Raises:
        ValueError: the file is missing or no such table.
    """
    return read_records(path, "speed against error", Setting)
