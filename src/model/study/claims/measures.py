"""The numbers that claims name: of one curve, and of one figure.

``claims.yaml`` names a function of ``OF_CURVE`` or ``OF_FIGURE`` and states its arguments but the
first. Ranges are texts such as "5 to 7" or "< 2"; see ``data.between``. Numbers of several curves
or figures together are in ``comparisons``.

The statistics are their own: ``scipy.stats`` has no rank correlation with a resolution, and its
quantiles that leave NaN out cost ten times these on the few dozen points of a curve.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from model.study.claims.data import NAN, Array, Course, Curve, Data, Plane, Points, Where

Number = Callable[..., float]
View = Callable[[Data, str], Any]

# --- Statistics of points; NaN is an unknown value ----------------------------------------------

RESOLUTION = 0.005  # two values closer than this, relative to their median, count as equal


def trend(x: Array, y: Array) -> float:
    """Return the trend of ``y`` over ``x``: 1 always rising, 0 none, -1 falling; NaN if unknown.

    Kendall's rank correlation: of all pairs of points, the share that rise less the share that
    fall. Pairs closer than ``RESOLUTION`` count as equal, and points with NaN are left out.

    Args:
        x: shape (n,).
        y: shape (n,), or (m, n) for the mean over those of the m rows that have two points.
    """
    if y.ndim == 2:
        return mean([trend(x, row) for row in y])
    known = np.isfinite(y)
    if known.sum() < 2:
        return NAN
    x, y = x[known], y[known]
    rise = y[None, :] - y[:, None]
    signs = np.where(np.abs(rise) > RESOLUTION * abs(quantile(y, 0.5)), np.sign(rise), 0.0)
    return float((signs * np.sign(x[None, :] - x[:, None])).sum() / (x.size * (x.size - 1)))


def mean(values: Sequence[float]) -> float:
    """Return the mean of the known values, NaN without any."""
    known = [value for value in values if value == value]  # noqa: PLR0124  (NaN is not itself)
    return sum(known) / len(known) if known else NAN


def slope(x: Array, y: Array) -> float:
    """Return the slope of the least-squares line, NaN with fewer than two known points."""
    known = np.isfinite(y)
    if known.sum() < 2:
        return NAN
    x, y = x[known] - x[known].mean(), y[known]
    return float((x * y).sum() / (x * x).sum())


def explained(basis: Array, y: Array) -> float:
    """Return the share of the variance of ``y`` that a combination of ``basis`` explains.

    0 where the mean alone does better; NaN with fewer than k + 2 points, or where ``y`` does not
    vary.

    Args:
        basis: shape (k, n).
        y: shape (n,).
    """
    known = np.isfinite(y)
    if known.sum() < len(basis) + 2 or np.ptp(y[known]) == 0.0:
        return NAN
    matrix, y = basis[:, known].T, y[known]
    residual = y - matrix @ np.linalg.lstsq(matrix, y, rcond=None)[0]
    return max(0.0, float(1.0 - (residual**2).sum() / ((y - y.mean()) ** 2).sum()))


def quantile(values: Array, share: float) -> float:
    """Return numpy's quantile of values without NaN, at least one; a tenth of numpy's time."""
    ordered = np.sort(values)
    place = share * (ordered.size - 1)
    low = int(place)
    high = min(low + 1, ordered.size - 1)
    return float(ordered[low] + (place - low) * (ordered[high] - ordered[low]))


def median(values: Array) -> float:
    """Return the median of the known values, NaN without any."""
    known = values[np.isfinite(values)]
    return quantile(known, 0.5) if known.size else NAN


def spread(values: Array) -> float:
    """Return largest over least of the middle nine tenths of the known values; NaN: none."""
    known = values[np.isfinite(values)]
    if known.size == 0:
        return NAN
    return ratio(quantile(known, 0.95), quantile(known, 0.05))


def ratio(first: float, second: float) -> float:
    """Return first / second, NaN for a second of 0."""
    return first / second if second != 0.0 else NAN


def asymmetry(first: float, second: float) -> float:
    """Return (first - second) / (|first| + |second|): from -1 to 1, 0 where they are equal."""
    total = abs(first) + abs(second)
    return (first - second) / total if total != 0.0 else 0.0


# --- Of one curve -------------------------------------------------------------------------------


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


def share(curve: Curve, of: Where, among: Where | None = None) -> float:
    """Share of the points in ``among`` that lie in ``of``."""
    return curve.share(of, among)


def share_not_aligned(curve: Curve, among: Where) -> float:
    """Share of the points in ``among`` that do not align."""
    return 1.0 - curve.share({"aligned": 1}, among)


def smaller_share_of_curve(curve: Curve) -> float:
    """Share of the points that align, or that do not, whichever is smaller."""
    return smaller_share(curve)


def usual_ratio(curve: Curve, of: str, among: Where, over: Where) -> float:
    """Median of a column among some points over that among others."""
    values = curve.column(of)
    return ratio(median(values[curve.at(among)]), median(values[curve.at(over)]))


def spread_along(curve: Curve) -> float:
    """Longest over shortest duration, without the outermost twentieths."""
    return spread(curve.tau)


def slope_along(curve: Curve) -> float:
    """Slope of the duration over x."""
    return slope(curve.x, curve.tau)


def steeper_rise(curve: Curve, within: str, than: str) -> float:
    """Slope of the duration in one range less that in another, over their sum."""
    first, second = curve.within(within), curve.within(than)
    return asymmetry(slope(first.x, first.tau), slope(second.x, second.tau))


def steeper_fall_at_first(curve: Curve) -> float:
    """Fall of the duration in the first half of the aligning range less that in the second."""
    first, second = curve.halves
    return asymmetry(-slope(first.x, first.tau), -slope(second.x, second.tau))


def longer_at_first(curve: Curve) -> float:
    """Duration where alignment begins over the usual one in the second half of the range."""
    first, second = curve.halves
    start = float(first.tau[: max(1, first.tau.size // 5)].mean()) if first.tau.size else NAN
    return ratio(start, median(second.tau))


def growth(curve: Curve, within: str | float = "any") -> float:
    """Duration at the largest x of a range that aligns over that at the least."""
    part = curve.within(within)
    tau = part.tau[part.aligned]
    return ratio(float(tau[-1]), float(tau[0])) if tau.size > 1 else NAN


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
    # Largest value up to each point, and least value from each point on.
    before, after = np.maximum.accumulate(tau), np.minimum.accumulate(tau[::-1])[::-1]
    first, last = np.meshgrid(np.arange(x.size), np.arange(x.size), indexing="ij")
    small = (last > first) & kept.at({"x": begins})[first] & (x[last] - x[first] <= width)
    if not small.any():
        return NAN
    i, j = first[small], last[small]
    other = climbed[-1] - (climbed[j] - climbed[i])
    size = np.minimum.reduce([before[i] - tau[i], tau[j] - tau[i] - other, tau[j] - after[j]])
    return float((size / tau[i]).max())


def explained_by_line(curve: Curve) -> float:
    """Share of the variance along x that a straight line explains."""
    return explained(np.array([np.ones(curve.x.size), curve.x]), curve.tau)


def explained_by_inverse(curve: Curve) -> float:
    """Share of the variance along x that a multiple of 1/x explains."""
    return explained(np.array([1.0 / curve.x]), curve.tau)


def best(curve: Curve, reach: float) -> float:
    """Middle of the x whose duration is within ``reach``, a factor, of the least."""
    if not curve.aligned.any():
        return NAN
    near = curve.aligned & (curve.tau <= reach * np.nanmin(curve.tau))
    return quantile(curve.x[near], 0.5)


# --- Of one figure ------------------------------------------------------------------------------


def share_of_runs(points: Points, of: Where, among: Where | None = None) -> float:
    """Share of the runs in ``among`` that lie in ``of``."""
    return points.share(of, among)


def usual(points: Points, of: str) -> float:
    """Median magnitude of a column over the runs that align."""
    return median(np.abs(points.column(of, aligned=True)))


def least_aligned(drawn: Sequence[Points]) -> float:
    """Share of the points that align, of the curve where it is least."""
    return min(points.share({"aligned": 1}) for points in drawn)


def smaller_share(points: Points) -> float:
    """Share of the runs that align, or that do not, whichever is smaller."""
    aligned = points.share({"aligned": 1})
    return min(aligned, 1.0 - aligned)


def usual_delay(points: Points) -> float:
    """Median time between alignment and the corners inside, over the duration."""
    tau = points.tau[points.aligned]
    later = points.column("tau_corners_inside")[points.aligned] - tau
    known = np.isfinite(later) & (tau > 0.0)
    return median(np.abs(later[known]) / tau[known])


def largest_area(plane: Plane) -> float:
    """Share of the aligning cells in the largest connected area."""
    return plane.largest_area


def safe_share(plane: Plane, reach: float) -> float:
    """Share of the cells around which all align within ``reach`` of the axes' lengths."""
    return float(plane.safe(reach).mean())


def rows_with_safe_cells(plane: Plane, reach: float, until: float) -> float:
    """Share of the rows with y <= ``until`` that have a safe cell, as in ``safe_share``."""
    judged = plane.safe(reach)[plane.y <= until]
    return float(judged.any(axis=1).mean()) if judged.size else NAN


def trend_along_rows(plane: Plane) -> float:
    """Trend of the duration over x, mean over the rows."""
    return trend(plane.x, np.where(plane.regular, plane.tau, NAN))


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


def trend_over_time(course: Course, of: str) -> float:
    """Trend of a coordinate, averaged over an excitation period, over time."""
    values: Array = getattr(course, of)
    return trend(np.arange(float(values.size)), values - values[0])


def relative_deviation_of_force(course: Course) -> float:
    """Standard deviation of the contact force over its mean, until the part aligns."""
    level = float(course.force.mean())
    return float(course.force.std() / level) if level > 0.0 else NAN


def fall_of_force(course: Course) -> float:
    """Time from the last moment with half the mean force until alignment, over the duration."""
    return course.fall if course.aligned else NAN


# --- By name ------------------------------------------------------------------------------------

_CURVES = (
    trend_along, share, share_not_aligned, smaller_share_of_curve, usual_ratio, spread_along,
    slope_along, steeper_rise, steeper_fall_at_first, longer_at_first, growth, bump,
    explained_by_line, explained_by_inverse, best,
)  # fmt: skip
_FIGURES: Sequence[tuple[View, Sequence[Number]]] = (
    (Data.points, (share_of_runs, usual, smaller_share, usual_delay)),
    (Data.drawn, (least_aligned,)),
    (Data.plane, (largest_area, safe_share, rows_with_safe_cells, trend_along_rows,
                  shift_of_last_aligned)),
    (Data.course, (trend_over_time, relative_deviation_of_force, fall_of_force)),
)  # fmt: skip
OF_CURVE: Mapping[str, Number] = {number.__name__: number for number in _CURVES}
# Of each name: what the number takes of a figure's dataset, and the number.
OF_FIGURE: Mapping[str, tuple[View, Number]] = {
    number.__name__: (view, number) for view, numbers in _FIGURES for number in numbers
}
