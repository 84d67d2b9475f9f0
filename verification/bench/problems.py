"""Problems, parameter sets that methods are to run, and their solutions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from model.engine.record import STATE
from model.engine.results import RunResult
from model.events.outcomes import Outcome, Reason
from model.physics.notation import STATE_SIZE
from model.physics.parameters import Batch, Parameters
from model.runs.align import align, run_once
from model.runs.engine import engine_for, run_alone
from model.runs.errors import estimate
from model.runs.settings import Settings

Floats = NDArray[np.float64]

TRUE_TOLERANCE = 1e-13
SEED = 20070401  # seed of all random draws
_SPREAD = 1e-3  # relative spread of the press force among neighbours


class Verdict(IntEnum):
    """Verdict on a solution."""

    RIGHT_OUTCOME = 0
    WRONG_OUTCOME = 1
    FAILED = 2
    TOO_MANY_EVALUATIONS = 3


@dataclass(frozen=True)
class Solution:
    """Result of a method on n parameter sets.

    Attributes:
        tau_align: alignment times, shape (n,); NaN where a set does not align.
        states: states at ``Problem.stops``, shape (n, stops, 6); NaN where unknown.
        evaluations: evaluations of all sets together; None if the method does not count them.
        failure: verdict on a run that neither aligned nor reached the horizon; None without one.
    """

    tau_align: Floats
    states: Floats
    evaluations: int | None
    failure: Verdict | None = None


@dataclass(frozen=True)
class Problem:
    """Parameter sets to run, and the numbers that methods are compared by.

    Attributes:
        name: name in the table.
        cases: the parameter sets at which errors are measured.
        settings: horizon, equations and limit of evaluations; a method sets its own tolerance.
        checkpoints: times at which states are compared if no case aligns; empty if all do, and then
            the alignment time is compared.
    """

    name: str
    cases: tuple[Parameters, ...]
    settings: Settings
    checkpoints: tuple[float, ...] = ()

    @property
    def stops(self) -> tuple[float, ...]:
        """Times of the states in a solution: the checkpoints, or else the horizon."""
        return self.checkpoints or (self.settings.horizon,)

    @cached_property
    def truth(self) -> Floats:
        """True answers, shape (cases, answers): those of the package at 1e-13."""
        settings = replace(self.settings, tolerance=TRUE_TOLERANCE)
        if self.checkpoints:
            return self.answers(simulated(self, settings))
        runs = align(self.cases, settings, cores=1)
        return runs.tau_align[:, np.newaxis]

    @cached_property
    def events(self) -> float:
        """Events located in a trajectory, mean of the cases."""
        return float(run_once(Batch.stack(self.cases), self.settings)["events"].mean())

    def answers(self, solution: Solution) -> Floats:
        """Return the compared numbers, shape (cases, answers): alignment times, or all states."""
        if self.checkpoints:
            return solution.states.reshape(len(solution.states), -1)
        return solution.tau_align[:, np.newaxis]

    def solution(self, answers: Floats, evaluations: int | None) -> Solution:
        """Return the solution with these ``answers``; its other numbers are NaN."""
        tau = np.full(len(answers), np.nan)
        states = np.full((len(answers), len(self.stops), 6), np.nan)
        if self.checkpoints:
            states[:] = answers.reshape(states.shape)
        else:
            tau[:] = answers[:, 0]
        return Solution(tau, states, evaluations)

    def batch(self, count: int) -> tuple[Parameters, ...]:
        """Return ``count`` parameter sets or a few more: as many neighbours of each case.

        A set must take about as much work as its case. Without checkpoints, a neighbour that does
        not align between half and twice the case's time is therefore replaced by the case.
        """
        sets = neighbours(self.cases, -(-count // len(self.cases)))
        if self.checkpoints:
            return sets
        settings = Settings(horizon=self.settings.horizon, alignment_only=True)
        tau = run_once(Batch.stack(sets), settings)["tau_align"]
        own = np.resize(tau[: len(self.cases)], tau.size)  # the cases are their first neighbours
        alike = (0.5 * own <= tau) & (tau <= 2.0 * own)
        cases = self.cases * (len(sets) // len(self.cases))
        return tuple(
            each if same else case for each, same, case in zip(sets, alike, cases, strict=True)
        )


def failure_of(outcome: Outcome, reason: Reason) -> Verdict | None:
    """Return the verdict on a run of the package that could not be finished, else None."""
    if outcome != Outcome.FAILED:
        return None
    spent = reason == Reason.TOO_MANY_EVALUATIONS
    return Verdict.TOO_MANY_EVALUATIONS if spent else Verdict.FAILED


def simulated(problem: Problem, settings: Settings) -> Solution:
    """Return the package's solution; evaluations include those for error estimates."""
    tau, states, evaluations, failure = [], [], 0, None
    for case in problem.cases:
        rows, ends = settings.rows(Batch.stack([case])), []
        for stop in problem.stops:
            until = replace(settings, horizon=stop)
            run, carrying = engine_for(until), engine_for(until, carries_error=True)
            found = estimate(run, carrying, rows, until.tolerance)
            ends.append(last_state(until, rows[0], float(found.tolerance[0]))[1])
        columns = {name: column[0] for name, column in found.columns().items()}
        tau.append(float(columns["tau_align"]))
        states.append(ends)
        evaluations += int(columns["rhs_evaluations"])
        outcome, reason = Outcome(int(columns["outcome"])), Reason(int(columns["reason"]))
        failure = failure or failure_of(outcome, reason)
    return Solution(np.array(tau), np.array(states), evaluations, failure)


def ran_once(problem: Problem, settings: Settings) -> Solution:
    """Return the solution of single runs at the tolerance itself, without estimates."""
    tau, states, evaluations = [], [], 0
    for case in problem.cases:
        row = settings.rows(Batch.stack([case]))[0]
        ends = [
            last_state(replace(settings, horizon=stop), row, settings.tolerance)
            for stop in problem.stops
        ]
        tau.append(ends[-1][0].tau_align)
        states.append([state for _, state in ends])
        evaluations += int(ends[-1][0].rhs_evaluations)
    return Solution(np.array(tau), np.array(states), evaluations)


def last_state(
    settings: Settings, row: Floats, tolerance: float, *, carries_error: bool = False
) -> tuple[RunResult, Floats]:
    """Return the result of one run, and the state at its end, shape (6,).

    ``simulate`` would return the whole trajectory: half a gigabyte for 100,000 periods.
    """
    result, memory = run_alone(row, tolerance, settings, carries_error=carries_error)
    return result, memory.runs[0, STATE : STATE + STATE_SIZE].copy()


def neighbours(cases: Sequence[Parameters], each: int) -> tuple[Parameters, ...]:
    """Return ``each`` neighbours of every case, with slightly different press forces.

    The cases themselves come first.
    """
    factors = 1.0 + _SPREAD * np.random.default_rng(SEED).uniform(-1.0, 1.0, size=each)
    factors[:1] = 1.0
    return tuple(
        case.replace(press_force=case.press_force * factor) for factor in factors for case in cases
    )
