"""Numbers for claims, computed from several curves or figures together.

``claims.yaml`` names a function of ``OF_CLAIM``, its figures, and its other arguments. A function
returns one number, or a number for each part of the claim by the part's name, such as "k_φ = 5".
"""

import math
from collections.abc import Callable, Mapping

import numpy as np

from model.study.claims.data import NAN, Array, Curve, Data, MissingDataError
from model.study.claims.measures import (
    asymmetry,
    by_name,
    growth,
    mean,
    median,
    ratio,
    slope,
    spread,
    trend,
    trend_over_time,
)

Parts = Mapping[str, float]


_ACROSS: Mapping[str, Callable[[Array, Array], float]] = {
    "trend": trend,
    "spread": lambda _, numbers: spread(numbers) if np.isfinite(numbers).sum() >= 2 else NAN,
}


def across(data: Data, figure: str, take: str, of: str = "tau", x: str = "any") -> float:
    """Return the trend or spread of a column over the family, averaged over the x in a range."""
    curves = data.curves(figure)
    values = np.array([curve.value for curve in curves])
    grid = np.unique(np.concatenate([curve.x for curve in curves]))
    numbers = np.full((grid.size, values.size), NAN)
    for column, curve in enumerate(curves):
        kept = curve.within(x)
        numbers[np.searchsorted(grid, kept.x), column] = kept.column(of)
    return mean([_ACROSS[take](values, row) for row in numbers])


def motion_of_tilted_part(data: Data, figure: str) -> Parts:
    """Return the trends over time of tilt and -y, averaged over an excitation period."""
    run = data.sampled_run(figure)
    return {"φ": trend_over_time(run, "tilt"), "-y": -trend_over_time(run, "y")}


def _farthest(curve: Curve) -> float:
    moved = curve.column("excursion")
    return float(moved.max()) if moved.size else NAN


def _usual_excursion(data: Data, figure: str) -> float:
    return median(np.concatenate([c.column("excursion") for c in data.curves(figure)]))


def way_without_asymmetry(data: Data, figure: str, other: str) -> float:
    """Return the largest excursion from an upright start over the median of another figure."""
    return ratio(_farthest(data.curves(figure, 0.0)[0]), _usual_excursion(data, other))


def decades_by_tilt(data: Data, figure: str) -> Parts:
    """Return by how many decades an initial tilt makes the largest excursion longer."""
    upright, tilted = (data.curves(figure, text) for text in (0.0, "> 0"))
    floor = 1e-12 * max(_usual_excursion(data, "misaligned"), 1.0)
    least = max(_farthest(upright[0]), floor)
    return {c.name: float(np.log10(max(_farthest(c), floor) / least)) for c in tilted}


def reach_over_clearance(data: Data, figure: str) -> float:
    """Return, for the best curve, the largest misalignment up to which all runs align, over δa."""
    clearance = data.held(figure, "clearance") * data.held(figure, "half_width")
    reached = []
    for curve in data.curves(figure):
        failing = np.flatnonzero(~curve.aligned)
        last = curve.x[: failing[0]] if failing.size else curve.x
        reached.append(float(last[-1]) / clearance if last.size else 0.0)
    return max(reached)


def aligned_at(data: Data, figure: str, x: float) -> Parts:
    """Return 1 for a curve whose point at ``x`` aligns, 0 for others."""
    points = [(curve, curve.within(x)) for curve in data.curves(figure)]
    parts = {curve.name: float(at.aligned[0]) for curve, at in points if at.x.size}
    if not parts:
        raise MissingDataError(f"{figure} has no regular point at {x:g}")
    return parts


def growth_by_family(data: Data, figure: str) -> float:
    """Return the largest growth of a curve over the least, up to the last x at which all align."""
    curves = [c for c in data.curves(figure) if c.aligned.any()]
    if len(curves) < 2:
        return NAN
    common = min(float(c.x[c.aligned].max()) for c in curves)
    grown = np.array([growth(c.only(c.x <= common)) for c in curves])
    known = grown[np.isfinite(grown)]
    return float(known.max() / known.min()) if known.size > 1 else NAN


def relative_slope_elsewhere(
    data: Data, figure: str, curves: str, x: str, than: Mapping[str, Mapping[str, str]]
) -> Parts:
    """Compare the mean relative slope in ranges of curves and x with that in others.

    Returns:
        the ``asymmetry`` of the two slopes, by the words for the other range.
    """

    def slope_in(curves: str, x: str) -> float:
        return mean([
            ratio(slope(part.x, part.tau), median(part.tau))
            for part in (curve.within(x) for curve in data.curves(figure, curves))
        ])  # fmt: skip

    here = slope_in(curves, x)
    return {
        f"than for {words}": asymmetry(here, slope_in(**there)) for words, there in than.items()
    }


def tilt_gained(data: Data, figure: str, curve: float, x: str, over: str) -> float:
    """Return the median tilt gained until alignment in one range of x over that in another."""
    points, start = data.curves(figure, curve)[0], data.held(figure, "initial_tilt")
    here, there = (
        median(points.within(text).column("tilt_max", aligned=True)) - start for text in (x, over)
    )
    return ratio(here, there)


def spread_over_that_of(data: Data, figure: str, curve: float, curves: str) -> Parts:
    """Return the spread of each curve's durations over that of one curve on the same range."""
    (light,) = data.curves(figure, curve)
    parts = {}
    for each in data.curves(figure, curves):
        reach = each.x[each.aligned]
        same = light.only((light.x >= reach[0]) & (light.x <= reach[-1])) if reach.size else light
        parts[each.name] = ratio(spread(each.tau), spread(same.tau))
    return parts


def deepest_minimum(data: Data, figure: str) -> Parts | float:
    """Return the depth of the deepest minimum of any curve.

    Depth is the rise from the minimum to the lower of its two flanks, over the minimum.
    """
    dips = [(_dip(c), c) for c in data.curves(figure)]
    known = [(dip, curve) for dip, curve in dips if not math.isnan(dip)]
    if not known:
        return NAN
    dip, curve = max(known, key=lambda each: each[0])
    return {f"at most, for {curve.name}": dip}


def _dip(curve: Curve) -> float:
    tau = curve.tau[curve.aligned]
    if tau.size < 3:
        return NAN
    before, after = np.maximum.accumulate(tau), np.maximum.accumulate(tau[::-1])[::-1]
    return float((np.minimum(before, after) / tau).max() - 1.0)


def least_distance_in_shape(data: Data, figure: str, other: str) -> float:
    """Return the least distance in shape between a curve of one figure and one of another."""
    pairs = [_shape_distance(a, b) for a in data.curves(figure) for b in data.curves(other)]
    return min((each for each in pairs if not math.isnan(each)), default=NAN)


def _shape_distance(first: Curve, second: Curve) -> float:
    """Return the RMS difference of the logarithms of two curves, each minus its median."""
    one, other = (c.only(c.aligned) for c in (first, second))
    if min(one.x.size, other.x.size) < 2:
        return NAN
    low, high = max(one.x[0], other.x[0]), min(one.x[-1], other.x[-1])
    if low >= high:
        return NAN
    x = np.linspace(low, high, 30)
    logs = [np.log(np.interp(x, c.x, c.tau)) for c in (one, other)]
    distance = (logs[0] - np.median(logs[0])) - (logs[1] - np.median(logs[1]))
    return float(np.sqrt((distance**2).mean()))


OF_CLAIM: Mapping[str, Callable[..., Parts | float]] = by_name(
    across, motion_of_tilted_part, way_without_asymmetry, decades_by_tilt, reach_over_clearance,
    aligned_at, growth_by_family, relative_slope_elsewhere, tilt_gained, spread_over_that_of,
    deepest_minimum, least_distance_in_shape,
)  # fmt: skip
