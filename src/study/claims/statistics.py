"""Statistics of a column: ratio, mean, median, share, slope, trend; and its division into lines.

Trend and quantile are not scipy's: it has no rank correlation with a resolution, and quantiles that
ignore NaN take it ten times as long on the few dozen points of a curve. Flags and columns are as in
``measures``, whose claims name every function of ``of``.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NAN = float("nan")
RESOLUTION = 0.005  # two values closer than this, relative to their median, count as equal


def ratio(first: float, second: float) -> float:
    """Return first / second, NaN for a second of 0."""
    return first / second if second != 0.0 else NAN


def asymmetry(first: float, second: float) -> float:
    """Return (first - second) / (|first| + |second|): from -1 to 1, 0 where they are equal.

    A positive number that is q times another differs from it by (q - 1) / (q + 1).
    """
    total = abs(first) + abs(second)
    return (first - second) / total if total != 0.0 else 0.0


def mean(values: Sequence[float]) -> float:
    """Return the mean of the known values."""
    known = [value for value in values if value == value]  # noqa: PLR0124  (NaN is not itself)
    return sum(known) / len(known) if known else NAN


def quantile(values: Array, share: float) -> float:
    """Return a quantile of at least one value, none of them NaN, in a tenth of numpy's time."""
    ordered = np.sort(values)
    place = share * (ordered.size - 1)
    low = int(place)
    high = min(low + 1, ordered.size - 1)
    return float(ordered[low] + (place - low) * (ordered[high] - ordered[low]))


def median(of: Array) -> float:
    """Return the median of the known values."""
    known = of[np.isfinite(of)]
    return quantile(known, 0.5) if known.size else NAN


def spread(of: Array) -> float:
    """Return the 95 % over the 5 % quantile of the known values."""
    known = of[np.isfinite(of)]
    return ratio(quantile(known, 0.95), quantile(known, 0.05)) if known.size else NAN


def share(of: Flags) -> float:
    """Return the share of the rows that are flagged."""
    return float(of.mean()) if of.size else NAN


def runs_of(of: Flags) -> list[tuple[int, int]]:
    """Return the unbroken runs of flagged rows, each as (first, one past the last)."""
    ends = np.flatnonzero(np.diff(np.concatenate([[0], of.astype(np.int8), [0]]))).tolist()
    return list(zip(ends[::2], ends[1::2], strict=True))


def stretch(of: Flags) -> float:
    """Return the longest unbroken run of flagged rows, over all rows."""
    return max((end - first for first, end in runs_of(of)), default=0) / of.size if of.size else NAN


def slope(of: Array, over: Array) -> float:
    """Return the median of the slopes between all pairs of points: no single jump decides it.

    It is the estimator of Theil and Sen; NaN with fewer than two known points.
    """
    known = np.isfinite(of)
    if known.sum() < 2:
        return NAN
    first, second = np.triu_indices(int(known.sum()), 1)
    x, y = over[known], of[known]
    return float(np.median((y[second] - y[first]) / (x[second] - x[first])))


def relative_slope(of: Array, over: Array) -> float:
    """Return the slope over the median."""
    return ratio(slope(of, over), median(of))


def trend(of: Array, over: Array) -> float:
    """Return the trend: 1 always rising, 0 none, -1 falling; NaN with fewer than two known points.

    Kendall's rank correlation: of all pairs of points, the share that rise less the share that
    fall. Pairs closer than ``RESOLUTION`` count as equal, and points with NaN are left out.
    """
    known = np.isfinite(of)
    if known.sum() < 2:
        return NAN
    x, y = over[known], of[known]
    rise = y[None, :] - y[:, None]
    signs = np.where(np.abs(rise) > RESOLUTION * abs(quantile(y, 0.5)), np.sign(rise), 0.0)
    return float((signs * np.sign(x[None, :] - x[:, None])).sum() / (x.size * (x.size - 1)))


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


def lines(by: Array, *columns: NDArray[Any]) -> Iterator[tuple[NDArray[Any], ...]]:
    """Return the columns of each curve or row, by rising value of ``by``."""
    order = np.argsort(by, kind="stable")
    ends = np.flatnonzero(np.diff(by[order])) + 1
    return zip(*(np.split(column[order], ends) for column in columns), strict=True)
