"""Claims on the tilt stiffness and on the part's tilt (Figs. 8 and 9)."""

import math
from collections.abc import Callable

import numpy as np

from model.study.claims.durations import across, duration_trend
from model.study.claims.ledger import Check, Claim, Part, labelled
from model.study.claims.limits import (
    A_TENTH_MORE,
    A_TENTH_STEEPER,
    FALLS,
    HARDLY_ANY,
    NEARLY_ALL,
    SIGNIFICANT,
    WIDER,
    at_most,
)
from model.study.claims.reading import (
    NAN,
    Array,
    Curve,
    Data,
    asymmetry,
    middle,
    ratio,
    slope,
    spread,
    trend,
)
from model.study.claims.shapes import ANY, each_curve, one

SOFT = 0.1  # "small values of the tilt stiffness": the softest tenth of the axis
STIFF = 10.0  # "higher values of the tilt stiffness", as Fig. 6 has them: 10 to 20
HARD = (2.5, 5.0)  # "higher values of the initial pressing force (f0 = 2.5-5)"
MOVED = 0.1


def _softest(curve: Curve) -> Curve:
    limit = curve.x[0] + SOFT * float(np.ptp(curve.x)) if curve.x.size else NAN
    return curve.within(-ANY, limit)


def tilt_until_alignment(curve: Curve) -> Array:
    """Largest tilt of the runs that align, NaN for the others."""
    return np.where(curve.aligned, curve.rows["tilt_max"], NAN)


# --- Figure 8 -----------------------------------------------------------------------------------


def _too_soft(curve: Curve) -> float:
    return 1.0 - _softest(curve).share_aligned


def _turns_too_far(curve: Curve) -> float:
    soft, tilts = _softest(curve), curve.rows["tilt_max"]
    return ratio(middle(soft.rows["tilt_max"][~soft.aligned]), middle(tilts[curve.aligned]))


def _tilts_less(curve: Curve) -> float:
    return trend(curve.x, tilt_until_alignment(curve))


def wider_below(share: Callable[[Curve], float], name: str, low: float, high: float) -> Check:
    """Share of the axis at each frequency <= ``low`` less the largest of those >= ``high``."""

    def check(data: Data) -> list[Part]:
        slow = data.between(name, -ANY, low)
        fast = [share(c) for c in data.between(name, high, ANY)]
        known = [each for each in fast if not math.isnan(each)]
        widest = max(known) if known else NAN
        return [labelled("ν", c, share(c) - widest) for c in slow]

    return check


def _share_displaced(curve: Curve) -> float:
    way = curve.rows["way"]
    return float((way >= MOVED).mean()) if way.size else NAN


def _share_depends(data: Data) -> float:
    shares = [c.share_aligned for c in data.curves("fig08")]
    known = [each for each in shares if not math.isnan(each)]
    return max(known) - min(known) if len(known) > 1 else NAN


def _too_rough(curve: Curve) -> float:
    limit = curve.x[-1] - SOFT * float(np.ptp(curve.x)) if curve.x.size else NAN
    return 1.0 - curve.within(limit, ANY).share_aligned


FIGURE_8: tuple[Claim, ...] = (
    Claim(
        id="F8a",
        place="Fig. 8",
        kind="stated in figure text",
        statement="at small k_φ alignment does not occur",
        figures=("fig08",),
        measure="share of the softest tenth of the axis that does not align",
        limit=NEARLY_ALL,
        check=each_curve("fig08", "ν", _too_soft),
    ),
    Claim(
        id="F8b",
        place="Fig. 8; concl. 2",
        kind="interpretation",
        statement="at higher k_φ alignment is more intensive, that is, faster",
        figures=("fig08",),
        measure="trend of the duration over k_φ",
        limit=FALLS,
        check=each_curve("fig08", "ν", duration_trend),
    ),
    Claim(
        id="F8c",
        place="Fig. 8",
        kind="stated in figure text",
        statement="when ν < 10, reliable alignment takes place within a wider range of k_φ",
        figures=("fig08",),
        measure="share of the axis that aligns less that at ν = 10",
        limit=WIDER,
        check=wider_below(lambda c: c.share_aligned, "fig08", 9.99, 10.0),
    ),
    Claim(
        id="F8d",
        place="concl. 3",
        kind="conclusion",
        statement="for ν ≤ 1 vibratory displacement occurs in a wider k_φ range than above",
        figures=("displaced",),
        measure="share of the axis with displacement less the largest share at a higher ν",
        limit=WIDER.also(
            "displacement is a tenth of the way to the slot, whether or not the part aligns"
        ),
        check=wider_below(_share_displaced, "displaced", 1.0, 1.0 + 1e-9),
    ),
    Claim(
        id="F8e",
        place="Fig. 8",
        kind="interpretation",
        statement="at higher k_φ, preload by f0 makes a restoring moment that assists: more f0 is "
        "faster",
        figures=("fig09",),
        measure="trend of the duration over f0, mean over the k_φ from 10 on at which two forces "
        "align",
        limit=FALLS,
        check=across("fig09", trend, STIFF),
    ),
    Claim(
        id="F8f",
        place="Fig. 8",
        kind="stated in figure text",
        statement="where friction and elastic resistance equal the drive, matching gets impossible",
        figures=("rubbing",),
        measure="share of the roughest tenth, up to μ = 1, that does not align",
        limit=NEARLY_ALL,
        check=each_curve("rubbing", "f0", _too_rough),
    ),
    Claim(
        id="F8g",
        place="Fig. 8",
        kind="stated in figure text",
        statement="the area of reliable alignment depends on the excitation frequency",
        figures=("fig08",),
        measure="largest difference of the shares of the axis that align",
        limit=WIDER,
        check=one(_share_depends),
    ),
    Claim(
        id="F8h",
        place="Fig. 8",
        kind="stated in figure text",
        statement="at higher k_φ the body tilts by a smaller angle",
        figures=("fig08",),
        measure="trend of the largest tilt until alignment over k_φ",
        limit=FALLS,
        check=each_curve("fig08", "ν", _tilts_less),
    ),
    Claim(
        id="F8i",
        place="Fig. 8",
        kind="stated in figure text",
        statement="at small k_φ the body turns by such an angle that it does not align",
        figures=("fig08",),
        measure="largest tilt of the runs in the softest tenth that do not align, over the usual "
        "largest tilt of those that do",
        limit=A_TENTH_MORE,
        check=each_curve("fig08", "ν", _turns_too_far),
    ),
    Claim(
        id="F8j",
        place="Fig. 8",
        kind="stated in figure text",
        statement="the excitation frequency influences the duration",
        figures=("fig08",),
        measure="longest over shortest duration over ν, mean over k_φ",
        limit=A_TENTH_MORE,
        check=across("fig08", lambda _values, tau: spread(tau) if known_twice(tau) else NAN),
    ),
)


def known_twice(tau: Array) -> bool:
    """Whether at least two durations are known."""
    return int(np.isfinite(tau).sum()) >= 2


# --- Figure 9 -----------------------------------------------------------------------------------

LIGHTLY = 1.0


def _long_when_soft(data: Data) -> float:
    curve = data.curve("fig09", LIGHTLY)
    soft, stiff = curve.within(10.0, 15.0), curve.within(15.0, ANY)
    return ratio(middle(soft.tau), middle(stiff.tau))


def _from_ten_on(number: Callable[[Curve], Array]) -> Check:
    def along(data: Data) -> float:
        curve = data.curve("fig09", LIGHTLY).within(10.0, ANY)
        return trend(curve.x, number(curve))

    return one(along)


def _tilt_gained(curve: Curve, start: float) -> float:
    return middle(tilt_until_alignment(curve)) - start


def _tilt_changes_little(data: Data) -> float:
    curve, start = data.curve("fig09", LIGHTLY), data.held("fig09", "initial_tilt")
    first, stiff = curve.within(10.0, 12.0), curve.within(15.0, ANY)
    return ratio(_tilt_gained(stiff, start), _tilt_gained(first, start))


def _share_below_ten(curve: Curve) -> float:
    return curve.only(curve.x < 10.0).share_aligned


def _halves(curve: Curve) -> tuple[Curve, Curve]:
    """The aligning part of a curve, cut in the middle of its range."""
    found = curve.only(curve.aligned)
    if not found.x.size:
        return found, found
    middle_of_range = 0.5 * (found.x[0] + found.x[-1])
    return found.within(-ANY, middle_of_range), found.within(middle_of_range, ANY)


def _falls_first(curve: Curve) -> float:
    first, later = _halves(curve)
    start = float(first.tau[: max(1, first.tau.size // 5)].mean()) if first.tau.size else NAN
    return ratio(start, middle(later.tau))


def _falls_less_later(curve: Curve) -> float:
    first, later = _halves(curve)
    return asymmetry(-slope(first.x, first.tau), -slope(later.x, later.tau))


def _stronger_when_pressed(data: Data) -> list[Part]:
    light, parts = data.curve("fig09", LIGHTLY), []
    for curve in data.between("fig09", *HARD):
        reach = curve.x[curve.aligned]
        same = light.within(reach[0], reach[-1]) if reach.size else light
        parts.append(labelled("f0", curve, ratio(spread(curve.tau), spread(same.tau))))
    return parts


FIGURE_9: tuple[Claim, ...] = (
    Claim(
        id="F9a",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 1, k_φ = 10 to 15: the duration is relatively long",
        figures=("fig09",),
        measure="usual duration there over that at greater k_φ",
        limit=A_TENTH_MORE,
        check=one(_long_when_soft),
    ),
    Claim(
        id="F9b",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 2.5 to 5, k_φ < 10: alignment does not occur",
        figures=("fig09",),
        measure="share of the axis below k_φ = 10 that aligns",
        limit=HARDLY_ANY,
        check=each_curve("fig09", "f0", _share_below_ten, *HARD),
    ),
    Claim(
        id="F9c",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 2.5 to 5: longer at small k_φ, falling significantly at first",
        figures=("fig09",),
        measure="duration where alignment begins over the usual one in the stiffer half",
        limit=SIGNIFICANT,
        check=each_curve("fig09", "f0", _falls_first, *HARD),
    ),
    Claim(
        id="F9d",
        place="Fig. 9; concl. 4",
        kind="stated in figure text",
        statement="the influence of k_φ on the duration is stronger at higher f0",
        figures=("fig09",),
        measure="longest over shortest duration along k_φ, over that of f0 = 1 on the same range",
        limit=A_TENTH_MORE,
        check=_stronger_when_pressed,
    ),
    Claim(
        id="F9e",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 1: as k_φ increases the tilt is smaller",
        figures=("fig09",),
        measure="trend of the largest tilt until alignment over k_φ from 10 on",
        limit=FALLS,
        check=_from_ten_on(tilt_until_alignment),
    ),
    Claim(
        id="F9f",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 1: as k_φ increases the duration diminishes",
        figures=("fig09",),
        measure="trend of the duration over k_φ from 10 on",
        limit=FALLS,
        check=_from_ten_on(lambda curve: curve.tau),
    ),
    Claim(
        id="F9g",
        place="Fig. 9",
        kind="interpretation",
        statement="f0 = 1: at higher k_φ the tilt changes marginally during the alignment",
        figures=("fig09",),
        measure="usual change of the tilt at k_φ > 15 over that at 10 to 12",
        limit=at_most(0.5, 0.5, "marginally is said of higher k_φ as against lower: at most half"),
        check=one(_tilt_changes_little),
    ),
    Claim(
        id="F9h",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 2.5 to 5: later the fall in duration is not so intense",
        figures=("fig09",),
        measure="slope in the softer half of the aligning range less that in the stiffer, over "
        "their sum",
        limit=A_TENTH_STEEPER,
        check=each_curve("fig09", "f0", _falls_less_later, *HARD),
    ),
)
