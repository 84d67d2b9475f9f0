"""Event search inside the step of one lane: the first event, and its state.

Input: the lane's lines of the workspace after ``step_all``. Output: the event and its fraction of
the step, for scheduling.py. Every level is a constant plus multiples of event quantities, or the
largest of four such sums. The series of its quantities therefore follow from the series of the
event quantities, and its zeros are located on them. A level with an absolute value is searched
twice, once for each sign of its argument.
"""

from math import inf

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.engine.lane_events import QUANTITIES, TERMS, enter_series, has_absolute
from model.engine.series_layout import FRACTIONS, LINES, NODES, ORDER
from model.engine.step import one_stays_above, stays_above
from model.engine.workspace import (
    CANDIDATES,
    COEFFICIENTS,
    STEP_LENGTH,
    constants_of_lane,
    lowest_bit,
    mode_of_lane,
)
from model.events.event_functions import ABSENT, ON_AN_EVENT, largest
from model.events.friction import REST_SLIP
from model.events.kernels import guard, is_conditional
from model.physics.notation import STATE_SIZE, State

NO_EVENT = 2.0  # a fraction of the step beyond its end
_SUBINTERVAL = FRACTIONS[0]
_SOON = 2.0**-6  # part of a step after which a level below zero must have fallen further
_FINEST = 2.0**-24  # smallest part of a step, which is not divided
_MOST_PARTS = 64  # parts of a subinterval after which sixteenths of the step are not divided
_LEAVING = 2.0**-4  # part in which a monotonic level leaves the zero at which it starts
_ROOT_ITERATIONS = 60
_CLOSE = 1e-8  # last relative correction of a root; the error left is of the order of its square


@inlined_kernel
def line_at(line, theta, w, lane):
    """A state variable or event quantity at the fraction ``theta`` of the step.

    Even and odd orders are summed separately, which doubles instruction-level parallelism.
    """
    time = theta * w[STEP_LENGTH, lane]
    square, odd = time * time, 0.0
    even = w[COEFFICIENTS + ORDER * LINES + line, lane]
    for order in range(ORDER - 2, -2, -2):
        even = even * square + w[COEFFICIENTS + order * LINES + line, lane]
        odd = odd * square + w[COEFFICIENTS + (order + 1) * LINES + line, lane]
    return even + time * odd


@kernel
def state_at(theta, w, lane):
    """The ``State`` at the fraction ``theta`` of the step."""
    return State(*(line_at(n, theta, w, lane) for n in range(STATE_SIZE)))


@inlined_kernel
def _slope_of(line, time, w, lane):
    """The rate of a line at ``time`` after the step's start."""
    slope = 0.0
    for order in range(ORDER, 0, -1):
        slope = slope * time + order * w[COEFFICIENTS + order * LINES + line, lane]
    return slope


@kernel
def rates_in_step(q, theta, w, lane):
    """The rates of the state ``q`` at the fraction ``theta`` of the step, from its series."""
    time = theta * w[STEP_LENGTH, lane]
    accelerations = tuple(_slope_of(STATE_SIZE // 2 + n, time, w, lane) for n in range(3))
    return State(q.x_rate, q.y_rate, q.tilt_rate, *accelerations)


@inlined_kernel
def _value(each, theta, series):
    """A quantity at the fraction ``theta`` of the step.

    Even and odd orders are summed separately, which doubles instruction-level parallelism.
    """
    square, even, odd = theta * theta, series[each * TERMS + ORDER], 0.0
    for order in range(ORDER - 2, -2, -2):
        even = even * square + series[each * TERMS + order]
        odd = odd * square + series[each * TERMS + order + 1]
    return even + theta * odd


@inlined_kernel
def _slope(each, theta, series):
    """Derivative of a quantity, Σ k c_k θ^(k-1); ratios of k shorten the chain of operations."""
    square = theta * theta
    odd, even = series[each * TERMS + ORDER - 1], series[each * TERMS + ORDER]
    for order in range(ORDER - 3, -1, -2):
        odd = odd * (square * ((order + 2.0) / order)) + series[each * TERMS + order]
    for order in range(ORDER - 2, 0, -2):
        even = even * (square * ((order + 2.0) / order)) + series[each * TERMS + order]
    return odd + 2.0 * theta * even


@inlined_kernel
def values_at(count, theta, series):
    """Quantities at the fraction ``theta``: all four, or the first and ABSENT."""
    if count == 1:
        return _value(0, theta, series), ABSENT, ABSENT, ABSENT
    return tuple(_value(each, theta, series) for each in range(QUANTITIES))


@kernel
def _zero(each, low, f_low, high, f_high, series):
    """Zero of a quantity that has opposite signs at ``low`` and ``high``.

    Newton's method from the secant's root, safeguarded by bisection.
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
def _crossing_of_all(count, left, before, right, after, series):
    """Down-crossing of the largest of monotonic quantities, or NO_EVENT.

    It is the last zero of the falling quantities, if it comes before the first zero of the rising
    ones. In a part too small to be divided, quantities that all end negative need not be monotonic.
    """
    last, first = left, inf
    for each in range(count):
        if before[each] > 0.0:
            last = max(last, _zero(each, left, before[each], right, after[each], series))
    for each in range(count):
        if before[each] <= 0.0 < after[each]:
            first = min(first, _zero(each, left, before[each], right, after[each], series))
    return last if last < first else NO_EVENT


@inlined_kernel
def _is_monotonic(left, right, bound):
    """Return whether a quantity stays below zero between two fractions, or is monotonic."""
    return abs(left - right) > 4.0 * bound or stays_above(-left, -right, bound)


@inlined_kernel
def _all_are_monotonic(before, after, bounds):
    return (
        _is_monotonic(before[0], after[0], bounds[0])
        and _is_monotonic(before[1], after[1], bounds[1])
        and _is_monotonic(before[2], after[2], bounds[2])
        and _is_monotonic(before[3], after[3], bounds[3])
    )


@inlined_kernel
def _bound(each, left, right, series):
    """Bound of the distance of a quantity from the line through its values at two fractions."""
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
def _bounds(count, left, right, series):
    """``_bound`` of all four quantities, or of the first and 0."""
    if count == 1:
        return _bound(0, left, right, series), 0.0, 0.0, 0.0
    return tuple(_bound(each, left, right, series) for each in range(QUANTITIES))


@inlined_kernel
def _falls_from_zero(before, after, on_event):
    return before < -on_event or after < -REST_SLIP


@inlined_kernel
def _all_fall_from_zero(before, after, on_event):
    """Return whether all quantities that are zero at the left are below zero at the right.

    Others may be above zero there: the largest of all is negative only for a time in between.
    """
    return (
        _falls_from_zero(before[0], after[0], on_event)
        and _falls_from_zero(before[1], after[1], on_event)
        and _falls_from_zero(before[2], after[2], on_event)
        and _falls_from_zero(before[3], after[3], on_event)
    )


@inlined_kernel
def _beginning(count, left, before, after):
    """Return how a level begins in a part: (it may cross zero downward in it, it begins at zero).

    A level that rises from below zero does not cross. Nor does one that begins at zero and does not
    fall: in the first part or, if its quantities are several, which are places, in the first
    sixteenth of the step.
    """
    f, g = largest(before)[0], largest(after)[0]
    on_event = ON_AN_EVENT if left == 0.0 else REST_SLIP
    at_zero = -on_event <= f <= REST_SLIP and g > -REST_SLIP
    if at_zero and count > 1 and _all_fall_from_zero(before, after, on_event):
        return True, at_zero
    if at_zero and (left == 0.0 or (count > 1 and left < _LEAVING)):
        return False, at_zero
    return f > 0.0 or g < 0.0, at_zero


@inlined_kernel
def _crossing_between(count, left, end, series):
    """First down-crossing of the largest of ``series`` between two fractions, or NO_EVENT.

    The interval is divided until in each part the level stays above zero by its curvature bound, or
    each of the quantities is monotonic.
    """
    right, before, parts = end, values_at(count, left, series), 0
    while left < end:
        parts += 1
        after, width = values_at(count, right, series), right - left
        most = _bounds(count, left, right, series)
        if not one_stays_above(before, after, most):
            # Bounds the work on a level that is zero to rounding all the time.
            finest = _FINEST if parts < _MOST_PARTS else _LEAVING
            may_cross, at_zero = _beginning(count, left, before, after)
            is_monotonic = _all_are_monotonic(before, after, most)
            ends_below = largest(after)[0] < 0.0
            if may_cross and (is_monotonic or (ends_below and width <= finest)):
                theta = _crossing_of_all(count, left, before, right, after, series)
                if theta != NO_EVENT:
                    return theta
            if not (may_cross and is_monotonic):
                stays_at_zero = count == 1 and min(before[0], after[0]) - most[0] > -REST_SLIP
                least = _LEAVING if at_zero and (is_monotonic or stays_at_zero) else finest
                if width > least:
                    right = left + 0.5 * width
                    continue
        left, before, right = right, after, min(end, right + 2.0 * width)
    return NO_EVENT


@inlined_kernel
def _crossing_in(count, subintervals, until, series):
    for each in range(NODES - 1):
        left, end = each * _SUBINTERVAL, min((each + 1) * _SUBINTERVAL, until)
        if subintervals & (1 << each) != 0 and left < end:
            theta = _crossing_between(count, left, end, series)
            if theta != NO_EVENT:
                return theta
    return NO_EVENT


@kernel
def first_crossing(lanes, which, subintervals, until, series):
    """First down-crossing of a level in the ``subintervals`` of a mask, or NO_EVENT."""
    if which < lanes.events.combined:
        return _crossing_in(QUANTITIES, subintervals, until, series)
    return _crossing_in(1, subintervals, until, series)


@kernel
def _crossing_of(lanes, which, sign, until, series, w, lane):
    """``first_crossing`` of level ``which``, if the argument of its absolute value has this sign.

    A level that starts at zero is divided by the fraction of the step; its other zeros remain.
    """
    subintervals = int(w[lanes.subintervals + which, lane])
    enter_series(lanes, which, sign, series, w, lane)
    several = which < lanes.events.combined
    if several or series[0] != 0.0:
        return first_crossing(lanes, which, subintervals, until, series)
    series[TERMS] = 0.0
    return first_crossing(lanes, which, subintervals, until, series[1:])


@inlined_kernel
def crossing(lanes, which, until, series, w, lane):
    """The first down-crossing of level ``which`` before ``until``, or NO_EVENT."""
    first = _crossing_of(lanes, which, 1.0, until, series, w, lane)
    if has_absolute(lanes, which, w, lane):
        other = _crossing_of(lanes, which, -1.0, min(until, first), series, w, lane)
        first = min(first, other)
    return first


@kernel
def _is_refused(lanes, which, theta, series, w, lane):
    """Return whether a zero at θ of a level with a guard is not the event.

    A level that its guard has refused may rise again from below zero.
    """
    p, mode = constants_of_lane(lanes, w, lane), mode_of_lane(lanes, w, lane)
    if not guard(lanes.events, which, state_at(theta, w, lane), p, mode):
        return True
    first = largest(values_at(QUANTITIES, 0.0, series))[0]
    return theta == 0.0 and first < -ON_AN_EVENT and first < (
        largest(values_at(QUANTITIES, _SOON, series))[0]
    )  # fmt: skip


@separate_kernel
def first_event(lanes, w, lane, series):
    """Return (which, θ) of the first event in the step; θ = ``NO_EVENT`` if there is none.

    ``series`` is overwritten, shape (QUANTITIES * TERMS,).
    """
    first, which_first = NO_EVENT, -1
    candidates = int(w[CANDIDATES, lane])
    while candidates != 0:
        which = lowest_bit(candidates)
        candidates &= candidates - 1
        theta = crossing(lanes, which, first, series, w, lane)
        if theta < first and not (
            is_conditional(lanes.events, which)
            and _is_refused(lanes, which, theta, series, w, lane)
        ):
            first, which_first = theta, which
    return which_first, first
