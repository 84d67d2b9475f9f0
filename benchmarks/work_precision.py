"""Speed against error: every method on one case of each kind of motion, from coarse to fine.

``make bench`` also uses ``climbed``, the ladder of resolutions, and ``cpu_microseconds``, the time
of a trajectory. The true solution is that of DOP853 with located events at a far smaller
tolerance. Errors and evaluations are the same in every build; CPU times are not, and are kept
apart. In the dataset, the dimension of settings is called ``rung``.
"""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from benchmarks.methods import METHODS
from benchmarks.methods.base import Method, NotReachedError
from benchmarks.plans import PrecisionPlan
from benchmarks.problems import Floats, Problem, Solution, Verdict, neighbours
from model.events.outcomes import OUTCOME_TEXT, Outcome
from model.physics.parameters import PARAMETER_NAMES, Parameters
from model.runs.simulate import Trajectory, simulate
from model.study.csv_tables import read_records, records_text
from model.study.io import flags, global_attributes, parameter_attributes

NAME = "precision"


class CaseError(ValueError):
    """Error: a case does not end as its configuration says."""


@dataclass(frozen=True)
class Setting:
    """Result of one method on one case at one resolution, a length of steps or a tolerance."""

    case: str
    method: str
    resolution: float
    error: float
    rhs_evaluations: int
    verdict: Verdict


@dataclass(frozen=True)
class TimedSetting(Setting):
    """A setting with the CPU time of one trajectory, NaN if its outcome is wrong.

    ``events`` is the number of events that the package locates in the trajectory.
    """

    microseconds: float
    events: int


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


def measured(plan: PrecisionPlan, case: str, method: str, truth: Truth) -> Iterator[TimedSetting]:
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
        yield TimedSetting(
            case, method, resolution, error, evaluations, verdict, microseconds, events
        )
        if verdict == Verdict.TOO_MANY_EVALUATIONS:
            return


def columns_of(
    settings: Sequence[Setting], cases: Sequence[str], rungs: int
) -> dict[str, np.ndarray]:
    """Return the settings as arrays of shape (cases, methods, rungs), in order along a ladder."""
    methods = list(METHODS)
    shape = len(cases), len(methods), rungs
    columns = {
        "resolution": np.full(shape, np.nan),
        "error": np.full(shape, np.nan),
        "rhs_evaluations": np.zeros(shape, np.int64),
        "verdict": np.full(shape, Verdict.NOT_TRIED, np.int8),
    }
    filled = np.zeros(shape[:2], int)
    for setting in settings:
        row = cases.index(setting.case), methods.index(setting.method)
        for name, column in columns.items():
            column[(*row, filled[row])] = getattr(setting, name)
        filled[row] += 1
    return columns


def precision_dataset(
    plan: PrecisionPlan, truths: Mapping[str, Trajectory], settings: Sequence[Setting]
) -> xr.Dataset:
    """Return the settings over case, method and rung, with truth and parameters of each case."""
    cases, methods = list(plan.cases), list(METHODS)
    rungs = max(len(plan.ladder.steps), len(plan.ladder.tolerances))
    variables: dict[str, Any] = {
        name: (("case", "method", "rung"), column, _VARIABLES[name])
        for name, column in columns_of(settings, cases, rungs).items()
    }
    true_times = [truths[case].tau_align for case in cases]
    ends = [np.nan if plan.cases[case].until is None else plan.cases[case].until for case in cases]
    variables["tau_align"] = ("case", true_times, _VARIABLES["tau_align"])
    variables["until"] = ("case", np.array(ends, float), _VARIABLES["until"])
    coordinates: dict[str, Any] = {
        "case": ("case", np.arange(len(cases), dtype=np.int8), _named("case", cases)),
        "method": ("method", np.arange(len(methods), dtype=np.int8), _named("method", methods)),
    }
    for name in PARAMETER_NAMES:
        values = [plan.cases[case].parameters[name] for case in cases]
        coordinates[name] = ("case", np.array(values, float), parameter_attributes(name))
    title = "Speed against error"
    summary = (
        "True error and right-hand-side evaluations of each method on one case of each kind of "
        "motion, by step or tolerance. Located methods: both runs, the one that estimates the "
        "error included."
    )
    attributes = global_attributes(
        NAME, NAME, plan.identity, title, summary, plan.settings.settings
    )
    attributes["true_tolerance"] = plan.ladder.true_tolerance
    return xr.Dataset(variables, coordinates, attributes)


def settings_in(dataset: xr.Dataset) -> list[Setting]:
    """Return the settings that ``precision_dataset`` stored, in order."""
    cases, methods = names_of(dataset["case"]), names_of(dataset["method"])
    resolution, error, evaluations, verdicts = (
        dataset[name].values for name in ("resolution", "error", "rhs_evaluations", "verdict")
    )
    return [
        Setting(
            cases[place[0]],
            methods[place[1]],
            float(resolution[place]),
            float(error[place]),
            int(evaluations[place]),
            Verdict(int(verdicts[place])),
        )
        for place in np.ndindex(verdicts.shape)
        if verdicts[place] != Verdict.NOT_TRIED
    ]


_VARIABLES: dict[str, dict[str, Any]] = {
    "resolution": {"long_name": "length of a step, or tolerance", "units": "1"},
    "error": {
        "long_name": "true error of the alignment time, or of the state where it never aligns",
        "units": "1",
    },
    "rhs_evaluations": {"long_name": "evaluations of the equations of motion", "units": "1"},
    "verdict": {"long_name": "what the method made of the case", "units": "1", **flags(Verdict)},
    "tau_align": {"long_name": "true alignment duration", "symbol": "τ", "units": "1"},
    "until": {"long_name": "time at which states are compared", "symbol": "τ", "units": "1"},
}


def _named(what: str, names: Sequence[str]) -> dict[str, Any]:
    return {
        "long_name": what,
        "units": "1",
        "flag_values": np.arange(len(names), dtype=np.int8),
        "flag_meanings": " ".join(names),
    }


def names_of(coordinate: xr.DataArray) -> list[str]:
    """Return the names along a coordinate of the dataset: cases or methods."""
    return str(coordinate.attrs["flag_meanings"]).split()


# --- Times --------------------------------------------------------------------------------------

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


def timings_table(settings: Sequence[TimedSetting]) -> str:
    """Return the timed settings as CSV."""
    return records_text(TimedSetting, settings, _FORMATS)


def read_timings(path: Path) -> list[TimedSetting]:
    """Return the settings of a table by ``timings_table``.

    Raises:
        TableError: the file is missing or no such table.
    """
    return read_records(path, "timings", TimedSetting)
