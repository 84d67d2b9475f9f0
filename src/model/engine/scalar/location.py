"""Event location: the first down-crossing of a level inside a step.

Levels are sampled on the step's dense output, at its quarters and, for their slopes, near its ends.
A sign change between two samples brackets an event. A sampled minimum could hide a double crossing:
parabolas descend from it to the lowest point. The event is located on the dense output first; the
loop then repeats the step up to it, so that the state at the event has the full order of the
method.
"""

import numpy as np

from model.compile.kernels import inlined_kernel, kernel
from model.engine.scalar.step import interpolate, store_in
from model.events.event_functions import NEVER, ON_AN_EVENT, largest
from model.events.kernels import guard, is_conditional, level, quantities, sample_into

NODE_PLACES = np.array([0.0, 1 / 64, 1 / 4, 1 / 2, 3 / 4, 63 / 64, 1.0])  # fractions of the step
NODES = len(NODE_PLACES)
WHOLE = -1  # the level itself, not one of its quantities
NO_EVENT = 2.0  # a fraction of the step beyond its end

_ROOT_ITERATIONS = 60
_DIP_ITERATIONS = 12
_UNEVEN = 8.0  # ratio of the intervals beside a minimum above which they are uneven
_HALVINGS = 30  # of an interval, in search of the rise of a level that starts at zero
_STRETCHES = 4  # parts between two samples; in each, quantities are assumed monotonic


@inlined_kernel
def sample_step(events, time, h, until, y, dense, p, mode, nodes, samples):
    """Sample the step, or its part up to the fraction ``until``, at ``NODE_PLACES``.

    Fills ``nodes``, shape (NODES, 6), with states and ``samples``, shape (NODES, MOST_SAMPLES),
    with the levels of ``events``.
    """
    for i in range(NODES):
        theta = until * NODE_PLACES[i]
        q = interpolate(theta, h, y, dense)
        store_in(q, nodes[i])
        sample_into(events, time + theta * h, q, p, mode, samples[i])


@kernel
def _value(events, which, part, theta, time, h, y, dense, p, mode):
    """Level ``which`` at the fraction ``theta``; its quantity ``part`` if that is not WHOLE."""
    q = interpolate(theta, h, y, dense)
    if part != WHOLE:
        return quantities(events, which, time, q, p, mode)[part]
    return level(events, which, time + theta * h, q, p, mode)


@kernel
def _after_start(events, which, part, high, f_high, time, h, y, dense, p, mode):
    """Return the bracket (low, f, high, f) of the down-crossing of a level that starts at zero.

    A mode often starts at a zero of one of its own levels. If the level rises first, the bracket
    lies behind the rise. If it never rises, the mode ends where it starts: the bracket is empty.
    """
    for _ in range(_HALVINGS):
        theta = 0.5 * high
        f = _value(events, which, part, theta, time, h, y, dense, p, mode)
        if f > 0.0:
            return theta, f, high, f_high
        high, f_high = theta, f
    return 0.0, 0.0, 0.0, 0.0


@kernel
def _zero(events, which, part, low, f_low, high, f_high, time, h, y, dense, p, mode):
    """A root in [low, high] with f(low) >= 0 > f(high), by the Illinois variant of false position.

    If f(low) < 0 < f(high), both signs are reversed. Every third iteration bisects; the root stays
    bracketed.
    """
    if f_low == 0.0:
        return low
    sign = 1.0 if f_low > 0.0 else -1.0
    f_low, f_high = sign * f_low, sign * f_high
    last = 0
    for i in range(_ROOT_ITERATIONS):
        if high - low <= 1e-15 * high:
            break
        theta = high - f_high * (high - low) / (f_high - f_low)
        if i % 3 == 2 or not low < theta < high:
            theta = 0.5 * (low + high)
        f = sign * _value(events, which, part, theta, time, h, y, dense, p, mode)
        if f == 0.0:
            return theta
        if f < 0.0:
            high, f_high = theta, f
            if last == -1:
                f_low *= 0.5
            last = -1
        else:
            low, f_low = theta, f
            if last == 1:
                f_high *= 0.5
            last = 1
    return high


@kernel
def _dip(events, which, left, middle, right, f_left, f_middle, f_right, time, h, y, dense, p, mode):
    """Search near a sampled minimum for a place where f < 0; ``NO_EVENT`` if there is none.

    Iterates parabolas through the three lowest points and gives up when their minimum is not below
    zero. If the points are unevenly spaced, the far one is first moved nearer.
    """
    for _ in range(_DIP_ITERATIONS):
        d1, d2 = middle - left, right - middle
        even = max(d1, d2) <= _UNEVEN * min(d1, d2)
        slope = ((f_middle - f_left) / d1 * d2 + (f_right - f_middle) / d2 * d1) / (d1 + d2)
        curvature = ((f_right - f_middle) / d2 - (f_middle - f_left) / d1) / (0.5 * (d1 + d2))
        if curvature <= 0.0:
            return NO_EVENT
        move = -slope / curvature
        lowest = f_middle + 0.5 * slope * move
        if even and (lowest > 0.5 * f_middle or abs(move) < 1e-9):
            return NO_EVENT
        theta = min(max(middle + move, left + 0.05 * d1), right - 0.05 * d2)
        if not even:
            theta = middle + 2.0 * d1 if d1 < d2 else middle - 2.0 * d2
        f = _value(events, which, WHOLE, theta, time, h, y, dense, p, mode)
        if f < 0.0:
            return theta
        if theta < middle:
            if f < f_middle:
                right, f_right, middle, f_middle = middle, f_middle, theta, f
            else:
                left, f_left = theta, f
        elif f < f_middle:
            left, f_left, middle, f_middle = middle, f_middle, theta, f
        else:
            right, f_right = theta, f
    return NO_EVENT


@kernel
def _all_met(events, which, starting, low, before, high, after, time, h, y, dense, p, mode):
    """First place in [low, high] where all quantities of a level are negative, or ``NO_EVENT``.

    Each is assumed monotonic between its values ``before`` and ``after``: all are negative from the
    last root of a falling quantity to the first root of a rising one. ``starting`` is the index of
    the quantity that is zero when the mode begins, or WHOLE for none.
    """
    first, last = low, high
    for part in range(len(before)):
        g_low, g_high = before[part], after[part]
        if g_high > 0.0:
            if g_low > 0.0 or part == starting:
                return NO_EVENT
            theta = _zero(events, which, part, low, g_low, high, g_high, time, h, y, dense, p, mode)
            last = min(last, theta)
        elif g_low > 0.0 or part == starting:
            left, right = low, high
            if part == starting:
                left, g_low, right, g_high = _after_start(
                    events, which, part, right, g_high, time, h, y, dense, p, mode
                )
            theta = _zero(
                events, which, part, left, g_low, right, g_high, time, h, y, dense, p, mode
            )
            first = max(first, theta)
    return first if first < last else NO_EVENT


@kernel
def _brief_crossing(events, which, f_low, low, high, time, h, y, dense, p, mode):
    """First down-crossing of a level that may be negative only between two samples, or NO_EVENT.

    The level, the largest of several quantities, is not negative at either sample, or starts at
    zero. Another quantity is the largest at the second sample: all may be negative in between.
    """
    left, before = low, quantities(events, which, time, interpolate(low, h, y, dense), p, mode)
    for i in range(1, _STRETCHES + 1):
        right = low + (high - low) * i / _STRETCHES
        after = quantities(events, which, time, interpolate(right, h, y, dense), p, mode)
        starting = int(largest(before)[1]) if i == 1 and f_low <= 0.0 else WHOLE
        theta = _all_met(
            events, which, starting, left, before, right, after, time, h, y, dense, p, mode
        )
        if theta != NO_EVENT:
            return theta
        left, before = right, after
    return NO_EVENT


@inlined_kernel
def _down_crossing(events, i, which, time, h, y, dense, p, mode, samples):
    """Place of a down-crossing of level ``which`` between nodes ``i`` - 1 and ``i``, or NO_EVENT.

    From a sampled minimum at node ``i`` both sides are searched.
    """
    low, high = NODE_PLACES[i - 1], NODE_PLACES[i]
    f_low, f_high = samples[i - 1, which], samples[i, which]
    if f_low < -ON_AN_EVENT and (i > 1 or (is_conditional(events, which) and f_high > f_low)):
        return NO_EVENT  # negative since the mode began, or since a zero that its guard refused
    if f_low < -ON_AN_EVENT and which < events.combined:
        return low  # parts that overlap when the level begins to apply meet at once
    if f_high < 0.0:
        if f_low <= 0.0:
            low, f_low, high, f_high = _after_start(
                events, which, WHOLE, high, f_high, time, h, y, dense, p, mode
            )
        return _zero(events, which, WHOLE, low, f_low, high, f_high, time, h, y, dense, p, mode)
    turning = events.count + which
    if which < events.combined and samples[i - 1, turning] != samples[i, turning]:
        return _brief_crossing(events, which, f_low, low, high, time, h, y, dense, p, mode)
    if i == NODES - 1 or f_high > f_low or f_high > samples[i + 1, which]:
        return NO_EVENT
    theta = _dip(
        events, which, low, high, NODE_PLACES[i + 1], f_low, f_high, samples[i + 1, which],
        time, h, y, dense, p, mode,
    )  # fmt: skip
    if theta == NO_EVENT or f_low <= 0.0:
        return theta
    f = _value(events, which, WHOLE, theta, time, h, y, dense, p, mode)
    return _zero(events, which, WHOLE, low, f_low, theta, f, time, h, y, dense, p, mode)


@kernel
def _passes_guard(events, which, theta, h, y, dense, p, mode):
    """Return whether a zero of level ``which`` at θ is the event."""
    if not is_conditional(events, which):
        return True
    return guard(events, which, interpolate(theta, h, y, dense), p, mode)


@inlined_kernel
def first_event(events, time, h, y, dense, p, mode, samples):
    """Return (which, θ) of the earliest event in the step; θ = ``NO_EVENT`` if there is none."""
    first, which_first = NO_EVENT, -1
    for which in range(events.count):
        if samples[0, which] == NEVER:
            continue
        for i in range(1, NODES):
            if NODE_PLACES[i - 1] >= first:
                break
            theta = _down_crossing(events, i, which, time, h, y, dense, p, mode, samples)
            if theta == NO_EVENT:
                continue
            if _passes_guard(events, which, theta, h, y, dense, p, mode):
                if theta < first:
                    first, which_first = theta, which
                break
    return which_first, first
