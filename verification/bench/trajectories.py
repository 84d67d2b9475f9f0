"""The problems of ``make bench``: three trajectories, and points of two figures.

The problems stay, up to their ends, with the edge A1 on the bottom face and in flight, so that all
peers solve the same equations with the same events. Friction is Coulomb's, with sticking.

- W1 aligns at τ = 1.40037 by the project's criterion (contact lost: A1 passes B1, B2 in the slot).
- W2 as W1 with ten times the tilt stiffness: some 320 events of friction, no alignment.
- W3 lifts off 152 times, with some 630 events and no alignment, and ends in a response of four
  periods of the excitation.
- fig06, fig13: points drawn from the figures' own sweeps (``drawn_points``), all of which align.
"""

import numpy as np

from study.config import load_study, study_path
from study.plans import sweep_of
from verification.bench.problems import SEED, Problem, neighbours
from verification.independent.motion import LEFT, RIGHT, Device, body
from vibralign import Outcome, Parameters, Scene, Settings, align, simulate

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

_RIGHT_EDGE_ONLY = Scene("right_edge", frozenset({"edge_on_face"}))


def only_right_edge(case: Parameters, horizon: float) -> bool:
    """Return whether A2 never meets the bottom face, and B2 is in the slot when A1 passes B1.

    A2 cannot meet the face while B2 stays right of A2. If B2 fell in after A1 had passed, that
    would be another event, which the peers do not have.
    """
    run = simulate(case, horizon=horizon)
    states = run.state[run.time <= run.tau_align].T
    device, at = Device(case), body(states)
    to_the_end = device.depths(RIGHT, at)[2][-1]
    in_slot = device.corner(LEFT, at).real.min() >= -case.slot_half_width
    return bool(in_slot and abs(to_the_end) < 1e-8)


def drawn_points(figure: str, count: int) -> tuple[Parameters, ...]:
    """Return the first ``count`` points of a figure, in a fixed random order, that peers can run.

    They align and are not sensitive, align at the same time in a scene whose only contact is an
    edge under the bottom face, and pass ``only_right_edge``.

    Raises:
        ValueError: there are fewer such points.
    """
    study = load_study(study_path())
    sweep = sweep_of(study, figure)
    order = np.random.default_rng(SEED).permutation(int(np.prod(sweep.shape)))
    horizon = study.settings.horizon
    chosen: list[Parameters] = []
    for first in range(0, len(order), 4 * count):
        batch = sweep.batch(order[first : first + 4 * count])
        full = align(batch, horizon=horizon, cores=1)
        edge = align(batch, horizon=horizon, cores=1, scene=_RIGHT_EDGE_ONLY)
        same = (full.outcome == Outcome.ALIGNED) & ~full.sensitive
        same &= full.tau_align == edge.tau_align
        found = (batch[row] for row in np.flatnonzero(same).tolist())
        chosen += [case for case in found if only_right_edge(case, horizon)]
        if len(chosen) >= count:
            return tuple(chosen[:count])
    raise ValueError(f"{figure}: only {len(chosen)} of {count} points qualify")


def all_problems(points: int, neighbours_of_w: int) -> list[Problem]:
    """Return W1 to W3 with neighbours, and Figs. 6 and 13 with ``points`` points each."""
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
