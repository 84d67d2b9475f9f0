"""Where, inside a step, a switching function first falls through zero.

The step's dense output is sampled at its quarters, and close to its ends, where the slope is
wanted. A sign change between two samples brackets a switch; a sampled minimum that could hide a
double crossing is followed down. The switch is first found on the dense output; the loop then
repeats the step up to it, so that the switched state has the step's full order.
"""

import numpy as np

from model.physics.compiled import inlined_kernel, kernel
from model.solver.step import interpolate, keep_in
from model.solver.switching import (
    COMBINED_COUNT,
    NEVER,
    ON_A_SWITCH,
    SWITCH_COUNT,
    is_wall,
    switching_functions,
)

NODE_PLACES = np.array([0.0, 1 / 64, 1 / 4, 1 / 2, 3 / 4, 63 / 64, 1.0])  # fractions of the step
NODES = len(NODE_PLACES)
NO_SWITCH = 2.0  # a fraction of the step beyond its end

_ROOT_ITERATIONS = 60
_DIP_ITERATIONS = 12
_HALVINGS = 30


@inlined_kernel
def sample_step(time, h, y, dense, p, mode, nodes, samples):
    """Sample the step at ``NODE_PLACES``.

    Fills ``nodes``, shape (NODES, 6), with states and ``samples``, shape (NODES, SAMPLE_SIZE), with
    switching functions.
    """
    for i in range(NODES):
        q = interpolate(NODE_PLACES[i], h, y, dense)
        keep_in(q, nodes[i])
        switching_functions(time + NODE_PLACES[i] * h, q, p, mode, samples[i])


@kernel
def _value(which, theta, time, h, y, dense, p, mode, scratch):
    q = interpolate(theta, h, y, dense)
    switching_functions(time + theta * h, q, p, mode, scratch)
    return scratch[which]


@kernel
def _after_start(which, high, f_high, time, h, y, dense, p, mode, scratch):
    """A bracket (low, f, high, f) for a function that starts at zero, to rounding, and ends below.

    A mode often starts on a zero of its own functions. If the function rises first, its fall lies
    behind the rise; if it never does, the mode ends where it starts: the bracket is empty.
    """
    for _ in range(_HALVINGS):
        theta = 0.5 * high
        f = _value(which, theta, time, h, y, dense, p, mode, scratch)
        if f > 0.0:
            return theta, f, high, f_high
        high, f_high = theta, f
    return 0.0, 0.0, 0.0, 0.0


@kernel
def _root(which, low, f_low, high, f_high, time, h, y, dense, p, mode, scratch):
    """A root in [low, high] with f(low) >= 0 > f(high), by the Illinois variant of false position.

    The last step is a bisection's worth of safety: the bracket never opens.
    """
    last = 0
    for i in range(_ROOT_ITERATIONS):
        if high - low <= 1e-15 * high or f_low == 0.0:
            break
        theta = high - f_high * (high - low) / (f_high - f_low)
        if i % 3 == 2 or not low < theta < high:
            theta = 0.5 * (low + high)
        f = _value(which, theta, time, h, y, dense, p, mode, scratch)
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
def _dip(
    which, left, middle, right, f_left, f_middle, f_right, time, h, y, dense, p, mode, scratch
):
    """Follow a sampled minimum down: a place where f < 0, or ``NO_SWITCH``.

    Parabolas through the three lowest points; given up when they no longer point below zero.
    """
    for _ in range(_DIP_ITERATIONS):
        d1, d2 = middle - left, right - middle
        slope = ((f_middle - f_left) / d1 * d2 + (f_right - f_middle) / d2 * d1) / (d1 + d2)
        curvature = ((f_right - f_middle) / d2 - (f_middle - f_left) / d1) / (0.5 * (d1 + d2))
        if curvature <= 0.0:
            return NO_SWITCH
        move = -slope / curvature
        lowest = f_middle + 0.5 * slope * move
        if lowest > 0.5 * f_middle or abs(move) < 1e-9:
            return NO_SWITCH
        theta = min(max(middle + move, left + 0.05 * d1), right - 0.05 * d2)
        f = _value(which, theta, time, h, y, dense, p, mode, scratch)
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
    return NO_SWITCH


@kernel
def _instant(which, low, f_low, high, f_high, place, time, h, y, dense, p, mode, scratch):
    """Where a combined function is negative though it is not at either end: θ, or ``NO_SWITCH``.

    Its largest quantity is another at the two ends. Where it changes the function is lowest: the
    change is bisected from ``place``, the largest quantity's place at ``low``, and given up when
    twice the slope of neither side would reach zero in what is left of the bracket.
    """
    for _ in range(_HALVINGS):
        theta = 0.5 * (low + high)
        f = _value(which, theta, time, h, y, dense, p, mode, scratch)
        if f < 0.0:
            return theta
        if scratch[SWITCH_COUNT + which] == place:
            if f + 2.0 * min(f - f_low, 0.0) > 0.0:
                return NO_SWITCH
            low, f_low = theta, f
        else:
            if f - 2.0 * max(f_high - f, 0.0) > 0.0:
                return NO_SWITCH
            high, f_high = theta, f
    return NO_SWITCH


@inlined_kernel
def first_switch(time, h, y, dense, p, mode, samples, scratch):
    """(which, θ) of the earliest switch in the step; θ = ``NO_SWITCH`` if there is none.

    ``scratch``, shape (SAMPLE_SIZE,), is overwritten.
    """
    first, which_first = NO_SWITCH, -1
    for which in range(SWITCH_COUNT):
        if samples[0, which] == NEVER:
            continue
        for i in range(1, NODES):
            low, high = NODE_PLACES[i - 1], NODE_PLACES[i]
            if low >= first:
                break
            f_low, f_high = samples[i - 1, which], samples[i, which]
            if f_high < 0.0:
                if is_wall(which) and f_low < -ON_A_SWITCH and f_high > f_low:
                    continue
                if f_low <= 0.0:
                    low, f_low, high, f_high = _after_start(
                        which, high, f_high, time, h, y, dense, p, mode, scratch
                    )
                theta = _root(which, low, f_low, high, f_high, time, h, y, dense, p, mode, scratch)
                if theta < first:
                    first, which_first = theta, which
                break
            theta = NO_SWITCH
            place = samples[i - 1, SWITCH_COUNT + which] if which < COMBINED_COUNT else 0.0
            if which < COMBINED_COUNT and place != samples[i, SWITCH_COUNT + which]:
                theta = _instant(
                    which, low, f_low, high, f_high, place, time, h, y, dense, p, mode, scratch
                )
            elif i < NODES - 1 and f_high <= f_low and f_high <= samples[i + 1, which]:
                right, f_right = NODE_PLACES[i + 1], samples[i + 1, which]
                theta = _dip(
                    which, low, high, right, f_low, f_high, f_right,
                    time, h, y, dense, p, mode, scratch,
                )  # fmt: skip
            if theta != NO_SWITCH:
                f = _value(which, theta, time, h, y, dense, p, mode, scratch)
                if f_low > 0.0:
                    theta = _root(which, low, f_low, theta, f, time, h, y, dense, p, mode, scratch)
                if theta < first:
                    first, which_first = theta, which
                break
    return which_first, first
