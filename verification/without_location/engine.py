"""Engine without event location, as in an integrator without modes.

One right-hand side holds for every state: a contact presses wherever its depth is positive, with
n = max(0, load), and its friction is -μ n sign(slip). It has kinks where a contact begins or ends
and jumps where a slip reverses, and the integrator steps across them. It cannot stick: at rest the
friction force changes its sign from step to step.

Contacts and forces are those of ``model.physics``. A mode holds how a contact began; this engine
infers it from the state: A1 inside the part presses on the bottom face, A2 on the nearer of bottom
and left side, and a corner on the flat only by the depth beyond that of its edge.

Runs with equal steps go side by side, in loops over LANES that the compiler vectorizes: row r of
the workspace ``w`` holds one number a run, that of lane i at ``w[r * LANES + i]``.
"""

from math import isfinite, nan
from typing import NamedTuple

from model.engines.batch.series import CONSISTENT
from model.engines.batch.series_plan import WIDTH
from model.engines.course import start
from model.engines.record import CONSTANTS, constants_in
from model.engines.scalar.step import error_estimate, keep_in, moved, state_of
from model.events.kernel_set import KernelSet
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
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, STATE_SIZE, State
from model.physics.parameters import Constants
from model.physics.scenes import ALIGNMENT, START
from model.physics.views import reader, writer

_EVERY_CONTACT = ALIGNMENT.declared
_FIRST_STEP = 1e-2
_BISECTIONS = 60

LANES = WIDTH
# Rows of the workspace: the constants; the run, its steps and its end; the time and length of the
# step; the state at its start, the rates entered last, and the slope of the step so far.
_RUN, _STEPS, _END, TIME, LENGTH, STATE = range(CONSTANTS, CONSTANTS + 6)
RATES, _SLOPE, ROWS = (STATE + n * STATE_SIZE for n in (1, 2, 3))

_ZERO = State(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_NONE = -1.0  # _RUN
_GOES_ON, _FELL_IN, _HAS_LEFT, _SPENT = 0.0, 1.0, 2.0, 3.0  # _END

_state_of_lane = reader(State, "w, row, i", "w[(row + {}) * LANES + i]".format, LANES=LANES)
_keep_constants = writer(Constants, "w, i", "w[{} * LANES + i]".format, LANES=LANES)
_keep_in_lane = writer(State, "w, row, i", "w[(row + {}) * LANES + i]".format, LANES=LANES)


def _layout(name, printed):
    """Return how lanes hold the constants: with the readings, or none ``printed``."""

    def place(n):
        return f"w[{n} * LANES + i]" if printed or n in CONSISTENT else "0.0"

    constants = reader(Constants, "w, i", place, LANES=LANES)
    return KernelSet(name, {"constants": constants}, {__file__})


NONE_PRINTED, ANY_READINGS = _layout("none-printed", False), _layout("any-readings", True)


class Passage(NamedTuple):
    """Result of a run.

    ``tau_align`` is NaN unless the part fell in by ``time``, the end; ``evaluations`` counts
    right-hand sides; ``finished`` is 0.0 where the evaluations ran out first.
    """

    tau_align: float
    time: float
    evaluations: float
    finished: float


PASSAGE_SIZE = len(Passage._fields)
_keep_passage = writer(Passage, "out, row", "out[row, {}]".format)


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
def _rates(time, q, p):
    """Return dy/dτ in the state ``q``, in any mode, as a ``State``."""
    right, left = _right_force(q, p), _left_force(q, p)
    x = lateral_suspension(q, p) + right[0] + left[0]
    y = axial_suspension(q, p) + press(p) + excitation(time, p) + right[1] + left[1]
    moment = tilt_suspension(q, p) + right[2] + left[2]
    return State(q.x_rate, q.y_rate, q.tilt_rate, x, y, moment / p.inertia)


@inlined_kernel
def write_rates(time, y, p, out):
    """Write dy/dτ into ``out``, shape (6,), for the state ``y``, shape (6,), in any mode."""
    keep_in(_rates(time, state_of(y), p), out)


@inlined_kernel
def _outside(q, p):
    """Positive until the part has fallen in, by the selected alignment criterion (R8)."""
    if p.printed_alignment_criterion != 0.0:
        return largest(corners_outside(outline(q, p), p, START))[0]
    return largest(not_fallen_in(outline(q, p), p, START))[0]


@kernel
def outside(y, p):
    """Positive until the part in the state ``y``, shape (6,), has fallen in."""
    return _outside(state_of(y), p)


@inlined_kernel
def _has_left(q, p):
    """Return whether the part is off the edge A1, away from the slot, or overturned."""
    _, left, _, _ = edge_inside(RIGHT_EDGE, outline(q, p), p)
    return (left < 0.0) | (abs(q.tilt) > LARGEST_TILT) | (not isfinite(q.x + q.y + q.tilt))


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


# --- Equal steps, in lanes ----------------------------------------------------------------------


@kernel
def _stage(layout, weight, share, fraction, w):
    """Enter the rates of a stage, which takes those of the stage before only.

    Args:
        layout: ``NONE_PRINTED`` or ``ANY_READINGS``.
        weight: of the rates of the stage before in the slope to this one.
        share: of the rates of the stage before in the slope of the whole step.
        fraction: place of the stage in the step.
        w: workspace.

    One large loop: LLVM unrolls small ones over LANES, and then does not vectorize them.
    """
    for i in range(LANES):
        h, rates = w[LENGTH * LANES + i], _state_of_lane(w, RATES, i)
        q = moved(_state_of_lane(w, STATE, i), h, moved(_ZERO, weight, rates))
        _keep_in_lane(moved(_state_of_lane(w, _SLOPE, i), share, rates), w, _SLOPE, i)
        rates = _rates(w[TIME * LANES + i] + fraction * h, q, layout.constants(w, i))
        _keep_in_lane(rates, w, RATES, i)


@inlined_kernel
def _symplectic(q, h, rates):
    """Velocities first, then positions with the new velocities (symplectic Euler)."""
    x_rate, y_rate = q.x_rate + h * rates.x_rate, q.y_rate + h * rates.y_rate
    tilt_rate = q.tilt_rate + h * rates.tilt_rate
    x, y, tilt = q.x + h * x_rate, q.y + h * y_rate, q.tilt + h * tilt_rate
    return State(x, y, tilt, x_rate, y_rate, tilt_rate)


@inlined_kernel
def _last_stage(layout, symplectic, share, fraction, h, horizon, most_steps, w):
    """Go on to the end of the step, and enter its rates, which are the next step's first.

    Enters also which runs end there, and returns whether one does: the fall into the slot is
    noticed at the end of a step. In one loop with the rates, what both need of a state is computed
    once.
    """
    some_end = False
    for i in range(LANES):
        q, rates = _state_of_lane(w, STATE, i), _state_of_lane(w, RATES, i)
        length, steps = w[LENGTH * LANES + i], w[_STEPS * LANES + i] + 1.0
        time, p = min(steps * h, horizon), layout.constants(w, i)
        if symplectic:
            q, moment = _symplectic(q, length, rates), time
        else:
            q = moved(q, length, moved(_state_of_lane(w, _SLOPE, i), share, rates))
            moment = w[TIME * LANES + i] + fraction * length
            _keep_in_lane(_ZERO, w, _SLOPE, i)
        _keep_in_lane(q, w, STATE, i)
        _keep_in_lane(_rates(moment, q, p), w, RATES, i)
        end = _SPENT if steps >= most_steps else _GOES_ON
        end = _HAS_LEFT if _has_left(q, p) | (horizon - time <= 1e-9 * h) else end
        end = _FELL_IN if _outside(q, p) < 0.0 else end
        end = end if w[_RUN * LANES + i] != _NONE else _GOES_ON
        w[_STEPS * LANES + i], w[TIME * LANES + i], w[_END * LANES + i] = steps, time, end
        w[LENGTH * LANES + i] = min(h, horizon - time)
        some_end |= end != _GOES_ON
    return some_end


@kernel
def take_steps(layout, symplectic, method, h, horizon, most_steps, w):
    """Take a step in every lane, and return whether a run ends there."""
    if symplectic:
        return _last_stage(layout, True, 0.0, 0.0, h, horizon, most_steps, w)
    last = method.stages
    for i in range(1, last):
        _stage(layout, method.a[i, i - 1], method.a[last, i - 1], method.c[i], w)
    share, fraction = method.a[last, last - 1], method.c[last]
    return _last_stage(layout, False, share, fraction, h, horizon, most_steps, w)


@kernel
def _begin(run, rows, h, horizon, most_steps, w, lane):
    """Begin a run in a lane, which stays empty if there are no more."""
    w[_RUN * LANES + lane], w[_END * LANES + lane] = _NONE, _GOES_ON
    if run == rows.shape[0]:
        return
    p = constants_in(rows[run])
    q, _ = start(p, _EVERY_CONTACT)
    _keep_constants(p, w, lane)
    _keep_in_lane(q, w, STATE, lane)
    _keep_in_lane(_rates(0.0, q, p), w, RATES, lane)
    _keep_in_lane(_ZERO, w, _SLOPE, lane)
    w[_RUN * LANES + lane], w[_STEPS * LANES + lane], w[TIME * LANES + lane] = run, 0.0, 0.0
    w[LENGTH * LANES + lane] = min(h, horizon)
    w[_END * LANES + lane] = _GOES_ON if most_steps > 0 else _SPENT


@kernel
def _finish(cost, w, lane, out):
    """Write the result of the run in a lane."""
    end, time, run = w[_END * LANES + lane], w[TIME * LANES + lane], int(w[_RUN * LANES + lane])
    tau_align, finished = time if end == _FELL_IN else nan, 0.0 if end == _SPENT else 1.0
    _keep_passage(Passage(tau_align, time, cost * w[_STEPS * LANES + lane], finished), out, run)
    keep_in(_state_of_lane(w, STATE, lane), out[run, PASSAGE_SIZE:])


# --- Runs ---------------------------------------------------------------------------------------


@inlined_kernel
def _copy(state, into):
    for n in range(STATE_SIZE):
        into[n] = state[n]


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
        if _has_left(state_of(y), p):
            break
    return Passage(nan, time, float(evaluations), 1.0)


@kernel
def run_with_fixed_steps(rows, layout, symplectic, h, method, horizon, max_evaluations, out, w):
    """Run every row of ``rows``, shape (n, constants), with equal steps.

    Args:
        rows: constants of the runs.
        layout: ``ANY_READINGS``, or the faster ``NONE_PRINTED`` where no reading is printed.
        symplectic: steps of the semi-implicit Euler method instead of ``method``.
        h: length of a step.
        method: ``Method`` whose last stage is the step's end, each of whose stages takes the rates
            of the one before only, as RK4.
        horizon: latest time.
        max_evaluations: largest number of right-hand-side evaluations of a run.
        out: shape (n, 4 + 6), filled with each ``Passage`` and state at the end.
        w: workspace of ``ROWS`` rows, overwritten.
    """
    count, cost = rows.shape[0], 1 if symplectic else method.stages
    most_steps, begun, ended = max_evaluations // cost, 0, 0
    for lane in range(LANES):
        _begin(begun, rows, h, horizon, most_steps, w, lane)
        begun = min(begun + 1, count)
    some_end = most_steps == 0
    while ended < count:
        while some_end:
            some_end = False
            for lane in range(LANES):
                if w[_END * LANES + lane] != _GOES_ON:
                    _finish(cost, w, lane, out)
                    _begin(begun, rows, h, horizon, most_steps, w, lane)
                    begun, ended = min(begun + 1, count), ended + 1
                    some_end |= w[_END * LANES + lane] != _GOES_ON
        some_end = take_steps(layout, symplectic, method, h, horizon, most_steps, w)


@kernel
def run_with_adaptive_steps(rows, tolerance, method, horizon, max_evaluations, out, y_end, k):
    """Run every row of ``rows``, shape (n, constants), with steps to a tolerance.

    Args:
        rows: constants of the runs.
        tolerance: tolerance of a step, relative to 1 + |state|.
        method: ``Method`` whose last stage is the step's end.
        horizon: latest time.
        max_evaluations: largest number of right-hand-side evaluations of a run.
        out: shape (n, 4 + 6), filled with each ``Passage`` and state at the end.
        y_end: shape (6,), overwritten.
        k: shape (stages + 1, 6), overwritten.
    """
    for i in range(rows.shape[0]):
        p, y = constants_in(rows[i]), out[i, PASSAGE_SIZE:]
        q, _ = start(p, _EVERY_CONTACT)
        keep_in(q, y)
        write_rates(0.0, y, p, k[0])
        passage = _adaptive_steps(tolerance, p, method, horizon, max_evaluations, y, k, y_end)
        _keep_passage(passage, out, i)


@kernel
def write_rates_of(time, y, row, out):
    """Write dy/dτ of the constants in ``row`` into ``out``, shape (6,)."""
    write_rates(time, y, constants_in(row), out)


@kernel
def outside_of(y, row):
    """Return ``outside`` of the constants in ``row``."""
    return outside(y, constants_in(row))
