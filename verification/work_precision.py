"""Speed against error: every method on one case of each kind of motion, at rungs ever finer.

The true solution is the default method's at a tolerance far below the others. Evaluations and
errors are data, the same in every build; CPU times are not, and are kept apart from them.
"""

import itertools
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from model.engines.scalar.tableaux import DOP853, DORMAND_PRINCE, Tableau
from model.events.outcomes import OUTCOME_TEXT, Outcome, Reason
from model.physics.parameters import PARAMETER_NAMES, Batch, Parameters
from model.runs.align import align
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate
from model.study.csv_tables import csv_text, read_rows
from model.study.datasets import flags, global_attributes, parameter_attributes
from verification import without_location
from verification.plans import PrecisionPlan

Floats = NDArray[np.float64]
NAME = "precision"


class CaseError(ValueError):
    """A case that does not do what its configuration says."""


class Verdict(IntEnum):
    """What a method made of a case at a rung; the values are the flags stored in the dataset."""

    RIGHT_OUTCOME = 0
    WRONG_OUTCOME = 1
    FAILED = 2
    TOO_MANY_EVALUATIONS = 3
    NOT_TRIED = 4


@dataclass(frozen=True)
class Problem:
    """One case as methods get it: ``settings`` hold its horizon and the limit of evaluations."""

    parameters: Parameters
    settings: Settings
    max_evaluations_scipy: int

    def neighbours(self, count: int) -> Batch:
        """``count`` parameter sets within 1 % of the press force, since no two points are alike."""
        spread = 1.0 + 0.01 * np.linspace(-1.0, 1.0, count) if count > 1 else np.ones(1)
        return Batch.of(self.parameters, press_force=self.parameters.press_force * spread)


@dataclass(frozen=True)
class Passed:
    """One run: alignment time (NaN if not aligned), state at its end, its cost.

    ``failure`` says why it ended before it aligned or reached the horizon, where it did.
    """

    tau_align: float
    state: Floats
    rhs_evaluations: int
    failure: Verdict | None = None


def failure_of(outcome: Outcome, reason: Reason) -> Verdict | None:
    """The verdict on a run that could not be finished; None for one that was."""
    if outcome != Outcome.FAILED:
        return None
    spent = reason == Reason.TOO_MANY_EVALUATIONS
    return Verdict.TOO_MANY_EVALUATIONS if spent else Verdict.FAILED


# --- The methods --------------------------------------------------------------------------------
# Each runs a case at a resolution (``fixed``: the length of a step, else a tolerance), once for
# its error, and for its time ``count`` neighbours of the case, as fast as it does them on one core;
# ``together`` is the least count for which a batch shows what it can.


@dataclass(frozen=True)
class Located:
    """The project's own runs: every switch located. The run that estimates their error counts."""

    label: str
    tableau: Tableau
    fixed: bool = False
    located: bool = True
    together: int = 16

    def _settings(self, problem: Problem, resolution: float) -> Settings:
        return replace(problem.settings, method=self.tableau, tolerance=resolution)

    def run(self, problem: Problem, resolution: float) -> Passed:
        """One run through ``simulate``."""
        run = simulate(problem.parameters, self._settings(problem, resolution))
        failure = failure_of(run.outcome, run.reason)
        return Passed(run.tau_align, run.state[-1], run.rhs_evaluations, failure)

    def run_many(self, problem: Problem, resolution: float, count: int) -> None:
        """A batch through ``align``."""
        align(problem.neighbours(count), self._settings(problem, resolution), cores=1)


@dataclass(frozen=True)
class Unlocated:
    """Compiled runs without located switches."""

    label: str
    scheme: without_location.Scheme
    fixed: bool
    located: bool = False
    together: int = 1

    def _options(self, problem: Problem) -> dict[str, Any]:
        settings = problem.settings
        return {
            "readings": settings.readings,
            "horizon": settings.horizon,
            "max_evaluations": settings.max_evaluations,
        }

    def run(self, problem: Problem, resolution: float) -> Passed:
        """One run."""
        batch = problem.neighbours(1)
        runs = without_location.align(batch, self.scheme, resolution, **self._options(problem))
        return Passed(
            float(runs.tau_align[0]),
            runs.state[0],
            int(runs.rhs_evaluations[0]),
            None if runs.finished[0] else Verdict.TOO_MANY_EVALUATIONS,
        )

    def run_many(self, problem: Problem, resolution: float, count: int) -> None:
        """A batch."""
        batch = problem.neighbours(count)
        without_location.align(batch, self.scheme, resolution, **self._options(problem))


class _TooManyEvaluationsError(Exception):
    pass


@dataclass(frozen=True)
class Scipy:
    """``scipy.integrate.solve_ivp``: compiled unlocated right-hand side, the fall its event."""

    label: str
    solver: str
    fixed: bool = False
    located: bool = False
    together: int = 1

    def run(self, problem: Problem, resolution: float) -> Passed:
        """One run; the absolute tolerance is the relative one, as in the project's own methods."""
        return self._solve(problem.parameters, problem, resolution)

    def run_many(self, problem: Problem, resolution: float, count: int) -> None:
        """One after the other: there is no batch."""
        batch = problem.neighbours(count)
        for row in range(count):
            self._solve(batch[row], problem, resolution)

    def _solve(self, parameters: Parameters, problem: Problem, resolution: float) -> Passed:
        case = without_location.initial_value_problem(parameters, problem.settings.readings)
        counter = itertools.count(1)
        evaluations = 0

        def rates(moment: float, y: Floats) -> Floats:
            nonlocal evaluations
            evaluations = next(counter)
            if evaluations > problem.max_evaluations_scipy:
                raise _TooManyEvaluationsError
            return case.rates(moment, y)

        def fall(moment: float, y: Floats) -> float:
            return case.fall(moment, y)

        fall.terminal, fall.direction = True, -1.0  # type: ignore[attr-defined]
        span = (0.0, problem.settings.horizon)
        try:
            # A solver that steps across a contact may run away: its verdict shows it.
            with np.errstate(all="ignore"):
                found = solve_ivp(
                    rates, span, case.start, method=self.solver, rtol=resolution, atol=resolution,
                    events=fall,
                )  # fmt: skip
        except _TooManyEvaluationsError:
            return Passed(math.nan, case.start, evaluations, Verdict.TOO_MANY_EVALUATIONS)
        falls = found.t_events[0]
        tau_align = float(falls[0]) if falls.size else math.nan
        failure = Verdict.FAILED if found.status < 0 else None
        return Passed(tau_align, found.y[:, -1], evaluations, failure)


Method = Located | Unlocated | Scipy

METHODS: Mapping[str, Method] = {
    "dop853_located": Located("DOP853, switches located (default)", DOP853),
    "dormand_prince_located": Located("Dormand–Prince 5(4), switches located", DORMAND_PRINCE),
    "dormand_prince_unlocated": Unlocated(
        "Dormand–Prince 5(4), unlocated", "dormand_prince", fixed=False
    ),
    "rk4_fixed": Unlocated("RK4, fixed steps", "rk4", fixed=True),
    "semi_implicit_euler_fixed": Unlocated(
        "semi-implicit Euler, fixed steps", "semi_implicit_euler", fixed=True
    ),
    "scipy_rk45": Scipy("scipy RK45", "RK45"),
    "scipy_dop853": Scipy("scipy DOP853", "DOP853"),
    "scipy_lsoda": Scipy("scipy LSODA", "LSODA"),
    "scipy_radau": Scipy("scipy Radau", "Radau"),
}


# --- The comparison -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Rung:
    """One method on one case at one resolution."""

    case: str
    method: str
    resolution: float
    error: float
    rhs_evaluations: int
    verdict: Verdict


@dataclass(frozen=True)
class TimedRung(Rung):
    """A rung with the CPU time of one trajectory, NaN where it came to no right outcome."""

    microseconds: float


def problem_of(plan: PrecisionPlan, name: str) -> Problem:
    """The case ``name`` of the plan."""
    case = plan.cases[name]
    settings = replace(
        plan.settings.settings,
        horizon=case.until or plan.settings.horizon,
        max_evaluations=plan.ladder.max_evaluations,
        may_settle=False,
    )
    return Problem(
        Parameters(**case.parameters),  # type: ignore[arg-type]
        settings,
        plan.ladder.max_evaluations_scipy,
    )


def true_run(plan: PrecisionPlan, name: str) -> Trajectory:
    """The case ``name`` at the true tolerance.

    Raises:
        CaseError: it aligns and should not, or the other way round, or its digits are uncertain.
    """
    problem, case = problem_of(plan, name), plan.cases[name]
    truth = simulate(
        problem.parameters,
        problem.settings,
        method=DOP853,
        tolerance=plan.ladder.true_tolerance,
        max_evaluations=plan.settings.settings.max_evaluations,  # the limit is for the others
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


def error_of(passed: Passed, truth: Trajectory) -> tuple[float, Verdict]:
    """(error, verdict): of the alignment time where the truth aligns, else of the state.

    An error is never below the rounding of what it is an error of.
    """
    if passed.failure is not None:
        return math.nan, passed.failure
    aligns = truth.outcome == Outcome.ALIGNED
    if math.isnan(passed.tau_align) == aligns:
        return math.nan, Verdict.WRONG_OUTCOME
    if aligns:
        error, size = abs(passed.tau_align - truth.tau_align), truth.tau_align
    else:
        error = float(np.abs(passed.state - truth.state[-1]).max())
        size = float(np.abs(truth.state[-1]).max())
    return max(error, float(np.spacing(size))), Verdict.RIGHT_OUTCOME


def climb(plan: PrecisionPlan, case: str, method: str, truth: Trajectory) -> Iterator[TimedRung]:
    """The rungs of one method on one case, coarse to fine, up to the first that costs too much."""
    problem, how = problem_of(plan, case), METHODS[method]
    warm = False  # the first run may load or compile what the others find ready
    for resolution in plan.ladder.steps if how.fixed else plan.ladder.tolerances:
        started = time.thread_time()
        passed = how.run(problem, resolution)
        seconds = time.thread_time() - started
        error, verdict = error_of(passed, truth)
        microseconds = math.nan
        if verdict == Verdict.RIGHT_OUTCOME:
            work = partial(how.run_many, problem, resolution)
            known = seconds if warm and how.together == 1 else None
            microseconds = cpu_microseconds(work, how.together, known)
        warm = True
        yield TimedRung(
            case, method, resolution, error, passed.rhs_evaluations, verdict, microseconds
        )
        if verdict == Verdict.TOO_MANY_EVALUATIONS:
            return


def precision_dataset(
    plan: PrecisionPlan, truths: Mapping[str, Trajectory], rungs: Sequence[Rung]
) -> xr.Dataset:
    """The rungs over case, method and rung, with the truth and the parameters of each case."""
    cases, methods = list(plan.cases), list(METHODS)
    shape = len(cases), len(methods), max(len(plan.ladder.steps), len(plan.ladder.tolerances))
    columns = {
        "resolution": np.full(shape, np.nan),
        "error": np.full(shape, np.nan),
        "rhs_evaluations": np.zeros(shape, np.int64),
        "verdict": np.full(shape, Verdict.NOT_TRIED, np.int8),
    }
    filled = np.zeros(shape[:2], int)
    for rung in rungs:
        row = cases.index(rung.case), methods.index(rung.method)
        for name, column in columns.items():
            column[(*row, filled[row])] = getattr(rung, name)
        filled[row] += 1
    variables: dict[str, Any] = {
        name: (("case", "method", "rung"), column, _VARIABLES[name])
        for name, column in columns.items()
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
    settings = plan.settings.settings
    attributes = global_attributes(NAME, NAME, plan.identity, title, summary, settings)
    attributes["true_tolerance"] = plan.ladder.true_tolerance
    return xr.Dataset(variables, coordinates, attributes)


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
    """The names that a coordinate of the dataset stands for: cases, or methods."""
    return str(coordinate.attrs["flag_meanings"]).split()


# --- Times --------------------------------------------------------------------------------------

_REPEATS = 5
_PATIENCE = 0.02  # seconds; a run that takes longer is timed once
_LONG_ENOUGH = 0.005  # seconds that a timed batch should take
_LARGEST_BATCH = 16


def cpu_microseconds(
    work: Callable[[int], object], together: int = 1, known: float | None = None
) -> float:
    """CPU time of one of the ``count`` runs that ``work(count)`` does: the median of batches.

    Args:
        work: has run before, so that nothing compiles any more.
        together: least number of runs in a batch.
        known: seconds that ``together`` runs took, where that is known. Runs that take long are
            not repeated.
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


_COLUMNS = tuple(field.name for field in fields(TimedRung))


def timings_table(rungs: Sequence[TimedRung]) -> str:
    """The timed rungs as CSV, a header and one line for each."""
    return csv_text(_COLUMNS, (_row(rung) for rung in rungs))


def _row(rung: TimedRung) -> dict[str, Any]:
    return vars(rung) | {
        "resolution": f"{rung.resolution:g}",
        "error": f"{rung.error:.3e}",
        "verdict": rung.verdict.name.lower(),
        "microseconds": f"{rung.microseconds:.1f}",
    }


def read_timings(path: Path) -> list[TimedRung]:
    """What ``timings_table`` wrote to ``path``.

    Raises:
        TableError: a file that is missing or not such a table.
    """
    return read_rows(path, "timings", _rung)


def _rung(row: dict[str, str]) -> TimedRung:
    return TimedRung(
        case=row["case"],
        method=row["method"],
        resolution=float(row["resolution"]),
        error=float(row["error"]),
        rhs_evaluations=int(row["rhs_evaluations"]),
        verdict=Verdict[row["verdict"].upper()],
        microseconds=float(row["microseconds"]),
    )
