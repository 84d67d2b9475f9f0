"""One step of a power series in every lane, and the candidates for events in it.

Input: constants, modes and states of the lanes (scheduling.py). Output, in the workspace: series
and samples, the candidates for events with their subintervals, and the state at the step's end.

Let g(θ) be a level, θ the fraction of the step. Between two samples it lies below their line by no
more than its curvature bound: an eighth of the squared distance times the largest |g''|, which
follows from the coefficients of the series. If the line stays above zero by more than this bound,
there is no event in between.
"""

from math import floor, inf

import numpy as np

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.compile.vector_code import WIDTH, each_lane
from model.engine.carried_error import errors_at_ends
from model.engine.lane_events import (
    CURVATURE,
    QUANTITIES,
    quantity_line,
    sample_levels,
    sample_line,
)
from model.engine.series_kernels import fill_errors, fill_series, sample_series
from model.engine.series_layout import (
    ERROR_ORDERS,
    LACK,
    LINES,
    NODES,
    ORDER,
    REMAINDER,
    SINES,
    STATE_LINES,
    TILT,
)
from model.engine.workspace import (
    CANDIDATES,
    COEFFICIENTS,
    CONTACTS_AT,
    CORNER_LOAD,
    END,
    ERROR_ORDER,
    FACE_LOAD,
    FILLED_ORDER,
    HALT,
    LAST_ORDER,
    LINE,
    LONGEST,
    SIDE_LOAD,
    STEP_LENGTH,
    TIME,
    TOLERANCE,
    VALUES,
    constants_of_lane,
    lowest_bit,
    mode_of_lane,
    state_in_lane,
    store_state_in_lane,
)
from model.events.event_functions import NEVER, ON_AN_EVENT
from model.events.friction import REST_SLIP, without_slip
from model.physics.forces import lack_of_press
from model.physics.modes import OPEN
from model.physics.motion import largest_rate
from model.physics.trigonometry import sine_cosine

# Lines whose terms limit a step, of plane and of round parts: states and places; with tips, their
# load and slip too, whose series end sooner than those of the states.
_OF_TIPS = FACE_LOAD, LINE["support_friction"]
_LINES_OF_STEPS = (
    tuple(range(CONTACTS_AT)),
    (*range(CONTACTS_AT), LINE["tips_depth"], *_OF_TIPS),
)
# So do those of the loads of contacts whose damping depends on the speed, printed as R3.
_LOADS = FACE_LOAD, SIDE_LOAD, CORNER_LOAD
LAST_TERMS = 4.0  # size of the last terms of a series over the tolerance; the remainder is smaller


_MOST_TURNED = (1.2, 2.2, inf)  # radians of the fastest oscillation in a step, by ``ERROR_ORDERS``


@kernel
def _set_sines(lanes, w):
    """Write what is known of the press, and sines and cosines at the step's start."""
    first = COEFFICIENTS + SINES
    for i in each_lane():
        p = constants_of_lane(lanes, w, i)
        s, c = sine_cosine(w[COEFFICIENTS + TILT, i])
        w[first, i], w[first + 1, i] = s, c
        s, c = sine_cosine(p.frequency * w[TIME, i] + p.phase)
        w[first + 2, i], w[first + 3, i] = s, c
        lack = lack_of_press(w[TIME, i], p)
        w[COEFFICIENTS + LACK, i] = lack
        w[COEFFICIENTS + LINES + LACK, i] = -p.press_rate if lack > 0.0 else 0.0


@inlined_kernel
def nth_root(value, order):
    """Return ``value``^(1/``order``) of a positive value, to half a percent.

    The bits of a float, exponent before mantissa, approximate its logarithm.
    """
    logarithm = np.float64(value).view(np.int64) * 2.0**-52 - 1023.0
    power = logarithm * (1.0 / order)
    whole = floor(power)
    part = power - whole
    octave = np.int64((np.int64(whole) + 1023) << 52).view(np.float64)
    return octave * (1.0 + part * (0.6565 + 0.3435 * part))


@inlined_kernel
def _step_of(lanes, order, admitted, w, i):
    """Step at which the largest term of an order, over 1 + |value|, equals ``admitted``.

    Terms of states and of places count: in flight the series of the states end sooner than the
    series of the places, which turn with the tilt. Ratios are compared by products, cheaper than
    divisions.
    """
    largest_size, its_scale = 1e-200, 1.0
    lines, mode = _LINES_OF_STEPS[lanes.events.constants.is_round], mode_of_lane(lanes, w, i)
    if lanes.symbols.printed_contact_damping_law != 0.0:
        lines = (*lines, *_LOADS)
    for n in lines:
        size = abs(w[COEFFICIENTS + order * LINES + n, i])
        if n in _OF_TIPS:
            size = size if mode.face != OPEN else 0.0
        elif n == SIDE_LOAD:
            size = size if mode.side != OPEN else 0.0
        elif n == CORNER_LOAD:
            size = size if mode.corner != OPEN else 0.0
        scale = 1.0 + abs(w[COEFFICIENTS + n, i])
        is_larger = size * its_scale > largest_size * scale
        largest_size = size if is_larger else largest_size
        its_scale = scale if is_larger else its_scale
    return nth_root(admitted * its_scale / largest_size, order)


@inlined_kernel
def _nothing(lanes, w, i):
    """Return 0, or NaN if a last coefficient of the states or event quantities is not a number."""
    last, total = COEFFICIENTS + ORDER * LINES, 0.0
    for n in range(STATE_LINES + lanes.series.count):
        total = total + w[last + n, i]
    return 0.0 * total


@kernel
def _set_lengths(lanes, w):
    """Set the steps at which the larger of the last two terms equals the admissible error.

    A step is NaN where a series that counts or is sampled has no numbers: comparisons would let it
    pass.
    """
    for i in each_lane():
        admitted = LAST_TERMS * w[TOLERANCE, i]
        step = min(
            _step_of(lanes, ORDER, admitted, w, i), _step_of(lanes, ORDER - 1, admitted, w, i)
        )
        step = min(step, w[LONGEST, i])
        time, halt = w[TIME, i], w[HALT, i]
        step = halt - time if time + 1.0001 * step >= halt else step
        w[STEP_LENGTH, i] = step + _nothing(lanes, w, i)


@kernel
def _set_error_orders(lanes, w):
    """Set the order of each lane's error by how far its fastest oscillation turns in the step."""
    for i in each_lane():
        p, mode = constants_of_lane(lanes, w, i), mode_of_lane(lanes, w, i)
        turned = w[STEP_LENGTH, i] * largest_rate(p, mode)
        order = 0.0
        for enough, most in reversed(tuple(zip(ERROR_ORDERS, _MOST_TURNED, strict=True))):
            order = float(enough) if turned <= most else order
        w[ERROR_ORDER, i] = order


@inlined_kernel
def _set_filled_order(w):
    """Set the order to which errors are filled: the highest of all lanes."""
    most = w[ERROR_ORDER, 0]
    for i in range(1, WIDTH):
        most = max(most, w[ERROR_ORDER, i])
    w[FILLED_ORDER, 0] = most


@inlined_kernel
def curvature_bound(line, w, i):
    """Return the bound of a quantity's distance from the line through two of its samples."""
    return CURVATURE * w[VALUES + NODES * SINES + line, i]


@inlined_kernel
def stays_above(left, right, bound, least=-ON_AN_EVENT):
    """Return whether a level with this curvature bound stays above zero between two nodes.

    If its values there differ by more than four bounds, it is monotonic: it may then begin at
    ``least`` and rise, or fall and end above zero.
    """
    rise = right - left
    return (
        (min(left, right) > bound)
        | ((left >= least) & (rise > 4.0 * bound))
        | ((right > 0.0) & (rise < -4.0 * bound))
    )


@inlined_kernel
def one_stays_above(left, right, bounds):
    """Return whether one of four quantities ``stays_above``, and with it the largest of them.

    A quantity that begins below zero does not: the others decide until it rises.
    """
    return (
        stays_above(left[0], right[0], bounds[0], -REST_SLIP)
        | stays_above(left[1], right[1], bounds[1], -REST_SLIP)
        | stays_above(left[2], right[2], bounds[2], -REST_SLIP)
        | stays_above(left[3], right[3], bounds[3], -REST_SLIP)
    )


@inlined_kernel
def _subintervals(first, second, third, fourth):
    """Mask of the subintervals in which a level does not stay above zero."""
    early = (0.0 if first else 1.0) + (0.0 if second else 2.0)
    return early + (0.0 if third else 4.0) + (0.0 if fourth else 8.0)


@inlined_kernel
def _levels_of(lanes, which, w, i):
    """Return the level of an event at each node."""
    return tuple(w[sample_line(lanes, which, node), i] for node in range(NODES))


@inlined_kernel
def _quantities_at(lanes, which, node, w, i):
    """Return the quantities of an event at a node; their bounds, at node NODES."""
    return tuple(w[quantity_line(lanes, which, node, part), i] for part in range(QUANTITIES))


@inlined_kernel
def _screen_single(lanes, which, w):
    """Add the bit of an event in lanes where its level, of one quantity, may reach zero."""
    bit = float(1 << which)
    for i in each_lane():
        above = min(_levels_of(lanes, which, w, i)) - w[lanes.bounds + which, i]
        w[CANDIDATES, i] += 0.0 if above > 0.0 else bit


@inlined_kernel
def _is_clear(lanes, which, part, w, i):
    """Return whether a quantity stays above its bound at every node."""
    values = tuple(w[quantity_line(lanes, which, n, part), i] for n in range(NODES))
    return min(values) > w[quantity_line(lanes, which, NODES, part), i]


@inlined_kernel
def _screen_combined(lanes, which, w):
    """Add the bit of an event in lanes where the largest of its quantities may reach zero.

    It stays above zero if one of the quantities does.
    """
    bit = float(1 << which)
    for i in each_lane():
        is_clear = (
            _is_clear(lanes, which, 0, w, i)
            | _is_clear(lanes, which, 1, w, i)
            | _is_clear(lanes, which, 2, w, i)
            | _is_clear(lanes, which, 3, w, i)
            | (w[sample_line(lanes, which, 0), i] == NEVER)
        )
        w[CANDIDATES, i] += 0.0 if is_clear else bit


@inlined_kernel
def _for_each(events, combined, single, lanes, w):
    """Do for each of the events in a mask what its number of quantities asks for."""
    while events != 0:
        which = lowest_bit(events)
        events &= events - 1
        if which < lanes.events.combined:
            combined(lanes, which, w)
        else:
            single(lanes, which, w)


@kernel
def _screen(lanes, applicable, w):
    """Write the candidates of each lane among the events that may apply."""
    for i in each_lane():
        w[CANDIDATES, i] = 0.0
    _for_each(applicable, _screen_combined, _screen_single, lanes, w)


@inlined_kernel
def _set_subintervals(lanes, which, mask, w, i):
    w[lanes.subintervals + which, i] = mask
    w[CANDIDATES, i] += float(1 << which) if mask > 0.0 else 0.0


@inlined_kernel
def _find_single(lanes, which, w):
    """Write the subintervals that may contain a down-crossing of a level of one quantity."""
    for i in each_lane():
        g, bound = _levels_of(lanes, which, w, i), w[lanes.bounds + which, i]
        mask = _subintervals(
            stays_above(g[0], g[1], bound), stays_above(g[1], g[2], bound),
            stays_above(g[2], g[3], bound), stays_above(g[3], g[4], bound),
        )  # fmt: skip
        _set_subintervals(lanes, which, 0.0 if g[0] == NEVER else mask, w, i)


@inlined_kernel
def _find_combined(lanes, which, w):
    """Write the subintervals that may contain a down-crossing of the largest of quantities."""
    for i in each_lane():
        bounds = _quantities_at(lanes, which, NODES, w, i)
        q = tuple(_quantities_at(lanes, which, node, w, i) for node in range(NODES))
        mask = _subintervals(
            one_stays_above(q[0], q[1], bounds), one_stays_above(q[1], q[2], bounds),
            one_stays_above(q[2], q[3], bounds), one_stays_above(q[3], q[4], bounds),
        )  # fmt: skip
        first = w[sample_line(lanes, which, 0), i]
        _set_subintervals(lanes, which, 0.0 if first == NEVER else mask, w, i)


@kernel
def _find(lanes, w):
    """Write the candidates that remain, with their subintervals."""
    candidates = 0
    for i in range(WIDTH):
        candidates |= int(w[CANDIDATES, i])
        w[CANDIDATES, i] = 0.0
    _for_each(candidates, _find_combined, _find_single, lanes, w)


@kernel
def _end_steps(lanes, w):
    """Write the state at the end of every step, with sticking contacts at rest."""
    for i in each_lane():
        end = state_in_lane(w, VALUES + (NODES - 1) * SINES, i)
        end = without_slip(end, constants_of_lane(lanes, w, i), mode_of_lane(lanes, w, i))
        store_state_in_lane(end, w, END, i)


@separate_kernel
def step_all(lanes, kind, applicable, control, addresses, w):
    """Make one step in every lane, and find the candidates for events in it.

    ``applicable`` is the mask of the events that may apply in any lane; ``addresses`` are those of
    ``Series``.
    """
    _set_sines(lanes, w)
    carries_error = control.carries_error != 0.0
    for i in each_lane():
        w[LAST_ORDER, i] = ORDER + REMAINDER * carries_error
    fill_series(lanes, kind, addresses, w)
    _set_lengths(lanes, w)
    if carries_error:
        _set_error_orders(lanes, w)
        _set_filled_order(w)
        fill_errors(lanes, kind, addresses, w)
    sample_series(lanes, w)
    sample_levels(lanes, applicable, w)
    _screen(lanes, applicable, w)
    _find(lanes, w)
    _end_steps(lanes, w)
    if carries_error:
        errors_at_ends(lanes, w)
