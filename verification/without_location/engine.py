"""Engine without event location, as in an integrator without modes.

One right-hand side holds for every state: a contact presses wherever its depth is positive, with
n = max(0, load), and its friction is -μ n sign(slip). It has kinks where a contact begins or ends
and jumps where a slip reverses, and the integrator steps across them. It cannot stick: at rest the
friction force changes its sign from step to step.

Contacts and forces are those of ``model.physics``. A mode holds how a contact began; this engine
infers it from the state: A1 inside the part presses on the bottom face, A2 on the nearer of bottom
and left side, and a corner on the flat only by the depth beyond that of its edge.
"""

from math import isfinite, nan
from typing import NamedTuple

from model.engines.course import start
from model.engines.record import constants_in
from model.engines.scalar.step import error_estimate, keep_in, state_of
from model.events.levels import (
    FLAT,
    LARGEST_TILT,
    corners_outside,
    edge_inside,
    largest,
    not_fallen_in,
    outline,
)
from model.physics.compiled import inlined_kernel, kernel
from model.physics.contacts import contact_load, corner_on_flat, edge_on_face, edge_on_side
from model.physics.forces import (
    axial_suspension,
    excitation,
    lateral_suspension,
    press,
    tilt_suspension,
)
from model.physics.geometry import bottom_corner
from model.physics.motion import never_sticks
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, STATE_SIZE
from model.physics.scenes import ALIGNMENT, START

# How to step.
RK4_STEPS, SEMI_IMPLICIT_EULER_STEPS, ADAPTIVE_STEPS = 0, 1, 2

_EVERY_CONTACT = ALIGNMENT.declared
_FIRST_STEP = 1e-2
_BISECTIONS = 60


class Passage(NamedTuple):
    """Result of a run.

    ``tau_align`` is NaN unless the part fell in by ``time``, the end; ``evaluations`` counts
    right-hand sides; ``finished`` is 0.0 where the evaluations ran out first.
    """

    tau_align: float
    time: float
    evaluations: float
    finished: float


# --- The right-hand side ------------------------------------------------------------------------


@inlined_kernel
def _slip_sign(slip, p):
    """Sign of the slip, 0 at rest; printed friction (R2) takes one direction whatever the slip."""
    if never_sticks(p):
        return -1.0
    return 1.0 if slip > 0.0 else (-1.0 if slip < 0.0 else 0.0)


@inlined_kernel
def _force(contact, depth, q, p):
    """Generalized force (x, y, moment) of one contact that is ``depth`` deep: n and T together."""
    n = max(0.0, contact_load(depth, contact.closing_rate, q, p))
    friction = -p.friction * n * _slip_sign(contact.slip, p)
    normal, tangent = contact.normal, contact.tangent
    return (
        n * normal[0] + friction * tangent[0],
        n * normal[1] + friction * tangent[1],
        n * normal[2] + friction * tangent[2],
    )


@inlined_kernel
def _corner_force(side, face_depth, q, p):
    """Force of the flat beside the slot on a bottom corner, where it is the lower of the two."""
    corner_x, corner_y = bottom_corner(side, q.x, q.y, q.tilt, p)
    depth = -corner_y - max(0.0, face_depth)
    if depth > 0.0 and side * q.tilt < -FLAT and side * corner_x > p.slot_half_width:
        return _force(corner_on_flat(side, q, p), depth, q, p)
    return 0.0, 0.0, 0.0


@inlined_kernel
def _right_force(q, p):
    """Force at the right edge A1, under the bottom face, and at the corner B1."""
    bottom, left, right, top = edge_inside(RIGHT_EDGE, outline(q, p), p)
    inside = min(min(bottom, left), min(right, top)) > 0.0
    x, y, moment = _corner_force(RIGHT_EDGE, bottom if inside else 0.0, q, p)
    if inside:
        face = _force(edge_on_face(RIGHT_EDGE, q, p), bottom, q, p)
        x, y, moment = x + face[0], y + face[1], moment + face[2]
    return x, y, moment


@inlined_kernel
def _left_force(q, p):
    """Force at the left edge A2, on the nearer of bottom and side face, and at the corner B2."""
    bottom, left, right, top = edge_inside(LEFT_EDGE, outline(q, p), p)
    inside = min(min(bottom, left), min(right, top)) > 0.0
    on_face = inside and bottom <= left
    x, y, moment = _corner_force(LEFT_EDGE, bottom if on_face else 0.0, q, p)
    if on_face:
        face = _force(edge_on_face(LEFT_EDGE, q, p), bottom, q, p)
        x, y, moment = x + face[0], y + face[1], moment + face[2]
    elif inside:
        side = _force(edge_on_side(LEFT_EDGE, q, p), left, q, p)
        x, y, moment = x + side[0], y + side[1], moment + side[2]
    return x, y, moment


@inlined_kernel
def write_rates(time, y, p, out):
    """Write dy/dτ into ``out``, shape (6,), for the state ``y``, shape (6,), in any mode."""
    q = state_of(y)
    right, left = _right_force(q, p), _left_force(q, p)
    out[0], out[1], out[2] = y[3], y[4], y[5]
    out[3] = lateral_suspension(q, p) + right[0] + left[0]
    out[4] = axial_suspension(q, p) + press(p) + excitation(time, p) + right[1] + left[1]
    out[5] = (tilt_suspension(q, p) + right[2] + left[2]) / p.inertia


@kernel
def outside(y, p):
    """Positive until the part has fallen in, by the selected alignment criterion (R8)."""
    q = state_of(y)
    if p.printed_alignment_criterion != 0.0:
        return largest(corners_outside(outline(q, p), p, START))[0]
    return largest(not_fallen_in(outline(q, p), p, START))[0]


@kernel
def _has_left(y, p):
    """Return whether the part is off the edge A1, away from the slot, or overturned."""
    q = state_of(y)
    _, left, _, _ = edge_inside(RIGHT_EDGE, outline(q, p), p)
    return left < 0.0 or abs(q.tilt) > LARGEST_TILT or not isfinite(q.x + q.y + q.tilt)


# --- Steps --------------------------------------------------------------------------------------


@kernel
def runge_kutta_step(time, h, y, p, method, k, y_end):
    """Fill ``k``, shape (stages + 1, 6), from ``k[0]`` and write the step's end into ``y_end``."""
    for i in range(1, method.stages + 1):
        for n in range(STATE_SIZE):
            slope = 0.0
            for j in range(i):
                slope += method.a[i, j] * k[j, n]
            y_end[n] = y[n] + h * slope
        write_rates(time + method.c[i] * h, y_end, p, k[i])


@kernel
def semi_implicit_euler_step(time, h, y, p, rates, y_end):
    """Velocities first, then positions with the new velocities (symplectic Euler)."""
    write_rates(time, y, p, rates)
    for n in range(3):
        y_end[n + 3] = y[n + 3] + h * rates[n + 3]
        y_end[n] = y[n] + h * y_end[n + 3]


@kernel
def _fall_within(h, y, p, method, k, trial):
    """Return the length of the step up to the fall, by bisection on the continuous extension.

    Writes the state there into ``trial``, which must not be ``y``.
    """
    low, high = 0.0, 1.0
    for _ in range(_BISECTIONS):
        theta = 0.5 * (low + high)
        for n in range(STATE_SIZE):
            value = 0.0
            for i in range(method.dense.shape[1] - 1, -1, -1):
                slope = 0.0
                for j in range(method.stages + 1):
                    slope += method.dense[j, i] * k[j, n]
                value = (value + slope) * theta
            trial[n] = y[n] + h * value
        if outside(trial, p) < 0.0:
            high = theta
        else:
            low = theta
    return high * h


# --- Runs ---------------------------------------------------------------------------------------


@inlined_kernel
def _copy(state, into):
    for n in range(STATE_SIZE):
        into[n] = state[n]


@kernel
def _fixed_steps(scheme, h, p, method, horizon, max_evaluations, y, k, y_end):
    """Take equal steps; the fall into the slot is noticed at the end of a step."""
    cost = method.stages if scheme == RK4_STEPS else 1
    time, steps = 0.0, 0
    while horizon - time > 1e-9 * h:
        if (steps + 1) * cost > max_evaluations:
            return Passage(nan, time, float(steps * cost), 0.0)
        length = min(h, horizon - time)
        if scheme == RK4_STEPS:
            runge_kutta_step(time, length, y, p, method, k, y_end)
            _copy(k[method.stages], k[0])
        else:
            semi_implicit_euler_step(time, length, y, p, k[0], y_end)
        steps += 1
        time = min(steps * h, horizon)
        _copy(y_end, y)
        if outside(y, p) < 0.0:
            return Passage(time, time, float(steps * cost), 1.0)
        if _has_left(y, p):
            break
    return Passage(nan, time, float(steps * cost), 1.0)


@kernel
def _adaptive_steps(tolerance, p, method, horizon, max_evaluations, y, k, y_end):
    """Take steps to a tolerance; only the fall is located, on the continuous extension."""
    time, h, evaluations = 0.0, _FIRST_STEP, 1
    while time < horizon:
        if evaluations + method.stages > max_evaluations:
            return Passage(nan, time, float(evaluations), 0.0)
        last = time + 1.0001 * h >= horizon
        length = horizon - time if last else h
        runge_kutta_step(time, length, y, p, method, k, y_end)
        evaluations += method.stages
        error = error_estimate(length, y, y_end, method, k, tolerance)
        if not error <= 1.0:
            shrink = 0.9 * error ** (-1.0 / method.order) if isfinite(error) else 0.1
            h = length * max(0.1, shrink)
            if h <= 1e-14 * max(1.0, time):
                return Passage(nan, time, float(evaluations), 0.0)
            continue
        h = length * (5.0 if error == 0.0 else min(5.0, 0.9 * error ** (-1.0 / method.order)))
        if outside(y_end, p) < 0.0:
            tau = time + _fall_within(length, y, p, method, k, y_end)
            _copy(y_end, y)
            return Passage(tau, tau, float(evaluations), 1.0)
        time = horizon if last else time + length
        _copy(y_end, y)
        _copy(k[method.stages], k[0])
        if _has_left(y, p):
            break
    return Passage(nan, time, float(evaluations), 1.0)


@kernel
def run_without_location(scheme, resolution, p, method, horizon, max_evaluations, y, y_end, k):
    """Run one parameter set from its start to the fall or ``horizon``: ``Passage``.

    Args:
        scheme: RK4_STEPS, SEMI_IMPLICIT_EULER_STEPS or ADAPTIVE_STEPS.
        resolution: length of a step, or tolerance of ADAPTIVE_STEPS relative to 1 + |state|.
        p: ``Constants``.
        method: ``Method`` of a scheme by Runge-Kutta steps; its last stage is the step's end.
        horizon: latest time.
        max_evaluations: largest number of right-hand-side evaluations.
        y: shape (6,), filled with the state at the end.
        y_end: shape (6,), overwritten.
        k: shape (stages + 1, 6), overwritten.
    """
    q, _ = start(p, _EVERY_CONTACT)
    keep_in(q, y)
    write_rates(0.0, y, p, k[0])
    if scheme == ADAPTIVE_STEPS:
        return _adaptive_steps(resolution, p, method, horizon, max_evaluations, y, k, y_end)
    return _fixed_steps(scheme, resolution, p, method, horizon, max_evaluations, y, k, y_end)


@kernel
def run_rows(rows, scheme, resolution, method, horizon, max_evaluations, out, y_end, k):
    """Run every row of ``rows``, shape (n, constants), into ``out``, shape (n, 4 + 6)."""
    for i in range(rows.shape[0]):
        p = constants_in(rows[i])
        passage = run_without_location(
            scheme, resolution, p, method, horizon, max_evaluations, out[i, 4:], y_end, k
        )
        out[i, 0], out[i, 1] = passage.tau_align, passage.time
        out[i, 2], out[i, 3] = passage.evaluations, passage.finished


@kernel
def write_rates_of(time, y, row, out):
    """Write dy/dτ of the constants in ``row`` into ``out``, shape (6,)."""
    write_rates(time, y, constants_in(row), out)


@kernel
def outside_of(y, row):
    """Return ``outside`` of the constants in ``row``."""
    return outside(y, constants_in(row))
