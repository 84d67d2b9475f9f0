"""Measures of claims: numbers computed from columns of tables, NaN where there is none.

``claims.yaml`` names a function that takes ``of``, and for each argument a column, or an expression
of columns; ``data`` says which there are. A column has the rows of a curve, of a figure or of
several, along a curve in rising order. Unknown durations are NaN. Arguments:

of: the column that is measured.
over: the column along which it is.
by: values by which curves, or the rows of a map, differ.
here, there: flags of two sets of rows.
beside: flags of the rows with which the others are compared.
"""

from collections.abc import Callable, Iterator, Mapping
from inspect import isfunction

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from model.study.claims.data import Column, MissingDataError
from model.study.claims.statistics import (
    NAN,
    Array,
    Flags,
    asymmetry,
    explained,
    mean,
    median,
    quantile,
    ratio,
    share,
    slope,
    spread,
    trend,
)

NO_WAY = 1e-12  # an excursion that is rounding
_MOMENTS = 200  # at which a history is sampled

# --- Of one curve, or of all rows -----------------------------------------------------------------


def smaller_share(of: Flags) -> float:
    """Return the share of the rows that are flagged, or that are not, whichever is smaller."""
    return min(share(of), 1.0 - share(of))


def strength_of_trend(of: Array, over: Array) -> float:
    """Return the absolute value of the trend."""
    return abs(trend(of, over))


def usual_ratio(of: Array, here: Flags, there: Flags) -> float:
    """Return the median here over the median there."""
    return ratio(median(of[here]), median(of[there]))


def steeper_here(of: Array, over: Array, here: Flags, there: Flags) -> float:
    """Return the ``asymmetry`` of the slopes here and there."""
    return asymmetry(slope(of[here], over[here]), slope(of[there], over[there]))


def _halves(of: Array, over: Array) -> tuple[tuple[Array, Array], ...]:
    """Return the known points in the lower and upper half of their range; the middle is in both."""
    x, y = over[np.isfinite(of)], of[np.isfinite(of)]
    middle = 0.5 * (x[0] + x[-1]) if x.size else NAN
    return (y[x <= middle], x[x <= middle]), (y[x >= middle], x[x >= middle])


def steeper_fall_at_first(of: Array, over: Array) -> float:
    """Return the ``asymmetry`` of the falls in the first and second half."""
    first, second = _halves(of, over)
    return asymmetry(-slope(*first), -slope(*second))


def longer_at_first(of: Array, over: Array) -> float:
    """Return the mean of the first fifth of the first half over the median of the second half."""
    (first, _), (second, _) = _halves(of, over)
    return ratio(
        float(first[: max(1, first.size // 5)].mean()) if first.size else NAN, median(second)
    )


def growth(of: Array) -> float:
    """Return the last known value over the first, NaN with fewer than two."""
    known = of[np.isfinite(of)]
    return ratio(float(known[-1]), float(known[0])) if known.size > 1 else NAN


def depth_of_minimum(of: Array) -> float:
    """Return the rise from a minimum to the lower of its two flanks, over the minimum: the most."""
    known = of[np.isfinite(of)]
    if known.size < 3:
        return NAN
    before, after = np.maximum.accumulate(known), np.maximum.accumulate(known[::-1])[::-1]
    return float((np.minimum(before, after) / known).max() - 1.0)


def bump(of: Array, over: Array, begins: Flags, width: float) -> float:
    """Return the relative size of a bump: a fall, a rise, and a second fall.

    The rise begins where ``begins`` is set and is at most ``width`` wide. The size is the least of
    the first fall, the rise and the second fall, over the value where the rise begins. All other
    rises along the curve are subtracted from the rise, so that a ragged curve has no bump.
    """
    known = np.isfinite(of)
    x, y = over[known], of[known]
    if x.size < 4:
        return NAN
    climbed = np.concatenate([[0.0], np.cumsum(np.maximum(np.diff(y), 0.0))])
    # Largest value up to each point, and least value from each point on.
    before, after = np.maximum.accumulate(y), np.minimum.accumulate(y[::-1])[::-1]
    first, last = np.meshgrid(np.arange(x.size), np.arange(x.size), indexing="ij")
    small = (last > first) & begins[known][first] & (x[last] - x[first] <= width)
    if not small.any():
        return NAN
    i, j = first[small], last[small]
    other = climbed[-1] - (climbed[j] - climbed[i])
    size = np.minimum.reduce([before[i] - y[i], y[j] - y[i] - other, y[j] - after[j]])
    return float((size / y[i]).max())


def place_of_least(of: Array, over: Array, times: float) -> float:
    """Return the median place of the values that are at most ``times`` the least."""
    if not np.isfinite(of).any():
        return NAN
    return quantile(over[of <= times * np.nanmin(of)], 0.5)


def reach(of: Flags, over: Array) -> float:
    """Return the last place up to which every row is flagged, 0 if the first is not."""
    flagged = over[np.logical_and.accumulate(of)]
    return float(flagged[-1]) if flagged.size else 0.0


def explained_by_line(of: Array, over: Array) -> float:
    """Return the share of the variance that a straight line explains."""
    return explained(np.array([np.ones(over.size), over]), of)


def explained_by_inverse(of: Array, over: Array) -> float:
    """Return the share of the variance that a multiple of 1 / ``over`` explains."""
    return explained(1.0 / over[None], of)


# --- Of several curves, or rows of a map ----------------------------------------------------------


def _lines(by: Array, *columns: Column) -> Iterator[tuple[Column, ...]]:
    """Return the columns of each curve or row, by rising value of ``by``."""
    order = np.argsort(by, kind="stable")
    ends = np.flatnonzero(np.diff(by[order])) + 1
    return zip(*(np.split(column[order], ends) for column in columns), strict=True)


def least_share(of: Flags, by: Array) -> float:
    """Return the share of the rows that are flagged, of the curve where it is least."""
    return min(share(flags) for (flags,) in _lines(by, of))


def mean_trend(of: Array, over: Array, by: Array) -> float:
    """Return the mean of the trends of the curves."""
    return mean([trend(*line) for line in _lines(by, of, over)])


def mean_spread(of: Array, by: Array) -> float:
    """Return the mean of the spreads of the curves with at least two known points."""
    return mean([spread(line) for (line,) in _lines(by, of) if np.isfinite(line).sum() > 1])


def ratio_of_growths(of: Array, over: Array, by: Array) -> float:
    """Return the largest growth of a curve over the least, up to the last place that all reach."""
    curves = [each for each in _lines(by, of, over) if np.isfinite(each[0]).any()]
    if len(curves) < 2:
        return NAN
    common = min(float(x[np.isfinite(y)].max()) for y, x in curves)
    grown = np.array([growth(y[x <= common]) for y, x in curves])
    known = grown[np.isfinite(grown)]
    return float(known.max() / known.min()) if known.size > 1 else NAN


def relatively_steeper_here(of: Array, over: Array, by: Array, here: Flags, there: Flags) -> float:
    """Return the ``asymmetry`` of the mean relative slopes of the curves here and there."""

    def slope_in(rows: Flags) -> float:
        curves = _lines(by[rows], of[rows], over[rows])
        return mean([ratio(slope(y, x), median(y)) for y, x in curves])

    return asymmetry(slope_in(here), slope_in(there))


# --- Beside other rows ----------------------------------------------------------------------------


def share_beside(of: Flags, by: Array, beside: Flags) -> float:
    """Return the share of the rows that are flagged, less the largest of the curves beside."""
    return share(of[~beside]) - max(share(each) for (each,) in _lines(by[beside], of[beside]))


def spread_beside(of: Array, over: Array, beside: Flags) -> float:
    """Return the spread of a curve over that of the curve beside it on the same range."""
    reached = over[np.isfinite(of) & ~beside]
    low, high = (reached[0], reached[-1]) if reached.size else (-np.inf, np.inf)
    same = beside & (over >= low) & (over <= high)
    return ratio(spread(of[~beside]), spread(of[same]))


def _largest(of: Array) -> float:
    return float(of.max()) if of.size else NAN


def farthest_beside(of: Array, beside: Flags) -> float:
    """Return the largest value over the usual one beside."""
    return ratio(_largest(of[~beside]), median(of[beside]))


def decades_beside(of: Array, beside: Flags) -> float:
    """Return the decades between the largest value and that beside; less than 1e-12 is none."""
    here, there = (np.maximum(_largest(of[rows]), NO_WAY) for rows in (~beside, beside))
    return float(np.log10(here / there))


def distance_in_shape(of: Array, over: Array, by: Array, beside: Flags) -> float:
    """Return the least distance in shape between a curve and one beside."""
    curves, others = ([*_lines(by[rows], of[rows], over[rows])] for rows in (~beside, beside))
    distances = [_apart(curve, other) for curve in curves for other in others]
    return min((each for each in distances if each == each), default=NAN)  # noqa: PLR0124  (not NaN)


def _apart(*curves: tuple[Array, ...]) -> float:
    """Return the RMS difference of the logarithms of two curves, each minus its median."""
    (y, x), (v, u) = ((of[np.isfinite(of)], over[np.isfinite(of)]) for of, over in curves)
    if min(x.size, u.size) < 2 or (low := max(x[0], u[0])) >= (high := min(x[-1], u[-1])):
        return NAN
    places = np.linspace(low, high, 30)
    logs = [np.log(np.interp(places, *curve)) for curve in ((x, y), (u, v))]
    distance = (logs[0] - np.median(logs[0])) - (logs[1] - np.median(logs[1]))
    return float(np.sqrt((distance**2).mean()))


# --- Of the cells of a map ------------------------------------------------------------------------
# Sensitive cells have no row in a table.


def _cells(of: Flags, over: Array, by: Array) -> tuple[NDArray[np.int8], Array, Array]:
    """Return the flags as cells, shape (y, x), -1 for a sensitive one; and the axes x and y."""
    (x, columns), (y, rows) = (np.unique(axis, return_inverse=True) for axis in (over, by))
    cells = np.full((y.size, x.size), -1, dtype=np.int8)
    cells[rows, columns] = of
    return cells, x, y


def _safe(cells: NDArray[np.int8], within: float) -> Flags:
    """Return flags of the cells around which no cell is known not to align, shape (y, x)."""
    sizes = [2 * max(1, round(within * (size - 1))) + 1 for size in cells.shape]
    return np.asarray(ndimage.minimum_filter((cells != 0).astype(np.int8), sizes) == 1)


def share_of_largest_area(of: Flags, over: Array, by: Array) -> float:
    """Return the share of the flagged cells that lie in the largest connected area.

    Sensitive cells connect areas and are not counted.
    """
    cells, _, _ = _cells(of, over, by)
    areas, number = ndimage.label(cells != 0)
    sizes = np.bincount(areas[cells == 1], minlength=number + 1)
    return float(sizes.max() / sizes.sum()) if of.any() else 0.0


def safe_share(of: Flags, over: Array, by: Array, within: float) -> float:
    """Return the share of the cells around which all align, ``within`` a share of both axes."""
    cells, _, _ = _cells(of, over, by)
    return share(_safe(cells, within))


def rows_with_safe_cells(of: Flags, over: Array, by: Array, within: float, until: float) -> float:
    """Return the share of the rows up to ``until`` with a cell around which all align."""
    cells, _, y = _cells(of, over, by)
    rows = _safe(cells, within)[y <= until]
    return float(rows.any(axis=1).mean()) if rows.size else NAN


def shift_of_last(of: Flags, over: Array, by: Array) -> float:
    """Return by how much the last flagged place differs between rows, over the length of the axis.

    Sensitive cells next to it may be flagged as well; of the differences that this allows, the
    least.
    """
    cells, x, _ = _cells(of, over, by)
    ends = []
    for row in cells:
        surely = np.flatnonzero(row == 1)
        if surely.size:
            after = np.flatnonzero(row[surely[-1] + 1 :] != -1)
            most = surely[-1] + after[0] if after.size else x.size - 1
            ends.append((x[surely[-1]], x[most]))
    if len(ends) < 2:
        return NAN
    apart = max(least for least, _ in ends) - min(most for _, most in ends)
    return max(0.0, float(apart) / float(np.ptp(x)))


# --- Of a history ---------------------------------------------------------------------------------


def _sampled(of: Array, time: Array) -> Array:
    """Return values at equidistant moments until the end, shape (200,), or (0,) without any."""
    if not time.size:
        return time
    if not time[-1] > 0.0:
        raise MissingDataError("the run of the history did not begin")
    return np.interp(np.linspace(0.0, time[-1], _MOMENTS), time, of)


def trend_over_time(of: Array, time: Array, frequency: Array) -> float:
    """Return the trend over time of the mean over an excitation period.

    Values are not averaged where a period is shorter than two of 200 moments, or longer than half
    of the history.
    """
    values = _sampled(of, time)
    if not values.size:
        return NAN
    period = 2.0 * np.pi / frequency[0] if frequency[0] > 0.0 else 0.0
    width = round(period / time[-1] * (_MOMENTS - 1))
    if 2 <= width <= _MOMENTS / 2:
        values = np.convolve(values, np.full(width, 1.0 / width), mode="valid")
    return trend(values - values[0], np.arange(float(values.size)))


def relative_deviation(of: Array, time: Array) -> float:
    """Return the standard deviation over time, over the mean."""
    values = _sampled(of, time)
    return float(values.std() / values.mean()) if values.sum() > 0.0 else NAN


def duration_of_fall(of: Array, time: Array) -> float:
    """Return the time from the last moment above half the mean until the end, over the whole."""
    values = _sampled(of, time)
    if not values.size:
        return NAN
    strong = time[of >= 0.5 * max(float(values.mean()), 1e-300)]
    return float((time[-1] - strong[-1]) / time[-1]) if strong.size else 1.0


MEASURES: Mapping[str, Callable[..., float]] = {
    name: each
    for name, each in tuple(vars().items())
    if isfunction(each) and each.__code__.co_varnames[:1] == ("of",) and not name.startswith("_")
}
