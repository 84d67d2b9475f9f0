"""Fixed steps as written by hand: RK4 and semi-implicit Euler, without event location.

One right-hand side is used for all states: a contact of positive depth presses with
n = max(0, load), and its friction is -μ n sign(slip). It has kinks where a contact begins or ends,
and jumps where a slip reverses; steps go across them. A part cannot stick: at rest the friction
force changes its sign from step to step. Only the fall is placed within its step, on a straight
line.

Contacts and forces are those of ``model.physics``. Modes tell how a contact began; here this is
inferred from the state. A1 inside the part presses on the bottom face, A2 on the nearer of bottom
and left side face, and a corner on the flat only with the depth beyond that of its edge.
"""

import math
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Literal

import numpy as np

from model.compile.entries import compiled
from model.compile.kernels import inlined_kernel, kernel
from model.engine.rates import moved
from model.engine.record import constants_in
from model.engine.start import start
from model.events.event_functions import (
    FLAT,
    LARGEST_TILT,
    corners_outside,
    edge_inside,
    largest,
    not_fallen_in,
)
from model.events.kernels import in_kernels
from model.events.scenes import ALIGNMENT
from model.events.sources import corner_positions
from model.physics.contacts import contact_load, corner_on_flat, edge_on_face, edge_on_side
from model.physics.forces import applied_forces
from model.physics.geometry import bottom_corner
from model.physics.modes import START
from model.physics.motion import never_sticks
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, STATE_SIZE, State
from model.physics.parameters import Batch, Parameters
from model.runs.settings import Settings
from verification.bench.methods.base import Method
from verification.bench.problems import Problem, Solution, Verdict

_EVERY_CONTACT, _EVENTS = in_kernels(ALIGNMENT)


@inlined_kernel
def _force(contact, depth, q, p):
    """Return the generalized force (x, y, moment) of a contact, n and T together."""
    n = max(0.0, contact_load(depth, contact.closing_rate, q, p))
    slip = -1.0 if never_sticks(p) else contact.slip  # printed friction (R2) takes one direction
    friction = -p.friction * n * (1.0 if slip > 0.0 else (-1.0 if slip < 0.0 else 0.0))
    normal, tangent = contact.normal, contact.tangent
    return (
        n * normal[0] + friction * tangent[0],
        n * normal[1] + friction * tangent[1],
        n * normal[2] + friction * tangent[2],
    )


@inlined_kernel
def _force_beside(edge, q, p):
    """Return the generalized force on one side: at the edge, and at the corner on the flat."""
    bottom, left, right, top = edge_inside(edge, corner_positions(q, p), p)
    inside = min(min(bottom, left), min(right, top)) > 0.0
    on_face = inside and (edge == RIGHT_EDGE or bottom <= left)
    x, y, moment = 0.0, 0.0, 0.0
    corner_x, corner_y = bottom_corner(edge, q.x, q.y, q.tilt, p)
    depth = -corner_y - (max(0.0, bottom) if on_face else 0.0)
    if depth > 0.0 and edge * q.tilt < -FLAT and edge * corner_x > p.slot_half_width:
        x, y, moment = _force(corner_on_flat(edge, q, p), depth, q, p)
    if on_face:
        face = _force(edge_on_face(edge, q, p), bottom, q, p)
        x, y, moment = x + face[0], y + face[1], moment + face[2]
    elif inside:
        side = _force(edge_on_side(LEFT_EDGE, q, p), left, q, p)
        x, y, moment = x + side[0], y + side[1], moment + side[2]
    return x, y, moment


@inlined_kernel
def rates(time, q, p):
    """Return dq/dτ as a ``State``."""
    right, left = _force_beside(RIGHT_EDGE, q, p), _force_beside(LEFT_EDGE, q, p)
    free = applied_forces(time, q, p)
    x, y = free[0] + right[0] + left[0], free[1] + right[1] + left[1]
    moment = free[2] + right[2] + left[2]
    return State(q.x_rate, q.y_rate, q.tilt_rate, x, y, moment / p.inertia)


@inlined_kernel
def outside(q, p):
    """Return a level > 0 until the part has fallen in, by the selected alignment criterion (R8)."""
    if p.printed_alignment_criterion != 0.0:
        return largest(corners_outside(corner_positions(q, p), p, START))[0]
    return largest(not_fallen_in(corner_positions(q, p), p, START))[0]


@inlined_kernel
def _has_left(q, p):
    """Return whether the part is off the edge A1, away from the slot, overturned, or not finite."""
    _, left, _, _ = edge_inside(RIGHT_EDGE, corner_positions(q, p), p)
    return left < 0.0 or abs(q.tilt) > LARGEST_TILT or not isfinite(q.x + q.y + q.tilt)


@kernel
def rk4_step(time, h, q, k1, p):
    """Return the state after a step of the classical Runge-Kutta method; ``k1``: rates at ``q``."""
    k2 = rates(time + 0.5 * h, moved(q, 0.5 * h, k1), p)
    k3 = rates(time + 0.5 * h, moved(q, 0.5 * h, k2), p)
    k4 = rates(time + h, moved(q, h, k3), p)
    return moved(moved(moved(moved(q, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4)


@kernel
def euler_step(h, q, k1):
    """Return the state after a step of semi-implicit Euler, which moves with the new velocities."""
    x_rate, y_rate = q.x_rate + h * k1.x_rate, q.y_rate + h * k1.y_rate
    tilt_rate = q.tilt_rate + h * k1.tilt_rate
    x, y, tilt = q.x + h * x_rate, q.y + h * y_rate, q.tilt + h * tilt_rate
    return State(x, y, tilt, x_rate, y_rate, tilt_rate)


@compiled
@kernel
def run_each(rows, euler, h, horizon, most_steps, out):
    """Run all rows of constants; write (fallen in, finished, steps, time, state) into ``out``.

    A run ends at once if the part has fallen in at the start, after the step in which it falls in
    or leaves the scene, at the horizon, or unfinished after ``most_steps``. The time of the fall is
    on a straight line between the ends of its step; the state is that at the end of the step.
    """
    for row in range(rows.shape[0]):
        p = constants_in(_EVENTS, rows[row])
        q, _ = start(p, _EVERY_CONTACT)
        steps, time, length, before, level = 0, 0.0, 0.0, 1.0, outside(q, p)
        finished = level < 0.0
        while steps < most_steps and not finished:
            length, before, k1 = min(h, horizon - time), level, rates(time, q, p)
            q = euler_step(length, q, k1) if euler else rk4_step(time, length, q, k1, p)
            steps += 1
            time, level = min(steps * h, horizon), outside(q, p)
            finished = level < 0.0 or _has_left(q, p) or horizon - time <= 1e-9 * h
        if level < 0.0:
            time = time - length * level / (level - before)
        out[row, 0], out[row, 1], out[row, 2], out[row, 3] = level < 0.0, finished, steps, time
        for n, value in enumerate(q):
            out[row, 4 + n] = value


Scheme = Literal["rk4", "semi_implicit_euler"]
STAGES: Mapping[Scheme, int] = {"rk4": 4, "semi_implicit_euler": 1}  # evaluations of a step


class FixedSteps(Method):
    """Compiled runs with equal steps."""

    fixed = True

    def __init__(self, name: str, scheme: Scheme) -> None:
        self.name, self.scheme, self.stages = name, scheme, STAGES[scheme]

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        return solve_by_hand(Batch.stack(cases), self.scheme, resolution, problem.settings)


def solve_by_hand(batch: Batch, scheme: Scheme, step: float, settings: Settings) -> Solution:
    """Return alignment times, final states and evaluations of a batch with equal steps."""
    euler = scheme == "semi_implicit_euler"
    cost, out = STAGES[scheme], np.empty((len(batch), 4 + STATE_SIZE))
    most_steps = settings.max_evaluations // cost
    run_each(batch.constants(settings.readings), euler, step, settings.horizon, most_steps, out)
    fallen_in, finished, steps, time = out[:, :4].T
    failure = None if finished.all() else Verdict.TOO_MANY_EVALUATIONS
    tau_align = np.where(fallen_in == 1.0, time, math.nan)
    return Solution(tau_align, out[:, np.newaxis, 4:], cost * int(steps.sum()), failure)
