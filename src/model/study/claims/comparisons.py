"""Measures of several curves or figures together; importing this module registers them."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from model.study.claims.checks import Part, of_claim
from model.study.claims.measures import growth
from model.study.claims.reading import Curve, Data, MissingDataError
from model.study.claims.statistics import (
    NAN,
    Array,
    asymmetry,
    mean,
    median,
    ratio,
    slope,
    spread,
    trend,
)

Figures = Sequence[str]


def _spread_of_known(_values: Array, numbers: Array) -> float:
    return spread(numbers) if int(np.isfinite(numbers).sum()) >= 2 else NAN


_ACROSS: Mapping[str, Callable[[Array, Array], float]] = {
    "trend": trend,
    "spread": _spread_of_known,
}


@of_claim
def across(data: Data, figures: Figures, take: str, of: str = "tau", x: str = "any") -> list[Part]:
    """Trend or spread of a column over the family's values, mean over the swept values in ``x``."""
    curves = data.curves(figures[0])
    values = np.array([curve.value for curve in curves])
    grid = np.unique(np.concatenate([curve.x for curve in curves]))
    numbers = np.full((grid.size, values.size), NAN)
    for column, curve in enumerate(curves):
        kept = curve.within(x)
        numbers[np.searchsorted(grid, kept.x), column] = kept.column(of)
    return [Part("", mean([_ACROSS[take](values, row) for row in numbers]))]


@of_claim
def motion_of_tilted_part(data: Data, figures: Figures) -> list[Part]:
    """Trends of the tilt and of -y, averaged over an excitation period, over time."""
    course = data.course(figures[0])
    moments = np.arange(float(course.tilt.size))
    tilt = trend(moments, course.tilt - course.tilt[0])
    return [Part("φ", tilt), Part("-y", -trend(moments, course.y - course.y[0]))]


def _farthest(curve: Curve) -> float:
    moved = curve.column("excursion")
    return float(moved.max()) if moved.size else NAN


def _usual_way(data: Data) -> float:
    return median(np.concatenate([c.column("excursion") for c in data.curves("misaligned")]))


@of_claim
def way_without_asymmetry(data: Data, figures: Figures) -> list[Part]:
    """Farthest way from an upright start over the usual way in the runs "misaligned"."""
    return [Part("", ratio(_farthest(data.curves(figures[0], 0.0)[0]), _usual_way(data)))]


@of_claim
def decades_by_tilt(data: Data, figures: Figures) -> list[Part]:
    """Decades by which a tilt at the start lengthens the farthest way from an upright one."""
    still, tilted = (data.curves(figures[0], text) for text in (0.0, "> 0"))
    floor = 1e-12 * max(_usual_way(data), 1.0)
    least = max(_farthest(still[0]), floor)
    return [Part(c.name, float(np.log10(max(_farthest(c), floor) / least))) for c in tilted]


@of_claim
def reach_over_clearance(data: Data, figures: Figures) -> list[Part]:
    """Largest misalignment up to which every run aligns, over δa, of the best curve."""
    (name,) = figures
    clearance = data.held(name, "clearance") * data.held(name, "half_width")
    reached = []
    for curve in data.curves(name):
        failing = np.flatnonzero(~curve.aligned)
        last = curve.x[: failing[0]] if failing.size else curve.x
        reached.append(float(last[-1]) / clearance if last.size else 0.0)
    return [Part("", max(reached))]


@of_claim
def aligned_at(data: Data, figures: Figures, x: float) -> list[Part]:
    """1 where the point at ``x`` of a curve aligns, 0 where it does not."""
    points = [(curve, curve.within(x)) for curve in data.curves(figures[0])]
    parts = [Part(curve.name, float(at.aligned[0])) for curve, at in points if at.x.size]
    if not parts:
        raise MissingDataError(f"{figures[0]} has no regular point at {x:g}")
    return parts


@of_claim
def growth_by_family(data: Data, figures: Figures) -> list[Part]:
    """Largest over least growth of the duration along x, within the x at which all curves align."""
    curves = [c for c in data.curves(figures[0]) if c.aligned.any()]
    if len(curves) < 2:
        return [Part("", NAN)]
    common = min(float(c.x[c.aligned].max()) for c in curves)
    grown = np.array([growth(c.only(c.x <= common)) for c in curves])
    known = grown[np.isfinite(grown)]
    return [Part("", float(known.max() / known.min()) if known.size > 1 else NAN)]


@of_claim
def relative_slope_elsewhere(
    data: Data, figures: Figures, curves: str, x: str, than: Mapping[str, Mapping[str, str]]
) -> list[Part]:
    """Mean relative slope in ranges of curves and x less that in others, over their sum."""

    def slope_in(curves: str, x: str) -> float:
        return mean([_relative_slope(c.within(x)) for c in data.curves(figures[0], curves)])

    here = slope_in(curves, x)
    return [
        Part(f"than for {words}", asymmetry(here, slope_in(**there)))
        for words, there in than.items()
    ]


def _relative_slope(curve: Curve) -> float:
    return ratio(slope(curve.x, curve.tau), median(curve.tau))


@of_claim
def tilt_gained(data: Data, figures: Figures, curve: float, x: str, over: str) -> list[Part]:
    """Usual tilt gained until alignment in one range of x over that in another."""
    found, start = data.curves(figures[0], curve)[0], data.held(figures[0], "initial_tilt")
    stiff, first = (
        median(found.within(text).column("tilt_max", aligned=True)) - start for text in (x, over)
    )
    return [Part("", ratio(stiff, first))]


@of_claim
def spread_over_that_of(data: Data, figures: Figures, curve: float, curves: str) -> list[Part]:
    """Spread of each curve's durations over that of one curve on the same range of x."""
    (light,) = data.curves(figures[0], curve)
    parts = []
    for each in data.curves(figures[0], curves):
        reach = each.x[each.aligned]
        same = light.only((light.x >= reach[0]) & (light.x <= reach[-1])) if reach.size else light
        parts.append(Part(each.name, ratio(spread(each.tau), spread(same.tau))))
    return parts


@of_claim
def deepest_minimum(data: Data, figures: Figures) -> list[Part]:
    """Lower flank above the minimum, over the minimum, of the curve where that is largest."""
    dips = [(_dip(c), c) for c in data.curves(figures[0])]
    known = [(dip, curve) for dip, curve in dips if not math.isnan(dip)]
    if not known:
        return [Part("", NAN)]
    dip, curve = max(known, key=lambda each: each[0])
    return [Part(f"at most, for {curve.name}", dip)]


def _dip(curve: Curve) -> float:
    tau = curve.tau[curve.aligned]
    if tau.size < 3:
        return NAN
    before, after = np.maximum.accumulate(tau), np.maximum.accumulate(tau[::-1])[::-1]
    return float((np.minimum(before, after) / tau).max() - 1.0)


@of_claim
def least_distance_in_shape(data: Data, figures: Figures) -> list[Part]:
    """Distance in shape of the two most similar curves, one of each of two figures."""
    first, second = figures
    pairs = [_shape_distance(a, b) for a in data.curves(first) for b in data.curves(second)]
    return [Part("", min((each for each in pairs if not math.isnan(each)), default=NAN))]


def _shape_distance(first: Curve, second: Curve) -> float:
    """Root mean square difference of two curves' logarithms, each less its median."""
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
