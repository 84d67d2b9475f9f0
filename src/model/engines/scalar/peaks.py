"""Largest tilt and normal force inside a step, on its dense output."""

from model.compile.kernels import inlined_kernel, kernel
from model.engines.scalar.location import NODE_PLACES, NODES
from model.engines.scalar.step import interpolate
from model.events.kernels import force_on, sample_into

_ITERATIONS = 20
_CLOSE = 1e-5  # last correction of a peak's place, in steps: the error left is of its square
_NEGLIGIBLE = 1e-7  # rise above the largest value so far that is not looked for, relative


@inlined_kernel
def _sizes(events, tilt, sample):
    """|tilt|, and the normal forces on support, left and right side; forces may be negative."""
    support, side = force_on(events, "support", sample), force_on(events, "side", sample)
    return abs(tilt), support, side, force_on(events, "right", sample)


@kernel
def _peak(
    events, which, known, left, middle, right, f_left, f_middle, f_right,
    time, h, y, dense, p, mode, scratch,
):  # fmt: skip
    """Maximum of one of the ``_sizes`` between two fractions of the step, on its dense output.

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
        f = _sizes(events, q.tilt, scratch)[which]
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
    """The larger of a ``known`` value and the peaks of one of the ``_sizes`` at inner nodes."""
    for i in range(1, NODES - 1):
        left = _sizes(events, nodes[i - 1, 2], samples[i - 1])[which]
        here = _sizes(events, nodes[i, 2], samples[i])[which]
        right = _sizes(events, nodes[i + 1, 2], samples[i + 1])[which]
        if left <= here >= right and 2.0 * here - min(left, right) > known:
            peak = _peak(
                events, which, known,
                part * NODE_PLACES[i - 1], part * NODE_PLACES[i], part * NODE_PLACES[i + 1],
                left, here, right, time, h, y, dense, p, mode, scratch,
            )  # fmt: skip
            known = max(known, peak)
    return known


@kernel
def largest_in(
    events, part, time, h, y, dense, p, mode, nodes, samples, scratch, tilt, force
):  # fmt: skip
    """(largest |tilt|, largest normal force) of a step up to its fraction ``part``, and so far.

    ``tilt`` and ``force`` are the largest values so far; NaN if they are not computed.
    """
    t, a, b, c = _sizes(events, nodes[0, 2], samples[0])
    t_low, a_low, b_low, c_low = t, a, b, c
    for i in range(1, NODES):
        here = _sizes(events, nodes[i, 2], samples[i])
        t, a, b, c = max(t, here[0]), max(a, here[1]), max(b, here[2]), max(c, here[3])
        t_low, a_low = min(t_low, here[0]), min(a_low, here[1])
        b_low, c_low = min(b_low, here[2]), min(c_low, here[3])
    rest = part, time, h, y, dense, p, mode, nodes, samples, scratch
    tilt, force = max(tilt, t), max(force, max(a, max(b, c)))
    # A peak between samples rises above them by less than they differ.
    if 2.0 * t - t_low > tilt:
        tilt = _highest(events, 0, tilt, *rest)
    if 2.0 * a - a_low > force:
        force = _highest(events, 1, force, *rest)
    if 2.0 * b - b_low > force:
        force = _highest(events, 2, force, *rest)
    if 2.0 * c - c_low > force:
        force = _highest(events, 3, force, *rest)
    return tilt, force
