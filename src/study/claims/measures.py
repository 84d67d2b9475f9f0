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

from collections.abc import Callable, Mapping
from inspect import isfunction
from itertools import product

import numpy as np
from scipy import ndimage

from study.claims import areas
from study.claims.data import MissingDataError
from study.claims.statistics import (
    NAN,
    RESOLUTION,
    Array,
    Flags,
    asymmetry,
    explained,
    lines,
    mean,
    median,
    quantile,
    ratio,
    relative_slope,
    runs_of,
    share,
    slope,
    spread,
    trend,
)

_MOMENTS = 200  # at which a history is sampled

# --- Of one curve, or of all rows -----------------------------------------------------------------


def share_ratio(of: Flags, here: Flags, there: Flags) -> float:
    """Return the share that is flagged here over the share there."""
    return ratio(share(of[here]), share(of[there]))


def usual_ratio(of: Array, here: Flags, there: Flags) -> float:
    """Return the median here over the median there."""
    return ratio(median(of[here]), median(of[there]))


def usual_growth(of: Array, here: Flags, there: Flags) -> float:
    """Return the median here over the median there, NaN if a row between is unknown."""
    both = np.flatnonzero(here | there)
    known = both.size and np.isfinite(of[both[0] : both[-1] + 1]).all()
    return usual_ratio(of, here, there) if known else NAN


def usual_beyond(of: Array, here: Flags, there: Flags) -> float:
    """Return the median here over the value that 95 % there keep below."""
    known = of[there & np.isfinite(of)]
    return ratio(median(of[here]), quantile(known, 0.95)) if known.size else NAN


def steeper_here(of: Array, over: Array, here: Flags, there: Flags) -> float:
    """Return the ``asymmetry`` of the slopes here and there, -1 if the curve falls in either."""
    return _steeper((of[here], over[here]), (of[there], over[there]))


def _steeper(*pieces: tuple[Array, Array]) -> float:
    """Return the ``asymmetry`` of the slopes of two pieces of a curve, -1 if either falls.

    A fall within the resolution counts as level.
    """
    rises = [slope(*piece) for piece in pieces]
    falls = [
        x.size > 1 and rise * np.ptp(x) < -RESOLUTION * median(y)
        for rise, (y, x) in zip(rises, pieces, strict=True)
    ]
    return -1.0 if any(falls) else asymmetry(*rises)


def _halves(of: Array, over: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return the known points in the lower and upper half of their range; the middle is in both."""
    x, y = over[np.isfinite(of)], of[np.isfinite(of)]
    middle = 0.5 * (x[0] + x[-1]) if x.size else NAN
    return (y[x <= middle], x[x <= middle]), (y[x >= middle], x[x >= middle])


def steeper_fall_at_first(of: Array, over: Array) -> float:
    """Return the ``asymmetry`` of the falls in the first and second half, -1 if either rises."""
    first, second = _halves(of, -over)  # falls along the axis are rises against it
    return _steeper(second, first)


def bend(of: Array, over: Array) -> float:
    """Return the absolute ``asymmetry`` of the slopes of the two halves, -1 if it falls in one."""
    first, second = _halves(of, over)
    return max(_steeper(first, second), _steeper(second, first))


def longer_at_first(of: Array, over: Array) -> float:
    """Return the median of the first fifth of the first half over that of its last fifth."""
    (half, _), _ = _halves(of, over)
    fifth = max(1, half.size // 5)
    return ratio(median(half[:fifth]), median(half[-fifth:]))


def depth_of_minimum(of: Array) -> float:
    """Return the climb from the least value to the lower of its two sides, over the least value.

    Values are the running median over a twentieth of the curve, so that no odd row is a minimum.
    Of a climb no single step counts for more than half: a jump is no side of a minimum.
    """
    known = of[np.isfinite(of)]
    if known.size < 3:
        return NAN
    smooth = ndimage.median_filter(known, 2 * (known.size // 40) + 1, mode="nearest")
    least = int(np.argmin(smooth))
    climbs = []
    for side in (smooth[least::-1], smooth[least:]):
        steps = np.diff(side[: np.argmax(side) + 1])
        climbs.append(min(steps.sum(), 2.0 * (steps.sum() - steps.max(initial=0.0))))
    return float(min(climbs) / smooth[least])


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


def mean_trend(of: Array, over: Array, by: Array) -> float:
    """Return the mean of the trends of the curves."""
    return mean([trend(*line) for line in lines(by, of, over)])


def mean_spread(of: Array, by: Array) -> float:
    """Return the mean of the spreads of the curves with at least two known points."""
    return mean([spread(line) for (line,) in lines(by, of) if np.isfinite(line).sum() > 1])


def ratio_at_same(of: Array, by: Array, here: Flags, there: Flags) -> float:
    """Return the median over ``by`` of the median here over the median there."""
    return median(np.array([usual_ratio(*line) for line in lines(by, of, here, there)]))


def slopes_apart(of: Array, over: Array, by: Array) -> float:
    """Return the ``asymmetry`` of the largest and the least relative slope of the curves.

    Slopes are taken up to the last place that all curves reach which have known points.
    """
    curves = [each for each in lines(by, of, over) if np.isfinite(each[0]).any()]
    common = min((float(x[np.isfinite(y)].max()) for y, x in curves), default=NAN)
    slopes = np.array([relative_slope(y[x <= common], x[x <= common]) for y, x in curves])
    known = slopes[np.isfinite(slopes)]
    return asymmetry(float(known.max()), float(known.min())) if known.size > 1 else NAN


def relatively_steeper_here(of: Array, over: Array, by: Array, here: Flags, there: Flags) -> float:
    """Return the ``asymmetry`` of the least relative slope of a curve here and the mean there."""
    slopes, others = (
        [relative_slope(*line) for line in lines(by[rows], of[rows], over[rows])]
        for rows in (here, there)
    )
    return asymmetry(float(np.min(slopes)), mean(others))


def trend_of_spread(of: Array, over: Array, by: Array) -> float:
    """Return the trend over ``by`` of the spreads of curves, on the range that all reach."""
    curves = [each for each in lines(by, of, over, by) if np.isfinite(each[0]).any()]
    reached = [x[np.isfinite(y)][[0, -1]] for y, x, _ in curves]
    low = max((float(first) for first, _ in reached), default=NAN)
    high = min((float(last) for _, last in reached), default=NAN)
    spreads = [spread(y[(low <= x) & (x <= high)]) for y, x, _ in curves]
    return trend(np.array(spreads), np.array([at[0] for *_, at in curves])) if low < high else NAN


def cost_of_others_best(of: Array, over: Array, by: Array, times: float) -> float:
    """Return the least value at the best places of another curve, over the curve's own: the most.

    The best places are those of at most ``times`` the least value. Infinite if the curve has no
    known value there.
    """
    curves = [each for each in lines(by, of, over) if np.isfinite(each[0]).any()]
    best = [x[y <= times * np.nanmin(y)] for y, x in curves]
    costs = [
        np.fmin.reduce(y[np.isin(x, places)], initial=np.inf) / np.nanmin(y)
        for (y, x), places in product(curves, best)
    ]
    return float(max(costs)) if len(curves) > 1 else NAN


# --- Beside other rows ----------------------------------------------------------------------------


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


def distance_in_shape(of: Array, over: Array, by: Array, beside: Flags) -> float:
    """Return the least distance in shape between a curve and one beside.

    Of each curve counts the longest unbroken range of known values. Pairs that share less than an
    eighth of the range of ``over`` are left out.
    """
    curves, others = (
        [_longest(*line) for line in lines(by[rows], of[rows], over[rows])]
        for rows in (~beside, beside)
    )
    least = 0.125 * float(np.ptp(over[~beside])) if over[~beside].size else NAN
    distances = [_apart(curve, other, least) for curve in curves for other in others]
    return min((each for each in distances if each == each), default=NAN)  # noqa: PLR0124  (not NaN)


def _longest(of: Array, over: Array) -> tuple[Array, Array]:
    """Return the longest unbroken range of known values of a curve."""
    first, end = max(runs_of(np.isfinite(of)), key=lambda run: run[1] - run[0], default=(0, 0))
    return of[first:end], over[first:end]


def _apart(curve: tuple[Array, ...], other: tuple[Array, ...], least: float) -> float:
    """Return the RMS difference of the logarithms of two curves, each minus its median.

    NaN if they share less than ``least`` of the axis.
    """
    (y, x), (v, u) = curve, other
    if min(x.size, u.size) < 2:
        return NAN
    low, high = max(x[0], u[0]), min(x[-1], u[-1])
    if not high - low >= least > 0.0:
        return NAN
    places = np.linspace(low, high, 30)
    logs = [np.log(np.interp(places, *curve)) for curve in ((x, y), (u, v))]
    distance = (logs[0] - np.median(logs[0])) - (logs[1] - np.median(logs[1]))
    return float(np.sqrt((distance**2).mean()))


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
    for name, each in (vars(areas) | vars()).items()
    if isfunction(each) and each.__code__.co_varnames[:1] == ("of",) and not name.startswith("_")
}
