"""Inside the step of one lane: the state at a place, the first switch, and the largest values.

Every switching function is a constant plus multiples of places and forces, or the largest of four
such quantities; so the quantities' series follow from those of places and forces, and tell where a
function falls. A function of an absolute value is asked twice, once with each sign.
"""

from math import inf

import numpy as np

from model.engines.batch import lanes
from model.engines.batch.lanes import (
    COEFFICIENTS,
    CONTACTS_AT,
    TOO_FLAT_TO_TELL,
    Sizes,
    constants_of_lane,
    contacts_in,
    is_corner,
    mode_of_lane,
    one_stays_above,
    outline_in,
    single_functions,
    stays_above,
)
from model.engines.batch.series_code import FRACTIONS, NODES, ORDER, ROWS, SINES, TILT, WIDTH
from model.engines.record import FORCE_MAX, STATE, TILT_MAX, TIME, constants_of, mode_of
from model.engines.scalar import location as locate
from model.engines.scalar.location import NO_SWITCH, sample_step
from model.events.table import (
    ALIGNED,
    COMBINED_COUNT,
    CORNERS_INSIDE,
    FACE_END,
    FACE_FAR_END,
    FACE_GAP,
    FACE_LOAD,
    FACE_RELOAD,
    LEFT_CORNER_LANDS,
    LEFT_EDGE_ENTERS,
    LEFT_WALL,
    NOTHING,
    ON_A_SWITCH,
    OVERTURNED,
    RIGHT_CORNER_LANDS,
    RIGHT_EDGE_ENTERS,
    RIGHT_WALL,
    SIDE_END,
    SIDE_GAP,
    SIDE_LOAD,
    SIDE_RELOAD,
    SIDE_SLIP,
    SUPPORT_SLIP,
    SWITCH_COUNT,
    is_wall,
    largest,
    quantities,
    quantities_at,
)
from model.events.transitions import REST_SLIP
from model.physics.compiled import inlined_kernel, kernel
from model.physics.notation import STATE_SIZE, State
from model.physics.scenes import CLOSED, STICKING

QUANTITIES = 4  # of a switching function
TERMS = ORDER + 1  # of the series of each
_QUARTER = FRACTIONS[0]
_FINEST = 2.0**-24  # part of a step that is not divided
_MOST_PARTS = 64  # of a quarter; then parts of a sixteenth of the step are not divided
_LEAVING = 2.0**-4  # part in which a function that begins on its switch is taken to go one way
_ROOT_ITERATIONS = 60
_CLOSE = 1e-8  # to a root: the next iteration is as close as its square
_PEAK_ITERATIONS = 2


@inlined_kernel
def _at(row, theta, w, lane):
    """One of the states, or of what is watched, at the fraction ``theta`` of the step.

    Even and odd orders by themselves: twice as many operations at a time.
    """
    time = theta * w[lanes.LENGTH * WIDTH + lane]
    square, odd = time * time, 0.0
    even = w[(COEFFICIENTS + ORDER * ROWS + row) * WIDTH + lane]
    for order in range(ORDER - 2, -2, -2):
        even = even * square + w[(COEFFICIENTS + order * ROWS + row) * WIDTH + lane]
        odd = odd * square + w[(COEFFICIENTS + (order + 1) * ROWS + row) * WIDTH + lane]
    return even + time * odd


@kernel
def state_at(theta, w, lane):
    """The ``State`` at the fraction ``theta`` of the step."""
    return State(
        _at(0, theta, w, lane), _at(1, theta, w, lane), _at(2, theta, w, lane),
        _at(3, theta, w, lane), _at(4, theta, w, lane), _at(5, theta, w, lane),
    )  # fmt: skip


@inlined_kernel
def _quantities_of(which, sign, at, contacts, tilt, p, mode):
    """The quantities of function ``which``, if what it asks the size of has this sign."""
    if which < COMBINED_COUNT:
        return quantities_at(which, at, tilt, p)
    sizes = Sizes(
        sign * at.left_along_axis, sign * contacts.support_friction,
        sign * contacts.side_friction, sign * tilt,
    )  # fmt: skip
    functions = single_functions(at, contacts, sizes, p, mode)
    place = which - (FACE_LOAD if which <= SIDE_END else SUPPORT_SLIP - (SIDE_END - FACE_LOAD + 1))
    return functions[place], NOTHING, NOTHING, NOTHING


@inlined_kernel
def _enter(which, sign, series, w, lane):
    """As ``enter_series``, of a function known to the compiler."""
    p, mode = constants_of_lane(w, lane), mode_of_lane(w, lane)
    constant = _quantities_of(which, sign, lanes.NOWHERE, lanes.UNLOADED, 0.0, p, mode)
    count = QUANTITIES if which < COMBINED_COUNT else 1
    scale = 1.0
    for order in range(ORDER + 1):
        row = COEFFICIENTS + order * ROWS
        at, contacts = outline_in(row, scale, w, lane), contacts_in(row, scale, w, lane)
        tilt = scale * w[(row + TILT) * WIDTH + lane]
        g = _quantities_of(which, sign, at, contacts, tilt, p, mode)
        if order > 0:
            g = (g[0] - constant[0], g[1] - constant[1], g[2] - constant[2], g[3] - constant[3])
        for each in range(count):
            series[each * TERMS + order] = g[each]
        scale *= w[lanes.LENGTH * WIDTH + lane]


@kernel
def enter_series(which, sign, series, w, lane):
    """Enter the series of a function's quantities in the step's fraction.

    Into ``series``, shape (QUANTITIES * TERMS,), of function ``which``, if what it asks the size of
    has this sign. Each function has a loop of its own, which takes no more than it needs.
    """
    if which == ALIGNED:
        _enter(ALIGNED, 1.0, series, w, lane)
    elif which == CORNERS_INSIDE:
        _enter(CORNERS_INSIDE, 1.0, series, w, lane)
    elif which == RIGHT_EDGE_ENTERS:
        _enter(RIGHT_EDGE_ENTERS, 1.0, series, w, lane)
    elif which == LEFT_EDGE_ENTERS:
        _enter(LEFT_EDGE_ENTERS, 1.0, series, w, lane)
    elif which == RIGHT_CORNER_LANDS:
        _enter(RIGHT_CORNER_LANDS, 1.0, series, w, lane)
    elif which == LEFT_CORNER_LANDS:
        _enter(LEFT_CORNER_LANDS, 1.0, series, w, lane)
    elif which == RIGHT_WALL:
        _enter(RIGHT_WALL, 1.0, series, w, lane)
    elif which == LEFT_WALL:
        _enter(LEFT_WALL, 1.0, series, w, lane)
    elif which == FACE_LOAD:
        _enter(FACE_LOAD, 1.0, series, w, lane)
    elif which == FACE_GAP:
        _enter(FACE_GAP, 1.0, series, w, lane)
    elif which == FACE_RELOAD:
        _enter(FACE_RELOAD, 1.0, series, w, lane)
    elif which == FACE_END:
        _enter(FACE_END, 1.0, series, w, lane)
    elif which == FACE_FAR_END:
        _enter(FACE_FAR_END, 1.0, series, w, lane)
    elif which == SIDE_LOAD:
        _enter(SIDE_LOAD, 1.0, series, w, lane)
    elif which == SIDE_GAP:
        _enter(SIDE_GAP, 1.0, series, w, lane)
    elif which == SIDE_RELOAD:
        _enter(SIDE_RELOAD, 1.0, series, w, lane)
    elif which == SIDE_END:
        _enter(SIDE_END, sign, series, w, lane)
    elif which == SUPPORT_SLIP:
        _enter(SUPPORT_SLIP, sign, series, w, lane)
    elif which == SIDE_SLIP:
        _enter(SIDE_SLIP, sign, series, w, lane)
    else:
        _enter(OVERTURNED, sign, series, w, lane)


@inlined_kernel
def _value(each, theta, series):
    """One of the quantities at the fraction ``theta`` of the step.

    Even and odd orders by themselves: twice as many operations at a time.
    """
    square, even, odd = theta * theta, series[each * TERMS + ORDER], 0.0
    for order in range(ORDER - 2, -2, -2):
        even = even * square + series[each * TERMS + order]
        odd = odd * square + series[each * TERMS + order + 1]
    return even + theta * odd


@inlined_kernel
def _slope(each, theta, series):
    """Its derivative, Σ k c_k θ^(k-1), with ratios of k in place of k: one operation waits less."""
    square = theta * theta
    odd, even = series[each * TERMS + ORDER - 1], series[each * TERMS + ORDER]
    for order in range(ORDER - 3, -1, -2):
        odd = odd * (square * ((order + 2.0) / order)) + series[each * TERMS + order]
    for order in range(ORDER - 2, 0, -2):
        even = even * (square * ((order + 2.0) / order)) + series[each * TERMS + order]
    return odd + 2.0 * theta * even


@inlined_kernel
def _values(count, theta, series):
    """The quantities, of which only the first, or all, are something."""
    if count == 1:
        return _value(0, theta, series), NOTHING, NOTHING, NOTHING
    return (
        _value(0, theta, series), _value(1, theta, series),
        _value(2, theta, series), _value(3, theta, series),
    )  # fmt: skip


@kernel
def _root(each, low, f_low, high, f_high, series):
    """Where a quantity that has other signs at ``low`` and at ``high`` is zero.

    By Newton's method from the secant's root, kept between the two by bisection.
    """
    theta = low + (high - low) * f_low / (f_low - f_high)
    for _ in range(_ROOT_ITERATIONS):
        value, slope = _value(each, theta, series), _slope(each, theta, series)
        if value * f_low > 0.0:
            low = theta
        else:
            high = theta
        following = theta - value / slope
        if low <= following <= high and abs(following - theta) <= _CLOSE * following:
            return following
        theta = following if low < following < high else 0.5 * (low + high)
    return theta


@inlined_kernel
def _fall_of_all(count, left, before, right, after, series):
    """Where the largest of quantities that each go one way falls through zero, or NO_SWITCH.

    That is where the last of those that fall does, if none of the others has risen by then. In a
    part too small to be divided they need not go one way, if all end below zero.
    """
    last, first = left, inf
    for each in range(count):
        if before[each] > 0.0:
            last = max(last, _root(each, left, before[each], right, after[each], series))
    for each in range(count):
        if before[each] <= 0.0 < after[each]:
            first = min(first, _root(each, left, before[each], right, after[each], series))
    return last if last < first else NO_SWITCH


@inlined_kernel
def _goes_one_way(left, right, bend):
    """Whether a quantity stays below zero between two places, or falls or rises all the way."""
    return abs(left - right) > 4.0 * bend or stays_above(-left, -right, bend)


@inlined_kernel
def _all_go_one_way(before, after, bends):
    return (
        _goes_one_way(before[0], after[0], bends[0])
        and _goes_one_way(before[1], after[1], bends[1])
        and _goes_one_way(before[2], after[2], bends[2])
        and _goes_one_way(before[3], after[3], bends[3])
    )


@inlined_kernel
def _bend(each, left, right, series):
    """How far a quantity may be from the line through its values at two places."""
    square = right * right
    even, odd = abs(series[each * TERMS + ORDER]), abs(series[each * TERMS + ORDER - 1])
    for order in range(ORDER - 2, 0, -2):
        ratio = (order + 2.0) * (order + 1.0) / (order * (order - 1.0))
        even = even * (square * ratio) + abs(series[each * TERMS + order])
    for order in range(ORDER - 3, 1, -2):
        ratio = (order + 2.0) * (order + 1.0) / (order * (order - 1.0))
        odd = odd * (square * ratio) + abs(series[each * TERMS + order])
    return (0.25 * even + 0.75 * right * odd) * (right - left) ** 2


@inlined_kernel
def _bends(count, left, right, series):
    """The same of the quantities, of which only the first, or all, are something."""
    if count == 1:
        return _bend(0, left, right, series), 0.0, 0.0, 0.0
    return (
        _bend(0, left, right, series), _bend(1, left, right, series),
        _bend(2, left, right, series), _bend(3, left, right, series),
    )  # fmt: skip


@inlined_kernel
def _fall_between(which, count, left, end, series):
    """Where between two places the largest of ``series`` first falls through zero, or NO_SWITCH.

    The stretch is divided until in each part the function stays above zero by its bend, or each of
    the quantities goes one way.
    """
    right, before, parts = end, _values(count, left, series), 0
    while left < end:
        parts += 1
        after, width = _values(count, right, series), right - left
        most = _bends(count, left, right, series)
        if not one_stays_above(before, after, most):
            f, g = largest(before)[0], largest(after)[0]
            on_switch = ON_A_SWITCH if left == 0.0 and not is_corner(which) else REST_SLIP
            begins = abs(f) <= on_switch and g > -REST_SLIP
            # Of a function that is zero to rounding all along, no part is fine enough.
            finest = _FINEST if parts < _MOST_PARTS else _LEAVING
            # What is below zero and rises does not fall, nor what begins on zero and stays there.
            may_fall = (f > 0.0 or g < 0.0) and not (left == 0.0 and begins)
            decided = may_fall and _all_go_one_way(before, after, most)
            if decided or (may_fall and g < 0.0 and width <= finest):
                theta = _fall_of_all(count, left, before, right, after, series)
                if theta != NO_SWITCH:
                    return theta
            if not decided and width > (_LEAVING if begins else finest):
                right = left + 0.5 * width
                continue
        left, before, right = right, after, min(end, right + 2.0 * width)
    return NO_SWITCH


@inlined_kernel
def _fall_in(which, count, quarters, until, series):
    for quarter in range(NODES - 1):
        left, end = quarter * _QUARTER, min((quarter + 1) * _QUARTER, until)
        if quarters & (1 << quarter) != 0 and left < end:
            theta = _fall_between(which, count, left, end, series)
            if theta != NO_SWITCH:
                return theta
    return NO_SWITCH


@kernel
def first_fall(which, quarters, until, series):
    """``_fall_between`` in the first of the ``quarters``, given as bits, in which there is one."""
    if which < COMBINED_COUNT:
        return _fall_in(which, QUANTITIES, quarters, until, series)
    return _fall_in(which, 1, quarters, until, series)


@inlined_kernel
def _asks_size(which, mode):
    """Whether a function is of an absolute value."""
    sticks = (which == SUPPORT_SLIP and mode.support_slip == STICKING) or (
        which == SIDE_SLIP and mode.side_slip == STICKING
    )
    return sticks or which == SIDE_END or which == OVERTURNED


@kernel
def _fall_of(which, sign, until, series, w, lane):
    """``first_fall`` of a lane's function ``which``, if what it asks the size of has this sign.

    What begins at zero is divided by the fraction of the step: its other zeros stay.
    """
    quarters = int(w[(lanes.MAY_SWITCH + which) * WIDTH + lane])
    enter_series(which, sign, series, w, lane)
    if which < COMBINED_COUNT or series[0] != 0.0:
        return first_fall(which, quarters, until, series)
    series[TERMS] = 0.0
    return first_fall(which, quarters, until, series[1:])


@inlined_kernel
def _fall(which, until, series, w, lane):
    """The same of either sign."""
    first = _fall_of(which, 1.0, until, series, w, lane)
    if _asks_size(which, mode_of_lane(w, lane)):
        first = min(first, _fall_of(which, -1.0, min(until, first), series, w, lane))
    return first


@kernel
def _searched(w, lane, runs, work, i):
    """(which, θ) of the first switch, by the reference engine's search on the dense output."""
    time, h = runs[i, TIME], w[lanes.LENGTH * WIDTH + lane]
    p, mode = constants_of(runs, i), mode_of(runs, i)
    for n in range(STATE_SIZE):
        work.y[n] = runs[i, STATE + n]
        power = 1.0
        for order in range(1, ORDER + 1):
            coefficient = w[(COEFFICIENTS + order * ROWS + n) * WIDTH + lane]
            work.dense[n, order - 1] = power * coefficient
            power *= h
    sample_step(time, h, work.y, work.dense, p, mode, work.nodes, work.samples)
    return locate.first_switch(time, h, work.y, work.dense, p, mode, work.samples)


@inlined_kernel
def _is_flat(which, until, series, w, lane):
    """Whether a corner's function comes so low that its tilt may be that of a flat part."""
    until = min(until, 1.0)
    lowest = largest(_values(QUANTITIES, until, series))[0]
    lowest = min(lowest, w[(lanes.SAMPLES + which) * WIDTH + lane])
    for node, fraction in enumerate(FRACTIONS):
        if fraction < until:
            sample = lanes.SAMPLES + (node + 1) * SWITCH_COUNT + which
            lowest = min(lowest, w[sample * WIDTH + lane])
    return lowest < TOO_FLAT_TO_TELL


@kernel
def _moves_down(which, theta, w, lane):
    """Whether a corner that stands below the plane presses, as it moves down."""
    _, _, _, rising = quantities(which, state_at(theta, w, lane), constants_of_lane(w, lane))
    return rising < 0.0


@inlined_kernel
def _lowest_bit(bits):
    """Place of the lowest bit set, which is the exponent of that bit as a number."""
    return (np.float64(bits & -bits).view(np.int64) >> 52) - 1023


@kernel
def first_switch(w, lane, runs, work, series, i):
    """(which, θ) of the first switch in the step; θ is ``NO_SWITCH`` if there is none."""
    first, which_first, search = NO_SWITCH, -1, False
    shown = int(w[lanes.SHOWN * WIDTH + lane])
    while shown != 0:
        which = _lowest_bit(shown)
        shown &= shown - 1
        theta = _fall(which, first, series, w, lane)
        if is_corner(which) and (theta == NO_SWITCH or not _moves_down(which, theta, w, lane)):
            search = search or theta != NO_SWITCH or _is_flat(which, first, series, w, lane)
        elif is_wall(which):
            search = search or theta != NO_SWITCH
        elif theta < first:
            first, which_first = theta, which
    if search:
        which, theta = _searched(w, lane, runs, work, i)
        if theta < first and (is_wall(which) or which < COMBINED_COUNT):
            first, which_first = theta, which
    return which_first, first


@inlined_kernel
def _with_slope(row, sign, time, w, lane):
    """A row, times ``sign``, a time after the step's start, and its first two time derivatives."""
    value, slope, half = w[(COEFFICIENTS + ORDER * ROWS + row) * WIDTH + lane], 0.0, 0.0
    for order in range(ORDER - 1, -1, -1):
        half = half * time + slope
        slope = slope * time + value
        value = value * time + w[(COEFFICIENTS + order * ROWS + row) * WIDTH + lane]
    return sign * value, sign * slope, 2.0 * sign * half


@inlined_kernel
def _slopes(g):
    """Derivatives of a function at five equidistant places, from its values there."""
    return (
        (-25.0 * g[0] + 48.0 * g[1] - 36.0 * g[2] + 16.0 * g[3] - 3.0 * g[4]) / 12.0,
        (-3.0 * g[0] - 10.0 * g[1] + 18.0 * g[2] - 6.0 * g[3] + g[4]) / 12.0,
        (g[0] - 8.0 * g[1] + 8.0 * g[3] - g[4]) / 12.0,
        (-g[0] + 6.0 * g[1] - 18.0 * g[2] + 10.0 * g[3] + 3.0 * g[4]) / 12.0,
        (3.0 * g[0] - 16.0 * g[1] + 36.0 * g[2] - 48.0 * g[3] + 25.0 * g[4]) / 12.0,
    )


@kernel
def _peak(row, sign, theta, until, w, lane):
    """Value of the peak of a row, times ``sign``, near ``theta``, if it is before ``until``."""
    length = w[lanes.LENGTH * WIDTH + lane]
    time, value, slope, second = theta * length, 0.0, 0.0, -1.0
    for _ in range(_PEAK_ITERATIONS):
        time -= slope / second
        value, slope, second = _with_slope(row, sign, time, w, lane)
    time -= slope / second
    rises_to_it = second < 0.0 and 0.0 < time < until * length
    return value - 0.5 * slope * slope / second if rises_to_it else -inf


@kernel
def _highest(row, sign, until, known, w, lane):
    """The larger of ``known`` and the highest value of a row, times ``sign``, before ``until``."""
    first, node = (lanes.VALUES + row) * WIDTH + lane, SINES * WIDTH
    bend = lanes.bend_of(row, w, lane)
    g = (
        sign * w[first], sign * w[first + node], sign * w[first + 2 * node],
        sign * w[first + 3 * node], sign * w[first + 4 * node],
    )  # fmt: skip
    if max(max(g[0], g[1]), max(max(g[2], g[3]), g[4])) + bend <= known:
        return known
    highest = max(known, g[0])
    for n in range(1, NODES):
        if n * _QUARTER <= until:
            highest = max(highest, g[n])
    if until < 1.0:
        highest = max(highest, sign * _at(row, until, w, lane))
    slope = _slopes(g)
    for n in range(1, NODES):
        if slope[n - 1] > 0.0 > slope[n] and (n - 1) * _QUARTER < until:
            theta = (n - 1 + slope[n - 1] / (slope[n - 1] - slope[n])) * _QUARTER
            highest = max(highest, _peak(row, sign, theta, until, w, lane))
    return highest


@kernel
def largest_until(until, w, lane, runs, i):
    """Largest |tilt| and normal force so far, with those of a part of the step."""
    tilt, force, mode = runs[i, TILT_MAX], runs[i, FORCE_MAX], mode_of_lane(w, lane)
    if w[lanes.STEP_TILT * WIDTH + lane] > tilt:
        tilt = _highest(TILT, 1.0, until, tilt, w, lane)
        tilt = _highest(TILT, -1.0, until, tilt, w, lane)
    if w[lanes.STEP_FORCE * WIDTH + lane] > force:
        if mode.face == CLOSED:
            force = _highest(CONTACTS_AT, 1.0, until, force, w, lane)
        if mode.side == CLOSED:
            force = _highest(CONTACTS_AT + 2, 1.0, until, force, w, lane)
    return tilt, force
