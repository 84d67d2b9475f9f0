"""Largest tilt and normal forces inside the step of one lane.

Input: the lane's lines of the workspace after ``step_all``, and the largest values so far. Output:
the new largest values, for scheduling.py.
"""

from math import inf

from model.compile.kernels import inlined_kernel, kernel
from model.engine.event_search import line_at
from model.engine.series_layout import FRACTIONS, LINES, NODES, ORDER, SINES, TILT
from model.engine.step import curvature_bound
from model.engine.workspace import (
    COEFFICIENTS,
    STEP_LENGTH,
    VALUES,
)

_SUBINTERVAL = FRACTIONS[0]
_MOST_ITERATIONS = 40
_CLOSE = 1e-3  # last correction, in steps: the error left is of the order of its cube


@inlined_kernel
def _with_slope(line, sign, time, w, lane):
    """A line times ``sign`` at ``time`` after the step's start, and its first two derivatives."""
    value, slope, half = w[COEFFICIENTS + ORDER * LINES + line, lane], 0.0, 0.0
    for order in range(ORDER - 1, -1, -1):
        half = half * time + slope
        slope = slope * time + value
        value = value * time + w[COEFFICIENTS + order * LINES + line, lane]
    return sign * value, sign * slope, 2.0 * sign * half


@inlined_kernel
def _slopes(g):
    """Derivatives of a quantity at five equidistant nodes, by finite differences."""
    return (
        (-25.0 * g[0] + 48.0 * g[1] - 36.0 * g[2] + 16.0 * g[3] - 3.0 * g[4]) / 12.0,
        (-3.0 * g[0] - 10.0 * g[1] + 18.0 * g[2] - 6.0 * g[3] + g[4]) / 12.0,
        (g[0] - 8.0 * g[1] + 8.0 * g[3] - g[4]) / 12.0,
        (-g[0] + 6.0 * g[1] - 18.0 * g[2] + 10.0 * g[3] + 3.0 * g[4]) / 12.0,
        (3.0 * g[0] - 16.0 * g[1] + 36.0 * g[2] - 48.0 * g[3] + 25.0 * g[4]) / 12.0,
    )


@kernel
def _peak(line, sign, left, theta, right, w, lane):
    """Maximum of a line times ``sign`` between the fractions ``left`` and ``right`` of the step.

    -inf unless the line rises at ``left`` and falls at ``right``. Newton's iteration for the zero
    of the slope, from ``theta``; in place of a step that would leave the bracket, bisection.
    """
    length = w[STEP_LENGTH, lane]
    low, time, high = left * length, theta * length, right * length
    if not (
        _with_slope(line, sign, low, w, lane)[1] > 0.0 > _with_slope(line, sign, high, w, lane)[1]
    ):
        return -inf
    value = -inf
    for iteration in range(_MOST_ITERATIONS):
        value, slope, second = _with_slope(line, sign, time, w, lane)
        low, high = (time, high) if slope > 0.0 else (low, time)
        further = time - slope / second if second != 0.0 else inf
        is_inside = second < 0.0 and low <= further <= high
        if is_inside and iteration > 0 and abs(further - time) <= _CLOSE * length:
            return value - 0.5 * slope * slope / second
        time = further if is_inside else 0.5 * (low + high)
    return value


@kernel
def _highest(line, sign, until, known, w, lane):
    """The larger of a ``known`` value and the maximum of a line times ``sign`` before ``until``."""
    bound = curvature_bound(line, w, lane)
    g = tuple(sign * w[VALUES + node * SINES + line, lane] for node in range(NODES))
    if max(max(g[0], g[1]), max(max(g[2], g[3]), g[4])) + bound <= known:
        return known
    highest = max(known, g[0])
    for n in range(1, NODES):
        if n * _SUBINTERVAL <= until:
            highest = max(highest, g[n])
    if until < 1.0:
        highest = max(highest, sign * line_at(line, until, w, lane))
    slope = _slopes(g)
    for n in range(1, NODES):
        left, share = (n - 1) * _SUBINTERVAL, 0.5
        if left < until and max(g[n - 1], g[n]) + bound > highest:
            if slope[n - 1] > 0.0 > slope[n]:
                share = slope[n - 1] / (slope[n - 1] - slope[n])
            theta, right = (n - 1 + share) * _SUBINTERVAL, min(n * _SUBINTERVAL, until)
            highest = max(highest, _peak(line, sign, left, min(theta, right), right, w, lane))
    return highest


@inlined_kernel
def largest_tilt(known, until, w, lane):
    """Return the largest |tilt| up to the fraction ``until`` of the step, or the ``known`` one."""
    return _highest(TILT, -1.0, until, _highest(TILT, 1.0, until, known, w, lane), w, lane)


@inlined_kernel
def largest_force(line, known, until, w, lane):
    """Return the largest force in a line up to the fraction ``until``, or the ``known`` one."""
    return _highest(line, 1.0, until, known, w, lane)
