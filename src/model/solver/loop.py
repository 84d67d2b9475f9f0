"""The one integration loop: step, locate the first switch, switch, go on."""

from math import isfinite, nan, pi
from typing import NamedTuple

import numpy as np

from model.physics.compiled import inlined_kernel, kernel
from model.physics.geometry import bottom_corner, resting_height
from model.physics.motion import is_supported
from model.physics.notation import RIGHT_EDGE
from model.physics.scenes import CLOSED, OPEN, START, STICKING
from model.solver.locate import NO_SWITCH, NODE_PLACES, NODES, first_switch, sample_step
from model.solver.outcomes import Outcome, Reason
from model.solver.settling import new_history, record_period, settled_period
from model.solver.step import (
    STATE_SIZE,
    dense_output,
    error_estimate,
    interpolate,
    right_hand_side,
    state_of,
    take_step,
)
from model.solver.switching import (
    CORNER_LOAD,
    CORNERS_INSIDE,
    FACE_FAR_END,
    FACE_LOAD,
    LEFT_EDGE_ENTERS,
    LEFT_WALL,
    NEVER,
    OVERTURNED,
    SAMPLE_SIZE,
    SIDE_LOAD,
    SWITCH_COUNT,
    switching_functions,
)
from model.solver.transitions import (
    CONTINUES,
    decide_friction,
    hold_sticking,
    switch,
    with_corner,
    with_face,
    without_residual_slip,
)

_ALIGNED = int(Outcome.ALIGNED)
_SETTLED = int(Outcome.SETTLED)
_HORIZON_REACHED = int(Outcome.HORIZON_REACHED)
_FAILED = int(Outcome.FAILED)
_NONE = int(Reason.NONE)
_IMPOSSIBLE_START = int(Reason.IMPOSSIBLE_START)
_STEP_TOO_SMALL = int(Reason.STEP_TOO_SMALL)
_TOO_MANY_EVALUATIONS = int(Reason.TOO_MANY_EVALUATIONS)
_CHATTER = int(Reason.CHATTER)
_NOT_FINITE = int(Reason.NOT_FINITE)
_NO_FRICTION_SOLUTION = int(Reason.NO_FRICTION_SOLUTION)

TRACK_COLUMNS = 9  # time, the state, the support's normal force, the side's
_FIRST_STEP = 1e-2
_MOST_SWITCHES_AT_ONCE = 64
_START_TOLERANCE = 1e-9
_ON_A_SWITCH = 1e-8  # a switching function below this is on its switch
_SWITCH_RESOLUTION = 1e-5  # square of a switch's last correction, relative to the tolerance
_FALL_TIME = 20.0  # how long to wait for the corners to be inside once the contact is lost


class Control(NamedTuple):
    """What a run is allowed.

    Attributes:
        tolerance: local error admitted in a step, relative to 1 + |state|.
        horizon: latest time.
        max_evaluations: most right-hand-side evaluations.
        may_settle: 1.0 to stop a run whose motion repeats itself, else 0.0.
    """

    tolerance: float
    horizon: float
    max_evaluations: int
    may_settle: float


class Ending(NamedTuple):
    """How a run ended and what it met on the way; all dimensionless.

    ``tau_align`` is NaN unless aligned, ``tau_corners_inside`` unless all four corner conditions
    came to hold. ``period`` counts excitation periods where the run settled, else 0.
    """

    outcome: int
    reason: int
    time: float
    tau_align: float
    tau_corners_inside: float
    tilt_at_alignment: float
    tilt_max: float
    separations: int
    contact_force_max: float
    sticking_share: float
    evaluations: int
    steps: int
    rejected: int
    switches: int
    period: int
    tracked: int


class Workspace(NamedTuple):
    """Arrays of one run. Shapes: k (m, 6), dense (6, degree), nodes and samples as in locate."""

    k: np.ndarray
    y_end: np.ndarray
    trial: np.ndarray
    dense: np.ndarray
    nodes: np.ndarray
    samples: np.ndarray


@kernel
def _workspace(method):
    m, degree = method.dense.shape
    return Workspace(
        np.empty((m, STATE_SIZE)), np.empty(STATE_SIZE), np.empty(STATE_SIZE),
        np.empty((STATE_SIZE, degree)), np.empty((NODES, STATE_SIZE)),
        np.empty((NODES, SAMPLE_SIZE)),
    )  # fmt: skip


@kernel
def start(p, declared):
    """State and mode at τ = 0: at rest, touching the base without pressing.

    The bottom face stands on the edge A1; a part tilted the other way stands on its corner B1. A
    contact that is not declared starts open: the run leaves the scene if the part presses there.
    """
    y = np.zeros(STATE_SIZE)
    y[0], y[2] = p.misalignment, p.initial_tilt
    y[1] = resting_height(p)
    corner_x, corner_y = bottom_corner(RIGHT_EDGE, y[0], y[1], y[2], p)
    if y[2] < 0.0 and corner_x > p.slot_half_width:
        y[1] -= corner_y
        standing = CLOSED if declared.corner_on_flat else OPEN
        return y, with_corner(with_face(START, RIGHT_EDGE, OPEN), RIGHT_EDGE, standing, 0.0)
    return y, with_face(START, RIGHT_EDGE, CLOSED if declared.edge_on_face else OPEN)


@kernel
def _start_is_impossible(q, p, mode):
    functions = np.empty(SAMPLE_SIZE)
    switching_functions(0.0, q, p, mode, functions)
    return (
        functions[LEFT_EDGE_ENTERS] < -_START_TOLERANCE
        or functions[LEFT_WALL] < -_START_TOLERANCE
        or functions[FACE_FAR_END] < -_START_TOLERANCE
        or functions[OVERTURNED] < 0.0
    )


@inlined_kernel
def _accepted_step(time, h, y, p, mode, method, control, work):
    """Shrink ``h`` until a step stands: (h, next h, steps rejected); h = 0 if none does."""
    rejected = 0
    while True:
        take_step(time, h, y, p, mode, method, work.k, work.y_end)
        error = error_estimate(h, y, work.y_end, method, work.k, control.tolerance)
        if error <= 1.0:
            growth = 5.0 if error == 0.0 else min(5.0, 0.9 * error ** (-1.0 / method.order))
            return h, h * max(growth, 0.3), rejected
        rejected += 1
        h *= max(0.1, 0.9 * error ** (-1.0 / method.order)) if isfinite(error) else 0.1
        if h <= 1e-14 * max(1.0, time):
            return 0.0, 0.0, rejected


@kernel
def _step_to_switch(which, theta, time, h, y, p, mode, method, resolution, work, scratch):
    """Repeat the step up to the switch: (length, steps taken), the state in ``work.y_end``.

    Newton's iteration on whole steps, so that the switch is as accurate as a step, whatever the
    order of the dense output that gives the slope. A last correction so small that its square is
    below ``resolution`` moves along the tangent instead.
    """
    length = theta * h
    near = 1e-3
    low, high = max(theta - near, 0.0), min(theta + near, 1.0)
    switching_functions(time + low * h, interpolate(low, h, y, work.dense), p, mode, scratch)
    f_low = scratch[which]
    switching_functions(time + high * h, interpolate(high, h, y, work.dense), p, mode, scratch)
    slope = (scratch[which] - f_low) / ((high - low) * h)
    taken = 0
    for _ in range(4):
        take_step(time, length, y, p, mode, method, work.k, work.y_end)
        taken += 1
        switching_functions(time + length, state_of(work.y_end), p, mode, scratch)
        correction = -scratch[which] / slope if slope < 0.0 else 0.0
        if abs(correction) > near * h:
            break
        moved = min(max(length + correction, 0.0), h)
        if (moved - length) ** 2 <= resolution:
            rates = work.k[method.stages]
            for n in range(STATE_SIZE):
                work.y_end[n] += (moved - length) * rates[n]
            length = moved
            break
        if taken < 4:
            length = moved
    return length, taken


@inlined_kernel
def _peak(i, left, middle, right):
    """Highest value of the parabola through the samples around a maximum at node ``i``."""
    d1, d2 = NODE_PLACES[i] - NODE_PLACES[i - 1], NODE_PLACES[i + 1] - NODE_PLACES[i]
    rise, fall = (middle - left) / d1, (right - middle) / d2
    if rise < 0.0 or fall > 0.0 or rise == fall:
        return max(left, max(middle, right))
    slope = (rise * d2 + fall * d1) / (d1 + d2)
    return middle + 0.25 * slope * slope * (d1 + d2) / (rise - fall)


@inlined_kernel
def _support_force(sample):
    face = sample[FACE_LOAD] if sample[FACE_LOAD] != NEVER else 0.0
    corner = sample[CORNER_LOAD] if sample[CORNER_LOAD] != NEVER else 0.0
    return face + corner


@inlined_kernel
def _side_force(sample):
    return sample[SIDE_LOAD] if sample[SIDE_LOAD] != NEVER else 0.0


@inlined_kernel
def _largest(nodes, samples, last):
    """(largest |tilt|, largest normal force) over samples 0..``last`` of a step."""
    tilt, force = 0.0, 0.0
    for i in range(last + 1):
        tilt = max(tilt, abs(nodes[i, 2]))
        force = max(force, max(_support_force(samples[i]), _side_force(samples[i])))
        if 0 < i < last:
            tilt = max(tilt, _peak(i, abs(nodes[i - 1, 2]), abs(nodes[i, 2]), abs(nodes[i + 1, 2])))
            support = _peak(
                i,
                _support_force(samples[i - 1]),
                _support_force(samples[i]),
                _support_force(samples[i + 1]),
            )
            side = _peak(
                i, _side_force(samples[i - 1]), _side_force(samples[i]), _side_force(samples[i + 1])
            )
            force = max(force, max(support, side))
    return tilt, force


@inlined_kernel
def _write_track(track, row, time, y, sample):
    if row < track.shape[0]:
        track[row, 0] = time
        track[row, 1 : 1 + STATE_SIZE] = y
        track[row, 7] = max(_support_force(sample), 0.0)
        track[row, 8] = max(_side_force(sample), 0.0)
    return row + 1


@kernel
def _track_switch(track, row, time, y, p, mode, scratch):
    """Write the state at a switch, with the forces of ``mode``, where the track has the row."""
    if row < track.shape[0]:
        switching_functions(time, state_of(y), p, mode, scratch)
    return _write_track(track, row, time, y, scratch)


@inlined_kernel
def _note_closest(samples, last, closest):
    """Lower ``closest`` to the samples of a step, but for functions that rise from zero in it.

    A mode starts on zeros of its own functions: that it leaves them is no approach to a switch.
    """
    for j in range(SWITCH_COUNT):
        if samples[0, j] != NEVER and samples[0, j] > _ON_A_SWITCH:
            for i in range(1, last + 1):
                closest[j] = min(closest[j], samples[i, j])


@inlined_kernel
def _keep(q, y):
    y[0], y[1], y[2], y[3], y[4], y[5] = q.x, q.y, q.tilt, q.x_rate, q.y_rate, q.tilt_rate


@inlined_kernel
def _opened(before, after):
    """Whether a switch left the part without support: a separation."""
    return (before.face != OPEN or before.corner != OPEN) and (
        after.face == OPEN and after.corner == OPEN
    )


@kernel
def integrate(p, declared, method, control, track):
    """Run one parameter set to its end: ``Ending``.

    Args:
        p: ``Constants``.
        declared: ``Declared`` contacts of the scene.
        method: ``Method``.
        control: ``Control``.
        track: shape (rows, 9), filled as far as it goes with time, state and normal forces of the
            support and of the side; ``Ending.tracked`` is the number of rows a full track has.
    """
    work = _workspace(method)
    scratch, closest = np.empty(SAMPLE_SIZE), np.full(SWITCH_COUNT, NEVER)
    made = np.zeros(SWITCH_COUNT, dtype=np.bool_)
    states, lowest = new_history()
    printed_criterion = p.printed_alignment_criterion != 0.0
    y, mode = start(p, declared)
    time, h = 0.0, _FIRST_STEP
    period_length = 2.0 * pi / p.frequency if p.frequency > 0.0 else 2.0 * pi
    periods, deadline = 0, control.horizon
    resolution = _SWITCH_RESOLUTION * control.tolerance
    outcome, reason, period = CONTINUES, _NONE, 0
    tau_align, tau_inside, tilt_at_alignment = nan, nan, nan
    tilt_max, force_max, sticking = abs(p.initial_tilt), 0.0, 0.0
    separations, evaluations, steps, rejections, switches = 0, 0, 0, 0, 0
    at_once, row = 0, 0

    if _start_is_impossible(state_of(y), p, mode):
        outcome, reason = _FAILED, _IMPOSSIBLE_START
    else:
        mode, possible = decide_friction(0.0, state_of(y), p, mode, True, True)
        if not possible:
            outcome, reason = _FAILED, _NO_FRICTION_SOLUTION
    row = _track_switch(track, row, time, y, p, mode, scratch)

    while outcome == CONTINUES:
        next_period = (periods + 1) * period_length
        stop = min(next_period, deadline)
        h_try = stop - time if time + 1.0001 * h >= stop else h
        right_hand_side(time, y, p, mode, work.k[0])
        h_step, h_next, rejected = _accepted_step(time, h_try, y, p, mode, method, control, work)
        evaluations += 1 + (1 + rejected) * method.stages
        rejections += rejected
        if h_step == 0.0:
            finite = isfinite(work.k[0].sum())
            outcome, reason = _FAILED, _STEP_TOO_SMALL if finite else _NOT_FINITE
            break
        dense_output(time, h_step, y, p, mode, method, work.k, work.trial, work.dense)
        evaluations += method.c.size - method.stages - 1
        sample_step(time, h_step, y, work.dense, p, mode, work.nodes, work.samples)
        which, theta = first_switch(time, h_step, y, work.dense, p, mode, work.samples, scratch)
        switches_here = theta != NO_SWITCH
        length, last = h_step, NODES - 1
        if switches_here:
            while NODE_PLACES[last] > theta:
                last -= 1
            length = 0.0
            if theta > 0.0:
                length, taken = _step_to_switch(
                    which, theta, time, h_step, y, p, mode, method, resolution, work, scratch
                )
                evaluations += taken * method.stages
        counted = not mode.dropped or printed_criterion
        if counted:
            tilt, force = _largest(work.nodes, work.samples, last)
            tilt_max, force_max = max(tilt_max, tilt), max(force_max, force)
            if mode.support_slip == STICKING and is_supported(mode):
                sticking += length
        for i in range(1, last + (0 if switches_here else 1)):
            node_time = time + NODE_PLACES[i] * h_step
            row = _write_track(track, row, node_time, work.nodes[i], work.samples[i])
        _note_closest(work.samples, last, closest)

        if length > 0.0:
            y[:] = work.y_end
        if counted:
            tilt_max = max(tilt_max, abs(y[2]))
        reached_stop = not switches_here and h_step == h_try and h_try == stop - time
        time = stop if reached_stop else time + length
        steps += 1
        # A step cut short by a stop says nothing against the length it was cut from.
        h = max(h, h_next) if h_step == h_try and h_try != h else h_next
        if switches_here:
            h = max(h_step, 1e-12)
            switches += 1
            made[which] = True
            at_once = at_once + 1 if length <= 1e-13 * max(1.0, time) else 0
            before = mode
            _keep(without_residual_slip(which, state_of(y), p, mode), y)
            row = _track_switch(track, row, time, y, p, mode, scratch)
            mode, outcome, reason = switch(which, time, state_of(y), p, mode, declared)
            if counted and outcome == CONTINUES and _opened(before, mode):
                separations += 1
            if outcome == _ALIGNED and which == CORNERS_INSIDE:
                tau_inside = time
                if printed_criterion:
                    tau_align, tilt_at_alignment = time, y[2]
            elif outcome == _ALIGNED:
                if not printed_criterion:
                    tau_align, tilt_at_alignment = time, y[2]
                    deadline = min(deadline, time + _FALL_TIME)
                outcome = CONTINUES
        _keep(hold_sticking(state_of(y), p, mode), y)
        if switches_here:
            row = _track_switch(track, row, time, y, p, mode, scratch)

        if outcome != CONTINUES:
            break
        if at_once > _MOST_SWITCHES_AT_ONCE:
            outcome, reason = _FAILED, _CHATTER
        elif evaluations > control.max_evaluations:
            outcome, reason = _FAILED, _TOO_MANY_EVALUATIONS
        elif time >= deadline:
            outcome = _HORIZON_REACHED
        elif reached_stop:
            periods += 1
            for j in range(SWITCH_COUNT):
                if made[j]:
                    closest[j] = NEVER
            record_period(periods, y, closest, states, lowest)
            closest[:] = NEVER
            made[:] = False
            if control.may_settle != 0.0 and not mode.dropped:
                noise = 100.0 * control.tolerance
                period = settled_period(periods, states, lowest, p, noise)
                if period > 0:
                    outcome = _SETTLED

    end = time
    if isfinite(tau_align):  # whatever happened in the fall afterwards, the part has aligned
        outcome, reason, end = _ALIGNED, _NONE, tau_align
    return Ending(
        outcome, reason, time, tau_align, tau_inside, tilt_at_alignment, tilt_max, separations,
        force_max, sticking / end if end > 0.0 else 0.0, evaluations, steps, rejections, switches,
        period, row,
    )  # fmt: skip
