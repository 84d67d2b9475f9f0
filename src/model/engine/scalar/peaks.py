"""Largest tilt and normal force inside a step, on its dense output."""

from model.compile.kernels import inlined_kernel, kernel
from model.engine.scalar.location import NODE_PLACES, NODES
from model.engine.scalar.step import interpolate
from model.events.event_functions import NEVER
from model.events.kernels import sample_into

_ITERATIONS = 20
_CLOSE = 1e-5  # last correction of a peak's place, in steps: the error left is of its square
_NEGLIGIBLE = 1e-7  # rise above the largest value so far that is not looked for, relative


_TILT = -1  # in place of the number of an event


@inlined_kernel
def _size(which, tilt, sample):
    """|tilt|, or the normal force of an event; it may be negative, and is 0 where there is none."""
    if which == _TILT:
        return abs(tilt)
    return sample[which] if sample[which] != NEVER else 0.0


@kernel
def _peak(
    events, which, known, left, middle, right, f_left, f_middle, f_right,
    time, h, y, dense, p, mode, scratch,
):  # fmt: skip
    """Maximum of a ``_size`` between two fractions of the step, on its dense output.

    Iterates parabolas through the three highest points, and gives up when they stay below the
    ``known`` value. The maximum returned is a value that the size has.
    """
    for _ in range(_ITERATIONS):
        d1, d2 = middle - left, right - middle
        rise, fall = (f_middle - f_left) / d1, (f_right - f_middle) / d2
        if not rise > fall:
            break
        slope = (rise * d2 + fall * d1) / (d1 + d2)
        move = 0.5 * slope * (d1 + d2) / (rise - fall)
        # A parabola through distant points is too low by less than it rises above the highest.
        highest = f_middle + slope * move
        if abs(move) <= _CLOSE or highest <= known * (1.0 + _NEGLIGIBLE):
            break
        theta = middle + move
        q = interpolate(theta, h, y, dense)
        sample_into(events, time + theta * h, q, p, mode, scratch)
        f = _size(which, q.tilt, scratch)
        at, value = (theta, f) if f <= f_middle else (middle, f_middle)
        if (theta < middle) == (f <= f_middle):
            left, f_left = at, value
        else:
            right, f_right = at, value
        middle, f_middle = (theta, f) if f > f_middle else (middle, f_middle)
    return f_middle


@kernel
def _highest(
    events, which, known, part, time, h, y, dense, p, mode, nodes, samples, scratch
):  # fmt: skip
    """The larger of a ``known`` value and the largest ``_size`` up to a ``part`` of a step."""
    lowest = highest = _size(which, nodes[0, 2], samples[0])
    for i in range(1, NODES):
        here = _size(which, nodes[i, 2], samples[i])
        lowest, highest = min(lowest, here), max(highest, here)
    known = max(known, highest)
    # A peak between samples rises above them by less than they differ.
    if not 2.0 * highest - lowest > known:
        return known
    for i in range(1, NODES - 1):
        left = _size(which, nodes[i - 1, 2], samples[i - 1])
        here = _size(which, nodes[i, 2], samples[i])
        right = _size(which, nodes[i + 1, 2], samples[i + 1])
        if left <= here >= right and 2.0 * here - min(left, right) > known:
            peak = _peak(
                events, which, known,
                part * NODE_PLACES[i - 1], part * NODE_PLACES[i], part * NODE_PLACES[i + 1],
                left, here, right, time, h, y, dense, p, mode, scratch,
            )  # fmt: skip
            known = max(known, peak)
    return known


@inlined_kernel
def largest_tilt(events, known, *step):
    """Return the largest |tilt| of a step, or the ``known`` one; NaN if that is NaN."""
    return _highest(events, _TILT, known, *step)


@inlined_kernel
def largest_force(events, number, known, *step):
    """Return the largest normal force of a step, the level of an event, or the ``known`` one."""
    if step[-2][0, number] == NEVER:
        return known
    return _highest(events, number, known, *step)
