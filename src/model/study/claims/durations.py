"""Claims on durations over one parameter (Figs. 6, 7, 10, 11 and 12)."""

import math
from collections.abc import Callable, Iterable

import numpy as np

from model.study.claims.ledger import Check, Claim, Part, labelled
from model.study.claims.limits import (
    A_TENTH_MORE,
    A_TENTH_STEEPER,
    FALLS,
    RISES,
    SIGNIFICANT,
    VISIBLE,
    at_least,
    at_most,
)
from model.study.claims.reading import (
    NAN,
    Array,
    Curve,
    Data,
    MissingDataError,
    asymmetry,
    explained,
    mean_of,
    middle,
    quantile,
    ratio,
    slope,
    spread,
    trend,
)
from model.study.claims.shapes import ANY, each_curve, one

LIGHT = 2.0  # "inconsiderable initial pressing force (f0 < 2)"


def duration_trend(curve: Curve) -> float:
    """Trend of the duration along a curve."""
    return trend(curve.x, curve.tau)


def influence(*names: str) -> Check:
    """Longest over shortest duration of a curve, without the outermost twentieths: the median."""
    return one(
        lambda data: middle(np.array([spread(c.tau) for n in names for c in data.curves(n)]))
    )


def across(name: str, number: Callable[[Array, Array], float], low: float = -ANY) -> Check:
    """Mean of a number of the durations over the family's values, for swept values from ``low`` on.

    ``number`` takes the family's values, shape (m,), and the durations there.
    """

    def mean(data: Data) -> float:
        curves = data.curves(name)
        values = np.array([c.at for c in curves])
        grid = grid_of(curves)
        taus = np.array([sampled(c, grid) for c in curves])[:, grid >= low]
        return mean_of([number(values, column) for column in taus.T])

    return one(mean)


def grid_of(curves: Iterable[Curve]) -> Array:
    """Every swept value at which a curve has a regular point."""
    return np.unique(np.concatenate([c.x for c in curves]))


def sampled(curve: Curve, x: Array) -> Array:
    """Durations at values ``x``, NaN where the curve has no point or does not align."""
    values = np.full(x.size, NAN)
    values[np.searchsorted(x, curve.x)] = curve.tau
    return values


# --- Figure 6 -----------------------------------------------------------------------------------


def _slower_when_light(curve: Curve) -> float:
    return ratio(middle(curve.tau[curve.x < LIGHT]), middle(curve.tau[curve.x >= LIGHT]))


def _bump(curve: Curve) -> float:
    """How clearly a curve falls, rises within a small range from below ``LIGHT`` on, and falls.

    The least of the first fall, the rise and the second fall, over the duration where the rise
    begins; what else rises along the curve is taken off the rise, so that a ragged curve has none.
    """
    x, tau = curve.x[curve.aligned], curve.tau[curve.aligned]
    if x.size < 4:
        return NAN
    rises = np.maximum(np.diff(tau), 0.0)
    climbed = np.concatenate([[0.0], np.cumsum(rises)])
    highest_before = np.maximum.accumulate(tau)
    lowest_after = np.minimum.accumulate(tau[::-1])[::-1]
    first, last = np.meshgrid(np.arange(x.size), np.arange(x.size), indexing="ij")
    small = (last > first) & (x[first] < LIGHT) & (x[last] - x[first] <= SMALL_RANGE)
    if not small.any():
        return NAN
    i, j = first[small], last[small]
    other = climbed[-1] - (climbed[j] - climbed[i])
    size = np.minimum.reduce(
        [highest_before[i] - tau[i], tau[j] - tau[i] - other, tau[j] - lowest_after[j]]
    )
    return float((size / tau[i]).max())


SMALL_RANGE = 2.0


def _limited_range(data: Data) -> list[Part]:
    parts = []
    for at in (10.0, 20.0):
        curve = data.curve("fig06", at)
        parts.append(labelled("k_φ", curve, min(curve.share_aligned, 1.0 - curve.share_aligned)))
    return parts


FIGURE_6: tuple[Claim, ...] = (
    Claim(
        id="F6a",
        place="Fig. 6",
        kind="stated in figure text",
        statement="k_φ = 5 to 7: for f0 < 2 displacement and tilt appear more slowly",
        figures=("fig06",),
        measure="usual duration for f0 < 2 over that for greater f0",
        limit=A_TENTH_MORE,
        check=each_curve("fig06", "k_φ", _slower_when_light, 5.0, 7.0),
    ),
    Claim(
        id="F6b",
        place="Fig. 6",
        kind="stated in figure text",
        statement="k_φ = 10 to 20, f0 < 2: the duration first falls, then rises within a small "
        "range of f0, then falls again",
        figures=("fig06",),
        measure="least of the fall, the rise (less all other rises) and the second fall, over the "
        "duration",
        limit=VISIBLE.also("a small range is a fifth of the axis, begun below f0 = 2"),
        check=each_curve("fig06", "k_φ", _bump, 10.0, 20.0),
    ),
    Claim(
        id="F6c",
        place="Fig. 6",
        kind="stated in figure text",
        statement="k_φ = 10 and 20: alignment occurs only within a limited range of f0",
        figures=("fig06",),
        measure="share of the axis that aligns, or that does not, whichever is smaller",
        limit=VISIBLE.also("both must be seen"),
        check=_limited_range,
    ),
    Claim(
        id="F6d",
        place="Fig. 6",
        kind="stated in figure text",
        statement="k_φ = 5 to 7: as f0 increases, the duration diminishes",
        figures=("fig06",),
        measure="trend of the duration over f0",
        limit=FALLS,
        check=each_curve("fig06", "k_φ", duration_trend, 5.0, 7.0),
    ),
    Claim(
        id="F6e",
        place="sect. 3, before Fig. 6; concl. 1",
        kind="stated in figure text",
        statement="the pressing force has considerable influence on the alignment",
        figures=("fig06", "fig12"),
        measure="longest over shortest duration along f0, without the outermost twentieths, of the "
        "usual curve",
        limit=SIGNIFICANT,
        check=influence("fig06", "fig12"),
    ),
)


# --- Figure 7 -----------------------------------------------------------------------------------

ROUGH = 0.1
SIGNIFICANT_ROUGHNESS, SIGNIFICANT_FORCE = 0.15, 3.0


def _growth(curve: Curve) -> float:
    """Duration at the largest friction that aligns over that at the least."""
    tau = curve.tau[curve.aligned]
    return ratio(float(tau[-1]), float(tau[0])) if tau.size > 1 else NAN


def _growth_by_force(data: Data) -> float:
    curves = [c for c in data.curves("fig07") if c.aligned.any()]
    if len(curves) < 2:
        return NAN
    common = min(float(c.x[c.aligned].max()) for c in curves)
    grown = np.array([_growth(c.within(0.0, common)) for c in curves])
    known = grown[np.isfinite(grown)]
    return float(known.max() / known.min()) if known.size > 1 else NAN


def _steeper_below(curve: Curve) -> float:
    below, above = curve.within(0.0, ROUGH), curve.within(ROUGH, ANY)
    return asymmetry(slope(below.x, below.tau), slope(above.x, above.tau))


def _light_growth(data: Data) -> list[Part]:
    light = [c for c in data.curves("fig07") if c.at < SIGNIFICANT_FORCE]
    if not light:
        raise MissingDataError("fig07 has no curve below f0 = 3")
    return [labelled("f0", c, _growth(c.within(0.0, SIGNIFICANT_ROUGHNESS))) for c in light]


def _relative_slope(curve: Curve) -> float:
    return ratio(slope(curve.x, curve.tau), middle(curve.tau))


def _growth_elsewhere(data: Data) -> list[Part]:
    """Relative growth where the paper calls it significant against that elsewhere."""
    curves, limit = data.curves("fig07"), SIGNIFICANT_ROUGHNESS
    inside = [c.within(0.0, limit) for c in curves if c.at < SIGNIFICANT_FORCE]
    rougher = [c.within(limit, ANY) for c in curves if c.at < SIGNIFICANT_FORCE]
    harder = [c.within(0.0, limit) for c in curves if c.at >= SIGNIFICANT_FORCE]
    growth = mean_of([_relative_slope(c) for c in inside])
    others = {"than for μ > 0.15": rougher, "than for f0 ≥ 3": harder}
    return [
        Part(where, asymmetry(growth, mean_of([_relative_slope(c) for c in there])))
        for where, there in others.items()
        if there
    ]


FIGURE_7: tuple[Claim, ...] = (
    Claim(
        id="F7a",
        place="Fig. 7; concl. 5",
        kind="stated in figure text",
        statement="as μ increases, the duration increases",
        figures=("fig07",),
        measure="trend of the duration over μ",
        limit=RISES,
        check=each_curve("fig07", "f0", duration_trend),
    ),
    Claim(
        id="F7b",
        place="Fig. 7",
        kind="stated in figure text",
        statement="below μ = 0.1 the duration increases more rapidly than above",
        figures=("fig07",),
        measure="slope below less slope above, over their sum",
        limit=A_TENTH_STEEPER,
        check=each_curve("fig07", "f0", _steeper_below),
    ),
    Claim(
        id="F7c",
        place="concl. 5",
        kind="conclusion",
        statement="the increase is significant for μ ≤ 0.15 and f0 < 3",
        figures=("fig07",),
        measure="duration at μ = 0.15 over that without friction",
        limit=SIGNIFICANT,
        check=_light_growth,
    ),
    Claim(
        id="F7d",
        place="concl. 5",
        kind="conclusion",
        statement="the increase is not uniform: its character depends on the pressing force",
        figures=("fig07",),
        measure="growth with μ at the force where it is greatest over that where it is least, "
        "within the μ at which all align",
        limit=A_TENTH_MORE,
        check=one(_growth_by_force),
    ),
    Claim(
        id="F7e",
        place="concl. 5",
        kind="interpretation",
        statement="significant there means: more than for greater μ, and more than for greater f0",
        figures=("fig07",),
        measure="relative growth there less that elsewhere, over their sum",
        limit=A_TENTH_STEEPER,
        check=_growth_elsewhere,
    ),
)


# --- Figures 10 and 11 --------------------------------------------------------------------------

SLIGHTLY = 1.0 / 3.0


def _straight(curve: Curve) -> float:
    return explained(np.array([np.ones(curve.x.size), curve.x]), curve.tau)


def _inverse(curve: Curve) -> float:
    return explained(np.array([1.0 / curve.x]), curve.tau)


def _slopes_differ(data: Data) -> float:
    slopes = [slope(c.x, c.tau) for c in data.curves("fig11")]
    known = np.array([each for each in slopes if np.isfinite(each)])
    if known.size < 2 or known.mean() == 0.0:
        return NAN
    return float(np.ptp(known) / abs(known.mean()))


FIGURES_10_11: tuple[Claim, ...] = (
    Claim(
        id="F10",
        place="Fig. 10",
        kind="stated in figure text",
        statement="as I_φ increases, the duration increases",
        figures=("fig10",),
        measure="trend of the duration over I_φ",
        limit=RISES,
        check=each_curve("fig10", "ν", duration_trend),
    ),
    Claim(
        id="F11a",
        place="Fig. 11; concl. 6",
        kind="stated in figure text",
        statement="the dependence of the duration on δ is almost linear",
        figures=("fig11",),
        measure="share of the variance along δ that a straight line explains",
        limit=at_least(
            0.95, 0.1, "almost: all but a twentieth, a bend of a fifth of the curve's height"
        ),
        check=each_curve("fig11", "μ", _straight),
    ),
    Claim(
        id="F11b",
        place="Fig. 11",
        kind="stated in figure text",
        statement="as the friction increases, the duration increases",
        figures=("fig11",),
        measure="trend of the duration over μ, mean over δ",
        limit=RISES,
        check=across("fig11", trend),
    ),
    Claim(
        id="F11c",
        place="Fig. 11; concl. 6",
        kind="stated in figure text",
        statement="the duration falls as δ grows",
        figures=("fig11",),
        measure="trend of the duration over δ",
        limit=FALLS,
        check=each_curve("fig11", "μ", duration_trend),
    ),
    Claim(
        id="F11d",
        place="concl. 6",
        kind="conclusion",
        statement="the dependence on δ depends only slightly on the friction",
        figures=("fig11",),
        measure="difference of the steepest and the flattest curve's slope, over the mean slope",
        limit=at_most(SLIGHTLY, 0.5, "slightly: less than a third"),
        check=one(_slopes_differ),
    ),
    Claim(
        id="C6",
        place="concl. 6",
        kind="conclusion",
        statement="the duration is inversely proportional to δ",
        figures=("fig11",),
        measure="share of the variance along δ that a multiple of 1/δ explains",
        limit=at_least(
            0.95,
            0.5,
            "as for the straight line of F11a, which the same conclusion claims: over a range of "
            "δ as wide as this both cannot hold",
        ),
        check=each_curve("fig11", "μ", _inverse),
    ),
)


# --- Figure 12, and the pressing force in general -----------------------------------------------

NEAR_LEAST = 1.05


def _dip(curve: Curve) -> float:
    """How clearly a curve has a minimum inside: the smaller of its two flanks, over the minimum."""
    tau = curve.tau[curve.aligned]
    if tau.size < 3:
        return NAN
    before, after = np.maximum.accumulate(tau), np.maximum.accumulate(tau[::-1])[::-1]
    return float((np.minimum(before, after) / tau).max() - 1.0)


def _defined_minimum(data: Data) -> list[Part]:
    dips = [(_dip(c), c) for c in data.curves("fig12")]
    known = [(dip, c) for dip, c in dips if not math.isnan(dip)]
    if not known:
        return [Part("", NAN)]
    dip, curve = max(known, key=lambda each: each[0])
    return [labelled("at most, for δ", curve, dip)]


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


def _other_than_figure_6(data: Data) -> float:
    pairs = [_shape_distance(a, b) for a in data.curves("fig12") for b in data.curves("fig06")]
    known = [each for each in pairs if not math.isnan(each)]
    return min(known) if known else NAN


def best_force(curve: Curve) -> float:
    """Middle of the forces whose duration is within ``NEAR_LEAST`` of the least."""
    if not curve.aligned.any():
        return NAN
    near = curve.aligned & (curve.tau <= NEAR_LEAST * np.nanmin(curve.tau))
    return quantile(curve.x[near], 0.5)


def _best_force_by_frequency(data: Data) -> float:
    best = np.array([best_force(c) for c in data.curves("by_frequency")])
    known = best[np.isfinite(best)]
    return float(np.ptp(known)) if known.size > 1 else NAN


FIGURE_12: tuple[Claim, ...] = (
    Claim(
        id="F12",
        place="Fig. 12, ν = 0.5",
        kind="stated in figure text",
        statement="the dependence of the duration on f0 may have a well-defined minimum",
        figures=("fig12",),
        measure="height of the lower flank above the minimum, over the minimum",
        limit=at_least(
            0.2,
            0.5,
            "well-defined: four times what can just be seen; it may, so one curve is enough",
        ),
        check=_defined_minimum,
    ),
    Claim(
        id="F12b",
        place="Fig. 12",
        kind="stated in figure text",
        statement="these graphs are rather different from those of Fig. 6",
        figures=("fig12", "fig06"),
        measure="distance in shape of the most similar two curves, one of each figure",
        limit=at_least(
            0.1, 0.2, "rather: a tenth in root mean square, twice what can just be seen"
        ),
        check=one(_other_than_figure_6),
    ),
    Claim(
        id="C1b",
        place="concl. 1",
        kind="conclusion",
        statement="the f0 of the least duration depends on the excitation frequency",
        figures=("by_frequency",),
        measure="largest difference, over ν, of the f0 around which the duration is least",
        limit=at_least(
            0.5,
            2.0,
            "a twentieth of the axis, which can just be seen; around: within a twentieth of the "
            "least duration, so that a flat minimum has no chance position",
        ),
        check=one(_best_force_by_frequency),
    ),
)
