"""Methods: ways to integrate problems, one interface for the study's comparison and the benchmark.

To add one, write a subclass of ``Method`` and name it in ``METHODS`` (compared in the report) or in
``benchmarks.methods`` (peers of ``make bench``).
"""

import contextlib
import itertools
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.integrate import solve_ivp

from model import Batch, Parameters, Settings, align
from model.engines.scalar.tableaux import DOP853, DORMAND_PRINCE, Tableau
from model.runs.align import run_once
from model.runs.engines import Engine
from verification import without_location
from verification.problems import Floats, Problem, Solution, Verdict, simulated


def cpu_seconds() -> float:
    """CPU time of this process and of those it has waited for: the clock of deadlines."""
    return sum(os.times()[:4])


class NotReachedError(Exception):
    """A method has no answer: it ran out of time, failed or met the same event without end."""


class Method:
    """One way to solve the problems.

    Attributes:
        name: name in tables and legends.
        formulation: how the problem is put to it, in a few words.
        package: the distribution whose version is reported.
        fixed: whether its resolution is the length of a step; else it is a tolerance.
        located: whether it locates every event.
        batch: how many trajectories it is given at once; 1 if one after the other.
        vectorized: whether those of a batch run in vectors; else it spreads the cost of a call.
        ladder_step: half decades between the tolerances tried.
    """

    name: str
    formulation: str = ""
    package: str = "vibralign"
    fixed: bool = False
    located: bool = True
    batch: int = 1
    vectorized: bool = False
    ladder_step: int = 1
    _is_warm: bool = False

    @cached_property
    def errors(self) -> dict[tuple[str, int], float]:
        """Errors found, by problem and place on the ladder of tolerances."""
        return {}

    @cached_property
    def given_up(self) -> set[str]:
        """Problems on which a target was not reached in time."""
        return set()

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, deadline: float, /
    ) -> Solution:
        """Integrate every case as fast as the method can.

        Raises:
            NotReachedError: it cannot, or not before ``deadline`` (of ``cpu_seconds``).
        """
        raise NotImplementedError

    def answer(self, problem: Problem, resolution: float, deadline: float = math.inf) -> Solution:
        """Integrate the cases of the problem for their answers: by default as ``solve`` does."""
        return self.solve(problem, problem.cases, resolution, deadline)

    def warm(self, problem: Problem, resolution: float) -> None:  # noqa: ARG002 - for subclasses
        """Compile what solving ``problem`` needs; its time is not counted."""
        if not self._is_warm:
            self._is_warm = True
            with contextlib.suppress(NotReachedError):
                self.solve(problem, problem.cases[:1], 1e-3, math.inf)

    def error(self, problem: Problem, resolution: float, deadline: float = math.inf) -> float:
        """Return the error that nine of ten cases keep; infinite where there is no answer."""
        answers = problem.answers(self.answer(problem, resolution, deadline))
        return typical_error(answers, problem.truth)


def typical_error(answers: Floats, truth: Floats) -> float:
    """Return the 90th percentile, over the cases, of each case's largest error."""
    errors = np.abs(answers - truth).max(axis=1)
    errors[np.isnan(errors)] = np.inf
    return float(np.quantile(errors, 0.9, method="inverted_cdf"))


# ------------------------------------------------------------------------------------- the package


class Package(Method):
    """``align``: every event located, two runs of each set, or more, for the estimate of its error.

    With an ``engine`` its own alignment times are the answers; states, and all answers without an
    engine, are those of ``simulate``, since ``align`` returns no states.
    """

    formulation = "align, two runs each with error estimate"

    def __init__(
        self, name: str, tableau: Tableau = DOP853, engine: Engine | None = None, batch: int = 1024
    ) -> None:
        self.name, self.tableau, self.engine, self.batch = name, tableau, engine, batch
        self.vectorized = tableau is DOP853 and engine != "scalar"

    def settings(self, problem: Problem, resolution: float) -> Settings:
        """Return the problem's settings with this method and tolerance."""
        return replace(problem.settings, method=self.tableau, tolerance=resolution)

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        runs = align(cases, self.settings(problem, resolution), cores=1, engine=self.engine)
        return _of_times(problem, runs.tau_align, runs.rhs_evaluations)

    def answer(self, problem: Problem, resolution: float, deadline: float = math.inf) -> Solution:
        """As ``Method.answer``."""
        if problem.checkpoints or self.engine is None:
            return simulated(problem, self.settings(problem, resolution))
        return super().answer(problem, resolution, deadline)


class OneRun(Package):
    """The batch engine as peers run: one run of each set up to alignment, no error estimate."""

    formulation = "one run each up to alignment, no error estimate"

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        settings = self.settings(problem, resolution)
        settings = replace(settings, alignment_only=True, may_settle=False)
        runs = run_once(Batch.stack(cases), settings, cores=1)
        return _of_times(problem, runs["tau_align"], runs["rhs_evaluations"])


def _of_times(problem: Problem, tau: Floats, evaluations: np.ndarray) -> Solution:
    states = np.full((tau.size, len(problem.stops), 6), math.nan)
    return Solution(tau, states, int(evaluations.sum()))


# -------------------------------------------------------------------------- without event location


class WithoutLocation(Method):
    """Compiled runs without event location; equal steps, or steps to a tolerance."""

    located = False

    def __init__(self, name: str, scheme: without_location.Scheme) -> None:
        self.name, self.scheme = name, scheme
        self.fixed = scheme != "dormand_prince"
        self.batch = without_location.LANES if self.fixed else 1
        self.vectorized = self.fixed

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        settings = problem.settings
        runs = without_location.align(
            cases, self.scheme, resolution, readings=settings.readings, horizon=settings.horizon,
            max_evaluations=settings.max_evaluations,
        )  # fmt: skip
        failure = None if runs.finished.all() else Verdict.TOO_MANY_EVALUATIONS
        evaluations = int(runs.rhs_evaluations.sum())
        return Solution(runs.tau_align, runs.state[:, np.newaxis], evaluations, failure)


class _TooManyEvaluationsError(Exception):
    pass


class ScipyWithoutLocation(Method):
    """``solve_ivp`` on the right-hand side without modes; the fall into the slot is its event."""

    package = "scipy"
    located = False

    def __init__(self, solver: str) -> None:
        self.name, self.solver = f"scipy {solver}", solver

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``; the absolute tolerance is the relative one, as in the package."""
        found = [self._solve_one(problem, case, resolution) for case in cases]
        failures = [each.failure for each in found if each.failure is not None]
        return Solution(
            np.concatenate([each.tau_align for each in found]),
            np.concatenate([each.states for each in found]),
            sum(each.evaluations or 0 for each in found),
            failures[0] if failures else None,
        )

    def _solve_one(self, problem: Problem, parameters: Parameters, resolution: float) -> Solution:
        case = without_location.initial_value_problem(parameters, problem.settings.readings)
        counter = itertools.count(1)
        evaluations = 0

        def rates(moment: float, y: Floats) -> Floats:
            nonlocal evaluations
            evaluations = next(counter)
            if evaluations > problem.interpreted_evaluations:
                raise _TooManyEvaluationsError
            return case.rates(moment, y)

        def fall(moment: float, y: Floats) -> float:
            return case.fall(moment, y)

        def ended(tau: float, state: Floats, failure: Verdict | None) -> Solution:
            return Solution(np.array([tau]), state.reshape(1, 1, 6), evaluations, failure)

        fall.terminal, fall.direction = True, -1.0  # type: ignore[attr-defined]
        try:
            # A solver that steps across a contact may run away: its verdict shows it.
            with np.errstate(all="ignore"):
                run = solve_ivp(
                    rates, (0.0, problem.settings.horizon), case.start, method=self.solver,
                    rtol=resolution, atol=resolution, events=fall,
                )  # fmt: skip
        except _TooManyEvaluationsError:
            return ended(math.nan, case.start, Verdict.TOO_MANY_EVALUATIONS)
        falls = run.t_events[0]
        tau_align = float(falls[0]) if falls.size else math.nan
        return ended(tau_align, run.y[:, -1], Verdict.FAILED if run.status < 0 else None)


# ----------------------------------------------------------------- the comparison of the study

_TOGETHER = 16  # least batch in which the package shows its speed on one case and its neighbours

METHODS: Mapping[str, Method] = {
    "dop853_located": Package("DOP853, events located (default)", DOP853, batch=_TOGETHER),
    "dormand_prince_located": Package(
        "Dormand–Prince 5(4), events located", DORMAND_PRINCE, batch=_TOGETHER
    ),
    "dormand_prince_unlocated": WithoutLocation(
        "Dormand–Prince 5(4), without event location", "dormand_prince"
    ),
    "rk4_fixed": WithoutLocation("RK4, fixed steps", "rk4"),
    "semi_implicit_euler_fixed": WithoutLocation(
        "semi-implicit Euler, fixed steps", "semi_implicit_euler"
    ),
    "scipy_rk45": ScipyWithoutLocation("RK45"),
    "scipy_dop853": ScipyWithoutLocation("DOP853"),
    "scipy_lsoda": ScipyWithoutLocation("LSODA"),
    "scipy_radau": ScipyWithoutLocation("Radau"),
}
