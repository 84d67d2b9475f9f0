"""The measures of claims: functions that the table names, each with its arguments.

Ranges are texts such as "5 to 7" or "< 2"; see ``reading.between``.
"""

from collections.abc import Sequence

import numpy as np

from model.study.claims.checks import of_curve, of_figure
from model.study.claims.reading import Course, Curve, Data, Plane, Points, Where
from model.study.claims.statistics import (
    NAN,
    Array,
    asymmetry,
    explained,
    median,
    quantile,
    ratio,
    slope,
    spread,
    trend,
)

# --- Of one curve -------------------------------------------------------------------------------


@of_curve
def trend_along(
    curve: Curve,
    of: str = "tau",
    within: str | float = "any",
    aligned: bool = False,
    strength: bool = False,
) -> float:
    """Trend of a column over x, of aligning points only with ``aligned``, or its absolute value."""
    part = curve.within(within)
    found = trend(part.x, part.column(of, aligned))
    return abs(found) if strength else found


@of_curve
def share(curve: Curve, of: Where, among: Where | None = None) -> float:
    """Share of the points in ``among`` that lie in ``of``."""
    return curve.share(of, among or {})


@of_curve
def share_not_aligned(curve: Curve, among: Where) -> float:
    """Share of the points in ``among`` that do not align."""
    return 1.0 - curve.share({"aligned": 1}, among)


@of_curve
def smaller_share_of_curve(curve: Curve) -> float:
    """Share of the points that align, or that do not, whichever is smaller."""
    return _smaller_share(curve)


@of_curve
def usual_ratio(curve: Curve, of: str, among: Where, over: Where) -> float:
    """Median of a column among some points over that among others."""
    values = curve.column(of)
    return ratio(median(values[curve.at(among)]), median(values[curve.at(over)]))


@of_curve
def spread_along(curve: Curve) -> float:
    """Longest over shortest duration, without the outermost twentieths."""
    return spread(curve.tau)


@of_curve
def slope_along(curve: Curve) -> float:
    """Slope of the duration over x."""
    return slope(curve.x, curve.tau)


@of_curve
def steeper_rise(curve: Curve, within: str, than: str) -> float:
    """Slope of the duration in one range less that in another, over their sum."""
    first, second = curve.within(within), curve.within(than)
    return asymmetry(slope(first.x, first.tau), slope(second.x, second.tau))


@of_curve
def steeper_fall_at_first(curve: Curve) -> float:
    """Fall of the duration in the first half of the aligning range less that in the second."""
    first, second = curve.halves
    return asymmetry(-slope(first.x, first.tau), -slope(second.x, second.tau))


@of_curve
def longer_at_first(curve: Curve) -> float:
    """Duration where alignment begins over the usual one in the second half of the range."""
    first, second = curve.halves
    start = float(first.tau[: max(1, first.tau.size // 5)].mean()) if first.tau.size else NAN
    return ratio(start, median(second.tau))


@of_curve
def growth(curve: Curve, within: str | float = "any") -> float:
    """Duration at the largest x of a range that aligns over that at the least."""
    part = curve.within(within)
    tau = part.tau[part.aligned]
    return ratio(float(tau[-1]), float(tau[0])) if tau.size > 1 else NAN


@of_curve
def bump(curve: Curve, begins: str, width: float) -> float:
    """Clearness of a fall, a rise within ``width`` from a point in ``begins`` on, and a fall.

    The least of the first fall, the rise and the second fall, over the duration where the rise
    begins; what else rises along the curve is taken off the rise, so that a ragged curve has none.
    """
    kept = curve.only(curve.aligned)
    x, tau = kept.x, kept.tau
    if x.size < 4:
        return NAN
    rises = np.maximum(np.diff(tau), 0.0)
    climbed = np.concatenate([[0.0], np.cumsum(rises)])
    before, after = _flanks(tau)
    first, last = np.meshgrid(np.arange(x.size), np.arange(x.size), indexing="ij")
    small = (last > first) & kept.at({"x": begins})[first] & (x[last] - x[first] <= width)
    if not small.any():
        return NAN
    i, j = first[small], last[small]
    other = climbed[-1] - (climbed[j] - climbed[i])
    size = np.minimum.reduce([before[i] - tau[i], tau[j] - tau[i] - other, tau[j] - after[j]])
    return float((size / tau[i]).max())


def _flanks(tau: Array) -> tuple[Array, Array]:
    """Largest value up to each point, and least value from each point on."""
    return np.maximum.accumulate(tau), np.minimum.accumulate(tau[::-1])[::-1]


@of_curve
def explained_by_line(curve: Curve) -> float:
    """Share of the variance along x that a straight line explains."""
    return explained(np.array([np.ones(curve.x.size), curve.x]), curve.tau)


@of_curve
def explained_by_inverse(curve: Curve) -> float:
    """Share of the variance along x that a multiple of 1/x explains."""
    return explained(np.array([1.0 / curve.x]), curve.tau)


@of_curve
def best(curve: Curve, reach: float) -> float:
    """Middle of the x whose duration is within ``reach``, a factor, of the least."""
    if not curve.aligned.any():
        return NAN
    near = curve.aligned & (curve.tau <= reach * np.nanmin(curve.tau))
    return quantile(curve.x[near], 0.5)


# --- Of one figure ------------------------------------------------------------------------------


@of_figure(Data.points)
def share_of_runs(points: Points, of: Where, among: Where | None = None) -> float:
    """Share of the runs in ``among`` that lie in ``of``."""
    return points.share(of, among or {})


@of_figure(Data.points)
def usual(points: Points, of: str) -> float:
    """Median magnitude of a column over the runs that align."""
    return median(np.abs(points.column(of, aligned=True)))


@of_figure(Data.drawn)
def least_aligned(drawn: Sequence[Points]) -> float:
    """Share of the points that align, of the curve where it is least."""
    return min(points.share({"aligned": 1}, {}) for points in drawn)


@of_figure(Data.points)
def smaller_share(points: Points) -> float:
    """Share of the runs that align, or that do not, whichever is smaller."""
    return _smaller_share(points)


def _smaller_share(points: Points) -> float:
    aligned = points.share({"aligned": 1}, {})
    return min(aligned, 1.0 - aligned)


@of_figure(Data.points)
def usual_delay(points: Points) -> float:
    """Median time between alignment and the corners inside, over the duration."""
    tau = points.tau[points.aligned]
    later = points.column("tau_corners_inside")[points.aligned] - tau
    known = np.isfinite(later) & (tau > 0.0)
    return median(np.abs(later[known]) / tau[known])


@of_figure(Data.plane)
def largest_area(plane: Plane) -> float:
    """Share of the aligning cells in the largest connected area."""
    return plane.largest_area


@of_figure(Data.plane)
def safe_share(plane: Plane, reach: float) -> float:
    """Share of the cells around which all align within ``reach`` of the axes' lengths."""
    return float(plane.safe(reach).mean())


@of_figure(Data.plane)
def rows_with_safe_cells(plane: Plane, reach: float, until: float) -> float:
    """Share of the rows with y <= ``until`` that have a safe cell, as in ``safe_share``."""
    judged = plane.safe(reach)[plane.y <= until]
    return float(judged.any(axis=1).mean()) if judged.size else NAN


@of_figure(Data.plane)
def trend_along_rows(plane: Plane) -> float:
    """Trend of the duration over x, mean over the rows."""
    return trend(plane.x, np.where(plane.regular, plane.tau, NAN))


@of_figure(Data.plane)
def shift_of_last_aligned(plane: Plane) -> float:
    """Largest difference over the rows of the largest x that aligns, over the axis.

    Sensitive cells right above that x may align too: of the differences so possible, the least.
    """
    ends = []
    for aligned, regular in zip(plane.aligned, plane.regular, strict=True):
        surely = np.flatnonzero(aligned & regular)
        if surely.size:
            most = int(surely[-1])
            while most + 1 < plane.x.size and not regular[most + 1]:
                most += 1
            ends.append((plane.x[int(surely[-1])], plane.x[most]))
    if len(ends) < 2:
        return NAN
    apart = max(least for least, _ in ends) - min(most for _, most in ends)
    return max(0.0, float(apart) / float(np.ptp(plane.x)))


@of_figure(Data.course)
def trend_over_time(course: Course, of: str) -> float:
    """Trend of a coordinate, averaged over an excitation period, over time."""
    return _trend_over_time(course, of)


def _trend_over_time(course: Course, of: str) -> float:
    values: Array = getattr(course, of)
    return trend(np.arange(float(values.size)), values - values[0])


@of_figure(Data.course)
def relative_deviation_of_force(course: Course) -> float:
    """Standard deviation of the contact force over its mean, until the part aligns."""
    level = float(course.force.mean())
    return float(course.force.std() / level) if level > 0.0 else NAN


@of_figure(Data.course)
def fall_of_force(course: Course) -> float:
    """Time from the last moment with half the mean force until alignment, over the duration."""
    return course.fall if course.aligned else NAN
