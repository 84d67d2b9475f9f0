"""The error of a run, carried through its steps by the linearised motion and through its events.

Every step adds its local error, the next two terms of its series. Between events the error obeys
the linearised equations of motion (``ErrorWriter`` of series_code.py). Where a contact sticks, the
step's end removes the slip of the run, and with it that of the error. At an event the error is
multiplied by the saltation matrix: a displaced run reaches the event later, and until then moves in
the mode before it (Leine and Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems,
2004, section 7.2).

Input: the workspace after ``step_all``, and the run's record. Output: the errors in the record.
"""

from math import inf

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.compile.vector_code import each_lane
from model.engine import workspace
from model.engine.rates import STILL, moved, rates_at
from model.engine.record import AT, ERROR, constants_of, mode_of, state_in, store_state_in
from model.engine.series_layout import ERROR_ORDERS, LINES, MOST_ERROR_ORDER, ORDER, REMAINDER
from model.engine.workspace import (
    constants_of_lane,
    mode_of_lane,
    state_in_lane,
    store_state_in_lane,
)
from model.events.friction import hold_sticking, without_slip
from model.events.kernels import kind_of, level
from model.events.table import OF_LENGTH
from model.physics.modes import CLOSED, STICKING
from model.physics.motion import is_beside, is_supported
from model.physics.notation import STATE_SIZE, State

DISPLACEMENT = 1e-7  # of the state, for a derivative
NO_ERROR = 1e-300  # least size of an error that a derivative is taken along


@inlined_kernel
def size_of(q):
    """Largest absolute value of a state; infinity if one is not a number."""
    total = abs(q.x) + abs(q.y) + abs(q.tilt) + abs(q.x_rate) + abs(q.y_rate) + abs(q.tilt_rate)
    if not total < inf:
        return inf
    rates = max(max(abs(q.x_rate), abs(q.y_rate)), abs(q.tilt_rate))
    return max(max(max(abs(q.x), abs(q.y)), abs(q.tilt)), rates)


@inlined_kernel
def _error_after(length, w, lane):
    """The error at ``length`` after the step's start; it grows by the terms that series omit."""
    error, omitted, last = STILL, STILL, w[workspace.ERROR_ORDER, lane]
    for order in reversed(range(MOST_ERROR_ORDER + 1)):
        if order in ERROR_ORDERS[:-1]:  # what other lanes need beyond is left out
            error = State(*(each if order < last else 0.0 for each in error))
        known = state_in_lane(w, workspace.ERROR + order * LINES, lane)
        error = moved(known, length, error)
    for further in range(ORDER + REMAINDER, ORDER, -1):
        term = state_in_lane(w, workspace.COEFFICIENTS + further * LINES, lane)
        omitted = moved(term, length, omitted)
    return moved(error, length ** (ORDER + 1), omitted)


@separate_kernel
def errors_at_ends(lanes, w):
    """Write the errors at the ends of the steps of all lanes, without slip where contacts stick."""
    for i in each_lane():
        error = _error_after(w[workspace.STEP_LENGTH, i], w, i)
        factor = DISPLACEMENT / max(size_of(error), NO_ERROR)
        end, p = state_in_lane(w, workspace.END, i), constants_of_lane(lanes, w, i)
        held = without_slip(moved(end, factor, error), p, mode_of_lane(lanes, w, i))
        error = moved(STILL, 1.0 / factor, moved(held, -1.0, end))
        store_state_in_lane(error, w, workspace.ERROR_AT_END, i)


@inlined_kernel
def carry_error(until, w, lane, runs, i):
    """Carry the error of run ``i`` through the fraction ``until`` of the step of its lane."""
    if until == 1.0:
        error = state_in_lane(w, workspace.ERROR_AT_END, lane)
    else:
        error = _error_after(until * w[workspace.STEP_LENGTH, lane], w, lane)
    store_state_in(error, runs, ERROR, i)
    runs[i, AT.largest_error] = max(runs[i, AT.largest_error], size_of(error))


@kernel
def _derivative(events, which, time, q, p, mode, direction, later):
    """Return the derivative of a level along ``direction`` of the state and ``later`` of time.

    The level is zero at ``q``: one value beside it is enough.
    """
    ahead, moment = moved(q, DISPLACEMENT, direction), later * DISPLACEMENT
    return level(events, which, time + moment, ahead, p, mode) / DISPLACEMENT


@inlined_kernel
def _keeps_friction(presses, slip, presses_after, slip_after):
    """Return whether no slip ends or reverses, and no contact that begins sticks.

    Then friction stops no slip at once.
    """
    if presses:
        return not presses_after or slip_after == slip or slip == STICKING
    return not presses_after or slip_after != STICKING


@inlined_kernel
def _supports_alike(before, after):
    return (
        before.support_slip == after.support_slip
        and before.slip_at_corner == after.slip_at_corner
        and before.corner_offset == after.corner_offset
        and before.edge == after.edge
        and before.in_slot == after.in_slot
    )


@inlined_kernel
def _presses_aside_alike(before, after):
    return before.side_slip == after.side_slip and before.slip_at_wall == after.slip_at_wall


@inlined_kernel
def _has_the_same_forces(before, after):
    """Return whether the same contacts press before and after an event, and slip the same way.

    Then a gap has opened, or a stage of the fall has passed: a displaced run moves as this one.
    """
    return (
        (before.face == CLOSED) == (after.face == CLOSED)
        and (before.corner == CLOSED) == (after.corner == CLOSED)
        and (before.side == CLOSED) == (after.side == CLOSED)
        and (before.wall == CLOSED) == (after.wall == CLOSED)
        and (not is_supported(before) or _supports_alike(before, after))
        and (not is_beside(before) or _presses_aside_alike(before, after))
    )


@inlined_kernel
def _is_continuous(kind, before, after):
    """Return whether forces and velocities, and with them the error, are continuous at an event.

    They are where a load passes zero, and where friction reaches its limit.
    """
    return (
        kind != OF_LENGTH
        and _keeps_friction(
            is_supported(before), before.support_slip, is_supported(after), after.support_slip
        )
        and _keeps_friction(is_beside(before), before.side_slip, is_beside(after), after.side_slip)
    )


@separate_kernel
def apply_saltation(events, which, q, rates, before, runs, i):
    """Carry the error of run ``i`` through the event ``which``, after the change of its mode.

    ``q``, ``rates`` and ``before`` are its state at the event, their rates and its mode before it.
    """
    time, p, after = runs[i, AT.time], constants_of(events, runs, i), mode_of(runs, i)
    error = state_in(runs, ERROR, i)
    size = size_of(error)
    if not 0.0 < size < inf or _has_the_same_forces(before, after):
        return
    if _is_continuous(kind_of(events, which), before, after):
        return
    rates_after = rates_at(time, q, p, after)
    unit = moved(STILL, 1.0 / size, error)
    across = size * _derivative(events, which, time, q, p, before, unit, 0.0)
    late = -across / _derivative(events, which, time, q, p, before, rates, 1.0)
    at_event = moved(error, late, rates)
    factor = DISPLACEMENT / max(size_of(at_event), NO_ERROR)
    held = hold_sticking(moved(q, factor, at_event), p, after)
    jump = moved(held, -1.0, hold_sticking(q, p, after))
    error = moved(moved(STILL, 1.0 / factor, jump), -late, rates_after)
    store_state_in(error, runs, ERROR, i)
    runs[i, AT.largest_error] = max(runs[i, AT.largest_error], size_of(error))


@separate_kernel
def error_of_time(events, which, q, before, runs, i):
    """Return a bound of the error of the time of an event at ``q`` that ends the mode ``before``.

    Contributions of the components of the state are summed by size: their errors are estimates, and
    need not cancel.
    """
    time, p, error = runs[i, AT.time], constants_of(events, runs, i), state_in(runs, ERROR, i)
    across = 0.0
    for n in range(STATE_SIZE):
        unit = State(*(float(n == each) for each in range(STATE_SIZE)))
        across += abs(error[n] * _derivative(events, which, time, q, p, before, unit, 0.0))
    rates = rates_at(time, q, p, before)
    return across / abs(_derivative(events, which, time, q, p, before, rates, 1.0))
