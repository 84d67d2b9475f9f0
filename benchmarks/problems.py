"""What is integrated: three trajectories W1 to W3, and points of the study's Figs. 6 and 13.

Every problem stays, up to its end, with the edge A1 on the bottom face and in flight, so that all
methods solve the same equations with the same switches. Friction is Coulomb's, with sticking.

- W1 aligns at τ = 1.40037 by the project's criterion (contact lost: A1 passes B1, B2 in the slot).
- W2 as W1 with ten times the tilt stiffness: some 320 switches of friction, no alignment.
- W3 bounces: 152 separations and some 630 switches, no alignment, in the end a response of four
  periods of the excitation.
- fig06, fig13: points drawn from the figures' own sweeps (``drawn_points``), all of which align.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from benchmarks.equations import equations
from model import Batch, Outcome, Parameters, Scene, Settings, align, simulate
from model.runs.align import run_once
from model.study.config import load_study, study_path
from model.study.sweeps import sweep_of

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


@dataclass(frozen=True)
class Problem:
    """One line of the benchmark.

    Attributes:
        name: as it stands in the table.
        cases: the parameter sets at which errors are measured.
        horizon: latest time.
        checkpoints: where the state is compared if no case aligns; empty if all do, and then the
            alignment time is compared.
    """

    name: str
    cases: tuple[Parameters, ...]
    horizon: float
    checkpoints: tuple[float, ...] = ()

    @cached_property
    def truth(self) -> NDArray[np.float64]:
        """What a perfect method answers, shape (cases, answers), by the project at 1e-13."""
        return answers(self, self.cases, TRUE_TOLERANCE)

    def batch(self, count: int) -> tuple[Parameters, ...]:
        """``count`` parameter sets or a few more: neighbours of every case, as many of each.

        They are to ask for the work of the cases, which align unless there are checkpoints. A case
        stands in for a neighbour that does not, or not between half and twice the case's time.
        """
        sets = neighbours(self.cases, -(-count // len(self.cases)))
        if self.checkpoints:
            return sets
        settings = Settings(horizon=self.horizon, alignment_only=True)
        tau = run_once(Batch.stack(sets), settings)["tau_align"]
        own = np.resize(tau[: len(self.cases)], tau.size)  # the first of every case's is itself
        alike = (0.5 * own <= tau) & (tau <= 2.0 * own)
        cases = self.cases * (len(sets) // len(self.cases))
        return tuple(
            each if same else case for each, same, case in zip(sets, alike, cases, strict=True)
        )


def answers(problem: Problem, cases: Sequence[Parameters], tolerance: float) -> NDArray[np.float64]:
    """The package's answers, shape (cases, answers): alignment times, or states in a row."""
    if not problem.checkpoints:
        runs = align(cases, tolerance=tolerance, horizon=problem.horizon, cores=1, engine="scalar")
        return runs.tau_align[:, np.newaxis]
    return np.array(
        [
            np.concatenate(
                [
                    simulate(case, tolerance=tolerance, horizon=time, may_settle=False).state[-1]
                    for time in problem.checkpoints
                ]
            )
            for case in cases
        ]
    )


def neighbours(cases: Sequence[Parameters], each: int) -> tuple[Parameters, ...]:
    """``each`` neighbours of every case, itself included, their press forces a little apart."""
    factors = 1.0 + _SPREAD * np.random.default_rng(_SEED).uniform(-1.0, 1.0, size=each)
    factors[:1] = 1.0
    return tuple(
        case.replace(press_force=case.press_force * factor) for factor in factors for case in cases
    )


def only_right_edge(case: Parameters, horizon: float) -> bool:
    """Whether A2 never meets the bottom face, and A1 passes B1 with B2 already in the slot.

    A2 cannot meet it while B2 stays right of A2; and B2 must not dip in after A1 has passed, which
    would be one more switch.
    """
    run = simulate(case, horizon=horizon)
    aligned = run.time <= run.tau_align
    states = run.state[aligned].T
    physics = equations(np.sin, np.cos)
    corner_x, _ = physics.left_corner(states, case)
    place = physics.touch(states[:, -1], case).along_face
    return bool(corner_x.min() >= -case.slot_half_width and abs(place - case.half_width) < 1e-8)


def drawn_points(figure: str, count: int) -> tuple[Parameters, ...]:
    """``count`` points of a figure's sweep, in the order of a fixed shuffle, that qualify.

    They align, without being flagged as sensitive; they do so alike if the scene declares nothing
    but an edge under the bottom face; and they pass ``only_right_edge``.
    """
    study = load_study(study_path())
    sweep = sweep_of(study, figure)
    order = np.random.default_rng(_SEED).permutation(int(np.prod(sweep.shape)))
    horizon, chosen = study.settings.horizon, []
    for first in range(0, len(order), 4 * count):
        batch = sweep.batch(order[first : first + 4 * count])
        full = align(batch, horizon=horizon, cores=1)
        edge = align(batch, horizon=horizon, cores=1, scene=_RIGHT_EDGE_ONLY)
        same = (full.outcome == Outcome.ALIGNED) & ~full.sensitive
        same &= full.tau_align == edge.tau_align
        for row in np.flatnonzero(same).tolist():
            if only_right_edge(batch[row], horizon):
                chosen.append(batch[row])
            if len(chosen) == count:
                return tuple(chosen)
    raise ValueError(f"{figure}: only {len(chosen)} of {count} points qualify")


def all_problems(points: int, neighbours_of_w: int) -> list[Problem]:
    """W1 to W3 with so many neighbours each, Figs. 6 and 13 with so many points each."""
    tens = tuple(float(time) for time in range(10, 101, 10))
    horizon = load_study(study_path()).settings.horizon
    return [
        Problem("W1", neighbours([W1], neighbours_of_w), 10.0),
        Problem("W2", neighbours([W2], max(1, neighbours_of_w // 4)), 100.0, tens),
        Problem("W3", neighbours([W3], max(1, neighbours_of_w // 4)), 100.0, tens),
        Problem("fig06", drawn_points("fig06", points), horizon),
        Problem("fig13", drawn_points("fig13", points), horizon),
    ]
