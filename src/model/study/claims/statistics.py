"""Statistics of point sets by which claims are measured; NaN is an unknown value.

``scipy.stats`` has no rank correlation with a resolution, and its NaN-aware quantiles cost ten
times these on the few dozen points of a curve.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NAN = float("nan")
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
