"""Measures of the ledger, as the settled list defines them once for all entries.

Curves are read at aligned points only, after a running median of three. A measure is NaN where
there is nothing to measure, which counts against the entry.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from study.claims.data import Array, Curve, Figure, Flags, MissingDataError

NAN = float("nan")
SEEN = 0.1  # smallest relative difference that is seen in print
FEWEST = 5  # aligned points of a curve that is judged, unless the paper names its value
_NOISE_OF_SPAN, _NOISE_OF_LARGEST = 0.1, 0.02  # e; the second is 1 mm on a print of 5 cm
_BLOCKS = 24  # along either side of a map, of whose edges rectangles are tried


@dataclass(frozen=True)
class Trace:
    """A quantity along the aligned points of a curve, smoothed.

    Attributes:
        at: value of the parameter by which curves differ.
        x: swept parameter, shape (n,), rising.
        y: the quantity, shape (n,).
        noise: movement up to which the curve is as good as level, e of the list.
    """

    at: float
    x: Array
    y: Array
    noise: float

    def between(self, low: float, high: float) -> "Trace":
        """Return the piece from ``low`` to ``high``, both included."""
        kept = (self.x >= low) & (self.x <= high)
        return Trace(self.at, self.x[kept], self.y[kept], self.noise)


def traces(figure: Figure, name: str = "tau_align") -> list[Trace]:
    """Return the traces of a quantity of all curves of a figure, by rising value."""
    raw = [(c.at, c.x[c.aligned], np.abs(c.result(name)[c.aligned])) for c in figure.curves]
    largest = max((float(y.max()) for _, _, y in raw if y.size), default=0.0)
    found = []
    for at, x, y in raw:
        smooth = ndimage.median_filter(y, 3, mode="nearest") if y.size else y
        span = float(np.ptp(smooth)) if y.size else 0.0
        noise = max(_NOISE_OF_SPAN * span, _NOISE_OF_LARGEST * largest)
        found.append(Trace(at, x, smooth, noise))
    return found


def judged(figure: Figure, name: str = "tau_align") -> list[Trace]:
    """Return the traces of the curves with enough aligned points.

    Raises:
        MissingDataError: fewer than half of the figure's curves have.
    """
    every = traces(figure, name)
    kept = [each for each in every if each.x.size >= FEWEST]
    if 2 * len(kept) < len(every):
        raise MissingDataError(
            f"{figure.name}: only {len(kept)} of {len(every)} curves have {FEWEST} aligned points"
        )
    return kept


def one(found: Iterable[Trace], at: float) -> Trace:
    """Return the trace of a curve by its value.

    Raises:
        MissingDataError: it is not there.
    """
    for each in found:
        if each.at == at:
            return each
    raise MissingDataError(f"there is no curve at {at:g}")


# --- Of one trace ---------------------------------------------------------------------------------


def change(trace: Trace, sign: float) -> float:
    """Return the end-to-end change over the smaller end, positive in the direction of ``sign``."""
    if trace.x.size < 2:
        return NAN
    first, last = trace.y[0], trace.y[-1]
    return float(sign * (last - first) / min(first, last))


def back(trace: Trace, sign: float) -> float:
    """Return the largest movement against ``sign`` from an earlier extreme, over the noise."""
    if trace.x.size < 2:
        return NAN
    along = sign * trace.y
    return float((np.maximum.accumulate(along) - along).max() / trace.noise)


def moves_in(trace: Trace, sign: float) -> bool:
    """Return whether a trace keeps to one direction: TREND of the list."""
    return change(trace, sign) >= SEEN and back(trace, sign) <= 1.0


def moves(trace: Trace) -> list[tuple[float, float, float]]:
    """Return the movements larger than the noise, each as (sign, x where it begins, and ends)."""
    found: list[tuple[float, float, float]] = []
    low = high = start = 0
    sign = 0.0
    for place in range(1, trace.x.size):
        y = trace.y[place]
        if sign >= 0.0 and y > trace.y[high]:
            high = place
        if sign <= 0.0 and y < trace.y[low]:
            low = place
        if sign >= 0.0 and trace.y[high] - y > trace.noise:
            if sign > 0.0:
                found.append((1.0, float(trace.x[start]), float(trace.x[high])))
            start, low, sign = high, place, -1.0
        elif sign <= 0.0 and y - trace.y[low] > trace.noise:
            if sign < 0.0:
                found.append((-1.0, float(trace.x[start]), float(trace.x[low])))
            start, high, sign = low, place, 1.0
    if sign:
        found.append((sign, float(trace.x[start]), float(trace.x[high if sign > 0.0 else low])))
    return found


def value_at(trace: Trace, x: float) -> float:
    """Return the value at ``x`` by linear interpolation; at the nearest point beyond the ends."""
    return float(np.interp(x, trace.x, trace.y)) if trace.x.size else NAN


def rise(trace: Trace, low: float, high: float) -> float:
    """Return the relative rise from ``low`` to ``high``: RISE of the list."""
    return value_at(trace, high) / value_at(trace, low) - 1.0


def slopes(trace: Trace, cut: float) -> float:
    """Return the mean slope below a cut over that above it: SLOPES of the list.

    Infinite if the trace rises below, and not above.
    """
    if trace.x.size < 2 or not trace.x[0] < cut < trace.x[-1]:
        return NAN
    middle = value_at(trace, cut)
    below = (middle - trace.y[0]) / (cut - trace.x[0])
    above = (trace.y[-1] - middle) / (trace.x[-1] - cut)
    if above <= 0.0:
        return float("inf") if below > 0.0 else NAN
    return float(below / above)


def line(trace: Trace) -> tuple[float, float]:
    """Return the slope of the fitted line, and the largest departure from it over the span."""
    slope, level = np.polyfit(trace.x, trace.y, 1)
    span = float(np.ptp(trace.y))
    departure = float(np.abs(trace.y - slope * trace.x - level).max())
    return float(slope), departure / span if span > 0.0 else NAN


def minimum(trace: Trace) -> tuple[float, float]:
    """Return where a trace is least, and how far the lower of its ends stands above, over it.

    The height is 0 if the least value is among the first or last two points.
    """
    if not trace.x.size:
        return NAN, NAN
    least = int(np.argmin(trace.y))
    inside = 2 <= least < trace.x.size - 2
    height = min(trace.y[0], trace.y[-1]) / trace.y[least] - 1.0 if inside else 0.0
    return float(trace.x[least]), float(height)


# --- Of several -----------------------------------------------------------------------------------


def share(flags: Iterable[bool] | Flags) -> float:
    """Return the share that is flagged."""
    found = np.asarray(list(flags), dtype=bool)
    return float(found.mean()) if found.size else NAN


def median(values: Sequence[float] | Array) -> float:
    """Return the median of the known values."""
    found = np.asarray(values, dtype=float)
    found = found[~np.isnan(found)]
    return float(np.median(found)) if found.size else NAN


def ratio(first: float, second: float) -> float:
    """Return first / second; infinite if only the first is positive."""
    if second > 0.0:
        return first / second
    return float("inf") if first > 0.0 else NAN


def general(found: Sequence[Trace], sign: float) -> tuple[float, float]:
    """Return the share of traces that move in a direction, and the most that one moves against it.

    The second is the end-to-end change of ``change``, the other way: GEN(TREND) of the list.
    """
    return share(moves_in(each, sign) for each in found), max(change(each, -sign) for each in found)


def width(curve: Curve) -> tuple[float, float]:
    """Return the length of the axis that aligns: at least, and at most.

    What the upper end of the axis cuts off may have any length; what the lower end cuts off goes
    down to 0 at most, since no swept parameter is negative.
    """
    aligned, x = curve.aligned, curve.x
    if not aligned.any():
        return 0.0, 0.0
    least = float(aligned.sum() * step_of(curve))
    below, above = x[0] if aligned[0] else 0.0, np.inf if aligned[-1] else 0.0
    return least, float(least + below + above)


def step_of(curve: Curve) -> float:
    """Return the step of the axis."""
    return median(np.diff(curve.x))


def order(wide: Sequence[Curve], narrow: Sequence[Curve]) -> float:
    """Return the share of pairs whose first is wider by more than a step: ORDER of the list.

    Pairs that are left open by what the axis cuts off do not count.

    Raises:
        MissingDataError: half of the pairs are open.
    """
    pairs = [_wider(a, b) for a, b in product(wide, narrow)]
    closed = [each for each in pairs if each is not None]
    if 2 * len(closed) <= len(pairs):
        raise MissingDataError("the axis cuts off the widths that are to be compared")
    return share(closed)


def _wider(one: Curve, other: Curve) -> bool | None:
    """Return whether a curve is wider than another; None if that is open."""
    (least, most), (at_least, at_most), step = width(one), width(other), step_of(one)
    if least > at_most + step:
        return True
    return False if most <= at_least + step else None


# --- Of a map -------------------------------------------------------------------------------------


def edge_shift(lines: Sequence[Curve], end: Callable[[Array], float]) -> float:
    """Return by how much an edge of the aligned values differs between lines: SHIFT of the list.

    The 90 % less the 10 % quantile of ``end`` (min or max) of each, over the length of the axis.
    """
    ends = [end(each.x[each.aligned]) for each in lines if each.aligned.any()]
    length = max((float(np.ptp(each.x)) for each in lines if each.x.size), default=0.0)
    return float(np.subtract(*np.percentile(ends, [90, 10])) / length) if ends else NAN


def largest_area(cells: NDArray[np.int8]) -> tuple[float, float]:
    """Return the share of aligned cells in the largest connected area, and its share of holes.

    Sensitive cells connect areas and are not counted; a hole is a failure that it encloses.
    """
    areas, number = ndimage.label(cells != 0)
    sizes = np.bincount(areas[cells == 1], minlength=number + 1)
    if not sizes.any():
        return NAN, NAN
    area = areas == int(np.argmax(sizes))
    holes = ndimage.binary_fill_holes(area) & (cells == 0)
    return float(sizes.max() / sizes.sum()), float(holes.sum() / sizes.max())


def fast_rectangle(cells: NDArray[np.int8], tau: Array, least: float) -> float:
    """Return how fast the best rectangle is in which all align, of at least a share of the cells.

    It is the share of its cells that are no slower than the usual aligned cell, so that the
    rectangle's median is no larger from one half on; NaN without a rectangle. Its edges are those
    of ``_BLOCKS`` blocks along either side.
    """
    if not (cells == 1).any():
        return NAN
    is_fast = (cells == 1) & (tau <= np.median(tau[cells == 1]))
    # Sums over all cells below and to the left of each edge.
    edges = [
        np.unique(np.linspace(0, n, min(_BLOCKS, n) + 1).round().astype(int)) for n in cells.shape
    ]
    failed, fast, there = (
        np.pad(flags.astype(int).cumsum(0).cumsum(1), ((1, 0), (1, 0)))[np.ix_(*edges)]
        for flags in (cells == 0, is_fast, cells == 1)
    )
    (y0, y1), (x0, x1) = (np.triu_indices(each.size, 1) for each in edges)

    def inside(sums: NDArray[np.int_]) -> NDArray[np.int_]:
        return (sums[y1][:, x1] - sums[y0][:, x1] - sums[y1][:, x0] + sums[y0][:, x0])  # fmt: skip

    size = np.outer(edges[0][y1] - edges[0][y0], edges[1][x1] - edges[1][x0])
    good = (inside(failed) == 0) & (size >= least * cells.size) & (inside(there) > 0)
    return float((inside(fast)[good] / inside(there)[good]).max()) if good.any() else NAN
