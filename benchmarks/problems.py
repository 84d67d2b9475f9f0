"""Problems that methods integrate: points of the study, and three trajectories of the benchmark.

The problems of the benchmark stay, up to their ends, with the edge A1 on the bottom face and in
flight, so that all peers solve the same equations with the same events. Friction is Coulomb's, with
sticking.

- W1 aligns at τ = 1.40037 by the project's criterion (contact lost: A1 passes B1, B2 in the slot).
- W2 as W1 with ten times the tilt stiffness: some 320 events of friction, no alignment.
- W3 lifts off 152 times, with some 630 events and no alignment, and ends in a response of four
  periods of the excitation.
- fig06, fig13: points drawn from the figures' own sweeps (``drawn_points``), all of which align.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from model import Batch, Outcome, Parameters, Reason, Scene, Settings, align, simulate
from model.engines.results import RunResult
from model.engines.scalar.loop import TRACK_COLUMNS
from model.physics.notation import STATE_SIZE
from model.runs.align import run_once
from model.runs.engines import scalar_engine
from model.runs.errors import estimate
from model.study.config import load_study, study_path
from model.study.sweeps import sweep_of
from verification.independent.motion import LEFT, RIGHT, Device, body

Floats = NDArray[np.float64]

W1 = Parameters(
    half_width=1.0,
    half_height=1.0,
    inertia=1.0,
    lateral_stiffness=1.0,
    tilt_stiffness=10.0,
    lateral_damping=0.1,
    axial_damping=0.1,
    tilt_damping=0.1,
    friction=0.1,
    press_force=2.0,
    frequency=10.0,
    misalignment=0.2,
    rest_y=0.0,
)
W2 = W1.replace(tilt_stiffness=100.0)
# Excitation amplitude 2 where the others have 1: lengths and forces are halved by our scaling. The
# tilt spring is stiffer and relaxed at a tilt, and the press force higher, so that the part never
# lands on its corner B1 (with k_φ = 12.5, φ_st = 0 and f0 = 0.1 it would, at τ = 0.73).
W3 = W1.replace(
    half_width=0.5,
    half_height=0.5,
    inertia=0.25,
    tilt_stiffness=40.0,
    tilt_damping=0.025,
    rest_tilt=0.03,
    press_force=0.15,
    misalignment=0.1,
)

TRUE_TOLERANCE = 1e-13
_SEED = 20070401
_SPREAD = 1e-3  # relative spread of the press force among neighbours
_RIGHT_EDGE_ONLY = Scene("right_edge", frozenset({"edge_on_face"}))


class Verdict(IntEnum):
    """Result of a method on a problem; the values are the flags stored in the dataset."""

    RIGHT_OUTCOME = 0
    WRONG_OUTCOME = 1
    FAILED = 2
    TOO_MANY_EVALUATIONS = 3
    NOT_TRIED = 4


@dataclass(frozen=True)
class Solution:
    """Result of a method on n parameter sets.

    Attributes:
        tau_align: alignment times, shape (n,); NaN where a set does not align.
        states: shape (n, stops, 6), at ``Problem.stops``; NaN where not known.
        evaluations: right-hand sides of all sets together; None where a method cannot tell.
        failure: why a run ended before it aligned or reached the horizon, where one did.
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
        interpreted_evaluations: limit of evaluations for methods whose steps run in the
            interpreter, which cost some fifty times a compiled one.
    """

    name: str
    cases: tuple[Parameters, ...]
    settings: Settings
    checkpoints: tuple[float, ...] = ()
    interpreted_evaluations: float = math.inf

    @property
    def stops(self) -> tuple[float, ...]:
        """Times whose states a solution holds: the checkpoints, or else the horizon."""
        return self.checkpoints or (self.settings.horizon,)

    @cached_property
    def truth(self) -> Floats:
        """True answers, shape (cases, answers): those of the reference engine at 1e-13."""
        settings = replace(self.settings, tolerance=TRUE_TOLERANCE)
        if self.checkpoints:
            return self.answers(simulated(self, settings))
        runs = align(self.cases, settings, cores=1, engine="scalar")
        return runs.tau_align[:, np.newaxis]

    @cached_property
    def events(self) -> float:
        """Events that are located in a trajectory, in the mean of the cases."""
        return float(run_once(Batch.stack(self.cases), self.settings)["events"].mean())

    def answers(self, solution: Solution) -> Floats:
        """Return what is compared, shape (cases, answers): alignment times, or states in a row."""
        if self.checkpoints:
            return solution.states.reshape(len(solution.states), -1)
        return solution.tau_align[:, np.newaxis]

    def solution(self, answers: Floats, evaluations: int | None) -> Solution:
        """Return a solution that consists of ``answers`` only; NaN for what they do not tell."""
        tau = np.full(len(answers), np.nan)
        states = np.full((len(answers), len(self.stops), 6), np.nan)
        if self.checkpoints:
            states[:] = answers.reshape(states.shape)
        else:
            tau[:] = answers[:, 0]
        return Solution(tau, states, evaluations)

    def batch(self, count: int) -> tuple[Parameters, ...]:
        """``count`` parameter sets or a few more: neighbours of every case, as many of each.

        They are to ask for the work of the cases, which align unless there are checkpoints. A case
        stands in for a neighbour that does not, or not between half and twice the case's time.
        """
        sets = neighbours(self.cases, -(-count // len(self.cases)))
        if self.checkpoints:
            return sets
        settings = Settings(horizon=self.settings.horizon, alignment_only=True)
        tau = run_once(Batch.stack(sets), settings)["tau_align"]
        own = np.resize(tau[: len(self.cases)], tau.size)  # the first of every case's is itself
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
    """Return the solution of the cases by the reference engine, its error estimates counted."""
    tau, states, evaluations, failure = [], [], 0, None
    for case in problem.cases:
        rows, ends = settings.rows(Batch.stack([case])), []
        for stop in problem.stops:
            until = replace(settings, horizon=stop)
            found = estimate(scalar_engine(until), rows, until.tolerance)
            ends.append(last_state(until, rows, found.tolerance)[1])
        columns = {name: column[0] for name, column in found.columns().items()}
        tau.append(float(columns["tau_align"]))
        states.append(ends)
        evaluations += int(columns["rhs_evaluations"])
        outcome, reason = Outcome(int(columns["outcome"])), Reason(int(columns["reason"]))
        failure = failure or failure_of(outcome, reason)
    return Solution(np.array(tau), np.array(states), evaluations, failure)


def last_state(settings: Settings, rows: Floats, tolerance: Floats) -> tuple[RunResult, Floats]:
    """Return the result of one run of the reference engine, and the state at its end, shape (6,).

    ``simulate`` would return the whole trajectory: half a gigabyte for 100,000 periods.
    """
    track = np.empty((1, TRACK_COLUMNS))
    result = RunResult(*scalar_engine(settings, track)(rows, tolerance)[0].tolist())
    return result, track[0, 1 : 1 + STATE_SIZE].copy()


def neighbours(cases: Sequence[Parameters], each: int) -> tuple[Parameters, ...]:
    """Return ``each`` neighbours of every case, itself first, their press forces a little apart."""
    factors = 1.0 + _SPREAD * np.random.default_rng(_SEED).uniform(-1.0, 1.0, size=each)
    factors[:1] = 1.0
    return tuple(
        case.replace(press_force=case.press_force * factor) for factor in factors for case in cases
    )


def only_right_edge(case: Parameters, horizon: float) -> bool:
    """Return whether A2 never meets the bottom face, and A1 passes B1 with B2 already in the slot.

    A2 cannot meet it while B2 stays right of A2; and B2 must not dip in after A1 has passed, which
    would be one more event.
    """
    run = simulate(case, horizon=horizon)
    states = run.state[run.time <= run.tau_align].T
    device, at = Device(case), body(states)
    to_the_end = device.depths(RIGHT, at)[2][-1]
    in_slot = device.corner(LEFT, at).real.min() >= -case.slot_half_width
    return bool(in_slot and abs(to_the_end) < 1e-8)


def drawn_points(figure: str, count: int) -> tuple[Parameters, ...]:
    """Return ``count`` points of a figure's sweep, in the order of a fixed shuffle, that qualify.

    They align, without being flagged as sensitive; they do so alike if the scene declares nothing
    but an edge under the bottom face; and they pass ``only_right_edge``.

    Raises:
        ValueError: fewer points qualify.
    """
    study = load_study(study_path())
    sweep = sweep_of(study, figure)
    order = np.random.default_rng(_SEED).permutation(int(np.prod(sweep.shape)))
    horizon, chosen = study.settings.horizon, []
    for first in range(0, len(order), 4 * count):
        batch = sweep.batch(order[first : first + 4 * count])
        for case, *_ in with_right_edge_only(batch, Settings(horizon=horizon)):
            chosen.append(case)
            if len(chosen) == count:
                return tuple(chosen)
    raise ValueError(f"{figure}: only {len(chosen)} of {count} points qualify")


def with_right_edge_only(
    batch: Batch, settings: Settings
) -> Iterator[tuple[Parameters, float, float]]:
    """Yield (set, alignment time, its error) of sets that align without a flag by A1 alone."""
    full = align(batch, settings, cores=1)
    edge = align(batch, settings, cores=1, scene=_RIGHT_EDGE_ONLY)
    same = (full.outcome == Outcome.ALIGNED) & ~full.sensitive
    same &= full.tau_align == edge.tau_align
    for row in np.flatnonzero(same).tolist():
        if only_right_edge(batch[row], settings.horizon):
            yield batch[row], float(full.tau_align[row]), float(full.tau_error[row])


def all_problems(points: int, neighbours_of_w: int) -> list[Problem]:
    """W1 to W3 with so many neighbours each, Figs. 6 and 13 with so many points each."""
    tens = tuple(float(time) for time in range(10, 101, 10))
    few = max(1, neighbours_of_w // 4)
    ends, goes_on = Settings(horizon=10.0), Settings(horizon=100.0, may_settle=False)
    whole = Settings(horizon=load_study(study_path()).settings.horizon)
    return [
        Problem("W1", neighbours([W1], neighbours_of_w), ends),
        Problem("W2", neighbours([W2], few), goes_on, tens),
        Problem("W3", neighbours([W3], few), goes_on, tens),
        Problem("fig06", drawn_points("fig06", points), whole),
        Problem("fig13", drawn_points("fig13", points), whole),
    ]
