"""Numbers for claims, computed from one curve or one figure, and the statistics that they need.

``claims.yaml`` names a function of ``OF_CURVE`` or ``OF_FIGURE`` and states all its arguments but
the first. Ranges are texts such as "5 to 7" or "< 2"; see ``data.between``.

Trend and quantile are not scipy's: it has no rank correlation with a resolution, and quantiles that
ignore NaN take it ten times as long on the few dozen points of a curve.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from model.study.claims.data import NAN, Array, Curve, Data, MapGrid, Points, SampledRun, Where

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
        y: shape (n,), or (m, n) for the mean trend of the m rows; rows with fewer than two known
            points are left out.
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
    """Return the share of the variance of ``y`` that a linear combination of ``basis`` explains.

    0 where the mean alone explains more; NaN with fewer than k + 2 known points, or where ``y``
    does not vary.

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
    """Return a quantile of at least one value, none of them NaN, in a tenth of numpy's time."""
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
    """Return the 95 % over the 5 % quantile of the known values, NaN without any."""
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
    """Return the trend of a column over x, or its absolute value with ``strength``.

    With ``aligned`` only the aligning points count.
    """
    part = curve.within(within)
    value = trend(part.x, part.column(of, aligned))
    return abs(value) if strength else value


def usual_ratio(curve: Curve, of: str, among: Where, over: Where) -> float:
    """Return the median of a column over the points in ``among``, over that in ``over``."""
    values = curve.column(of)
    return ratio(median(values[curve.at(among)]), median(values[curve.at(over)]))


def steeper_rise(curve: Curve, within: str, than: str) -> float:
    """Return the ``asymmetry`` of the slope of the duration in one range and that in another."""
    first, second = curve.within(within), curve.within(than)
    return asymmetry(slope(first.x, first.tau), slope(second.x, second.tau))


def steeper_fall_at_first(curve: Curve) -> float:
    """Return the ``asymmetry`` of the fall of the duration in the first and second half."""
    first, second = curve.halves
    return asymmetry(-slope(first.x, first.tau), -slope(second.x, second.tau))


def longer_at_first(curve: Curve) -> float:
    """Return the mean duration of the first fifth of the first half over the second's median."""
    first, second = curve.halves
    start = float(first.tau[: max(1, first.tau.size // 5)].mean()) if first.tau.size else NAN
    return ratio(start, median(second.tau))


def growth(curve: Curve, within: str | float = "any") -> float:
    """Return the duration of the last aligning point in a range of x over that of the first."""
    part = curve.within(within)
    tau = part.tau[part.aligned]
    return ratio(float(tau[-1]), float(tau[0])) if tau.size > 1 else NAN


def bump(curve: Curve, begins: str, width: float) -> float:
    """Return the relative size of a bump in the duration: a fall, a rise, and a second fall.

    The rise begins in the range ``begins`` and is at most ``width`` wide. The size is the least of
    the first fall, the rise and the second fall, over the duration where the rise begins. All other
    rises along the curve are subtracted from the rise, so that a ragged curve has no bump.
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


def best(curve: Curve, reach: float) -> float:
    """Return the median x of the points whose duration is at most ``reach`` times the least."""
    if not curve.aligned.any():
        return NAN
    near = curve.aligned & (curve.tau <= reach * np.nanmin(curve.tau))
    return quantile(curve.x[near], 0.5)


# --- Of one figure ------------------------------------------------------------------------------


def usual(points: Points, of: str) -> float:
    """Return the median magnitude of a column over the runs that align."""
    return median(np.abs(points.column(of, aligned=True)))


def smaller_share(points: Points) -> float:
    """Return the share of the runs that align, or that do not, whichever is smaller."""
    aligned = points.share({"aligned": 1})
    return min(aligned, 1.0 - aligned)


def usual_delay(points: Points) -> float:
    """Return the median time between alignment and the corners inside, over the duration."""
    tau = points.tau[points.aligned]
    later = points.column("tau_corners_inside")[points.aligned] - tau
    known = np.isfinite(later) & (tau > 0.0)
    return median(np.abs(later[known]) / tau[known])


def largest_area(grid: MapGrid) -> float:
    """Return the share of the aligning cells that lie in the largest connected area.

    Sensitive cells connect areas and are not counted.
    """
    sure = grid.aligned & grid.regular
    areas, number = ndimage.label(grid.aligned | ~grid.regular)
    sizes = np.bincount(areas[sure], minlength=number + 1)
    return float(sizes.max() / sizes.sum()) if sure.any() else 0.0


def rows_with_safe_cells(grid: MapGrid, reach: float, until: float) -> float:
    """Return the share of the rows with y <= ``until`` that have a safe cell."""
    rows = grid.safe(reach)[grid.y <= until]
    return float(rows.any(axis=1).mean()) if rows.size else NAN


def trend_along_rows(grid: MapGrid) -> float:
    """Return the mean over the rows of the trend of the duration over x."""
    return trend(grid.x, np.where(grid.regular, grid.tau, NAN))


def shift_of_last_aligned(grid: MapGrid) -> float:
    """Return by how much the largest aligning x differs between rows, over the length of the axis.

    Sensitive cells next to it may align as well; of the differences that this allows, the least.
    """
    ends = []
    for aligned, regular in zip(grid.aligned, grid.regular, strict=True):
        surely = np.flatnonzero(aligned & regular)
        if surely.size:
            most = int(surely[-1])
            while most + 1 < grid.x.size and not regular[most + 1]:
                most += 1
            ends.append((grid.x[int(surely[-1])], grid.x[most]))
    if len(ends) < 2:
        return NAN
    apart = max(least for least, _ in ends) - min(most for _, most in ends)
    return max(0.0, float(apart) / float(np.ptp(grid.x)))


def trend_over_time(run: SampledRun, of: str) -> float:
    """Return the trend over time of a coordinate, averaged over an excitation period."""
    values: Array = getattr(run, of)
    return trend(np.arange(float(values.size)), values - values[0])


def relative_deviation_of_force(run: SampledRun) -> float:
    """Return the standard deviation of the contact force over its mean, until the part aligns."""
    mean_force = float(run.force.mean())
    return float(run.force.std() / mean_force) if mean_force > 0.0 else NAN


# --- By name ------------------------------------------------------------------------------------


def by_name(*numbers: Callable[..., Any]) -> dict[str, Callable[..., Any]]:
    """Return functions by their names."""
    return {number.__name__: number for number in numbers}


OF_CURVE: Mapping[str, Number] = {
    **by_name(
        trend_along, usual_ratio, steeper_rise, steeper_fall_at_first, longer_at_first, growth,
        bump, best,
    ),
    "share": Curve.share,
    "smaller_share_of_curve": smaller_share,
    "spread_along": lambda curve: spread(curve.tau),
    "slope_along": lambda curve: slope(curve.x, curve.tau),
    # Share of the variance along x that a straight line, or a multiple of 1/x, explains.
    "explained_by_line": lambda curve: explained(np.array([curve.x**0, curve.x]), curve.tau),
    "explained_by_inverse": lambda curve: explained(np.array([1.0 / curve.x]), curve.tau),
}  # fmt: skip
_OF_VIEW: Mapping[View, Mapping[str, Number]] = {
    Data.points: {"share_of_runs": Points.share, **by_name(usual, smaller_share, usual_delay)},
    # The share of the points that align, for the curve where it is least.
    Data.drawn: {
        "least_aligned": lambda curves: min(each.share({"aligned": 1}) for each in curves)
    },
    Data.map_grid: {
        "safe_share": lambda grid, reach: float(grid.safe(reach).mean()),
        **by_name(largest_area, rows_with_safe_cells, trend_along_rows, shift_of_last_aligned),
    },
    Data.sampled_run: {
        "fall_of_force": lambda run: run.fall if run.aligned else NAN,
        **by_name(trend_over_time, relative_deviation_of_force),
    },
}
# By name: the view of a dataset that the function takes, and the function.
OF_FIGURE: Mapping[str, tuple[View, Number]] = {
    name: (view, number) for view, numbers in _OF_VIEW.items() for name, number in numbers.items()
}
