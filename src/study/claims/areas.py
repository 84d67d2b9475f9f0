"""Measures of flags over two axes: families of curves, and planes. Arguments as in ``measures``.

Sensitive runs have no row in a table, so that they neither are flagged nor break an unbroken run.
"""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from study.claims.statistics import (
    NAN,
    Array,
    Flags,
    lines,
    median,
    quantile,
    ratio,
    runs_of,
    share,
    stretch,
)

# --- Of curves ------------------------------------------------------------------------------------


def smaller_share(of: Flags) -> float:
    """Return the share of the rows that are flagged, or that are not, whichever is smaller."""
    return min(share(of), 1.0 - share(of))


def limited_stretch(of: Flags) -> float:
    """Return the longest unbroken run of flagged rows, or the share of others if it is smaller."""
    return min(stretch(of), 1.0 - share(of))


def least_share(of: Flags, by: Array) -> float:
    """Return the share of the rows that are flagged, of the curve where it is least."""
    return min(share(flags) for (flags,) in lines(by, of))


def largest_difference(of: Flags, over: Array, by: Array) -> float:
    """Return the share of the places at which one of two curves is flagged, the most of a pair."""
    apart = []
    for (flags, x), (others, u) in combinations(lines(by, of, over), 2):
        _, mine, theirs = np.intersect1d(x, u, return_indices=True)
        apart.append(share(np.not_equal(flags[mine], others[theirs])))
    return max((each for each in apart if each == each), default=NAN)  # noqa: PLR0124  (not NaN)


def need_of_both(of: Flags, over: Array, by: Array) -> float:
    """Return the share of the rows on which a rule for one of two parameters alone is wrong.

    The rule for a value is what most rows with this value are; of the two rules the better counts.
    """
    wrong = [
        sum(min(int(line.sum()), int((~line).sum())) for (line,) in lines(axis, of))
        for axis in (over, by)
    ]
    return ratio(float(min(wrong)), float(of.size))


def usual_share_without(of: Flags, by: Array) -> float:
    """Return the share of the rows that are not flagged, of the usual curve with any that are."""
    return median(np.array([1.0 - share(line) for (line,) in lines(by, of) if line.any()]))


def wider(of: Flags, by: Array, beside: Flags) -> float:
    """Return by how much more of a curve is an unbroken run of flagged rows than of one beside.

    Of all pairs of a curve and one beside, the difference that nine in ten exceed.
    """
    here, there = (
        np.array([stretch(line) for (line,) in lines(by[rows], of[rows])])
        for rows in (~beside, beside)
    )
    apart = np.subtract.outer(here, there).ravel()
    return NAN if np.isnan(apart).any() else quantile(apart, 0.1)


# --- Of the cells of a map ------------------------------------------------------------------------


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


def safe_in_both(of: Flags, over: Array, by: Array, plane: Array, within: float) -> float:
    """Return the share of the places ``over`` with a cell in both planes around which all align."""
    planes = [_safe(_cells(*each)[0], within).any(axis=0) for each in lines(plane, of, over, by)]
    return share(np.asarray(np.all(planes, axis=0))) if len(planes) > 1 else NAN


def _last(of: Flags, over: Array) -> float:
    """Return where the last run ends that has a twentieth of the rows, and two; NaN without one."""
    ends = [end for first, end in runs_of(of) if end - first >= max(2.0, 0.05 * of.size)]
    return float(over[ends[-1] - 1]) if ends else NAN


def shift_of_peak(of: Flags, over: Array, by: Array) -> float:
    """Return by how much the end of the last flagged run differs between rows, over the axis.

    The 95 % less the 5 % quantile. A run has at least two cells, and a twentieth of a row: single
    cells decide nothing.
    """
    ends = np.array([_last(*line) for line in lines(by, of, over)])
    ends = ends[np.isfinite(ends)]
    if ends.size < 2:
        return NAN
    return (quantile(ends, 0.95) - quantile(ends, 0.05)) / float(np.ptp(over))


def share_with_peak(of: Flags, over: Array, by: Array) -> float:
    """Return the share of the rows with flagged cells that have none in the last twentieth."""
    if not of.any():
        return NAN
    last = over > over.max() - 0.05 * np.ptp(over)
    pairs = [each for each in lines(by, of, last) if each[0].any()]
    return share(np.array([not (line & end).any() for line, end in pairs]))
