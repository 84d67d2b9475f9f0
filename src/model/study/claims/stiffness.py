"""Claims on the tilt stiffness and on where alignment is reliable (Figs. 8, 9, 13 and 14)."""

import math
from collections.abc import Callable

import numpy as np

from model.study.claims.durations import (
    ANY,
    across,
    durations_trend,
    influence,
)
from model.study.claims.ledger import Check, Claim, Part, labelled
from model.study.claims.limits import (
    A_TENTH_MORE,
    A_TENTH_STEEPER,
    FALLS,
    HARDLY_ANY,
    NEARLY_ALL,
    SIGNIFICANT,
    VISIBLE,
    WIDER,
    at_least,
    at_most,
    unmeasured,
)
from model.study.claims.mechanism import FIGURES
from model.study.claims.reading import (
    NAN,
    Array,
    Curve,
    Data,
    Flags,
    MissingDataError,
    Plane,
    asymmetry,
    middle,
    ratio,
    slope,
    spread,
    trend,
)

SOFT = 0.1  # "small values of the tilt stiffness": the softest tenth of the axis
HARD = (2.5, 5.0)  # "higher values of the initial pressing force (f0 = 2.5-5)"
MOVED = 0.1


def _softest(curve: Curve) -> Curve:
    limit = curve.x[0] + SOFT * float(np.ptp(curve.x)) if curve.x.size else NAN
    return curve.within(-ANY, limit)


def tilt_until_alignment(curve: Curve) -> Array:
    """Largest tilt of the runs that align, NaN for the others."""
    return np.where(curve.aligned, curve.rows["tilt_max"], NAN)


# --- Figure 8 -----------------------------------------------------------------------------------


def _too_soft(data: Data) -> list[Part]:
    return [labelled("ν", c, 1.0 - _softest(c).share_aligned) for c in data.curves("fig08")]


def _turns_too_far(data: Data) -> list[Part]:
    parts = []
    for curve in data.curves("fig08"):
        soft, tilts = _softest(curve), curve.rows["tilt_max"]
        turned, usual = middle(soft.rows["tilt_max"][~soft.aligned]), middle(tilts[curve.aligned])
        parts.append(labelled("ν", curve, ratio(turned, usual)))
    return parts


def _tilts_less(data: Data) -> list[Part]:
    return [labelled("ν", c, trend(c.x, tilt_until_alignment(c))) for c in data.curves("fig08")]


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


def _share_depends(data: Data) -> list[Part]:
    shares = [c.share_aligned for c in data.curves("fig08")]
    known = [each for each in shares if not math.isnan(each)]
    return [Part("", max(known) - min(known) if len(known) > 1 else NAN)]


def _too_rough(data: Data) -> list[Part]:
    parts = []
    for curve in data.curves("rubbing"):
        limit = curve.x[-1] - SOFT * float(np.ptp(curve.x)) if curve.x.size else NAN
        parts.append(labelled("f0", curve, 1.0 - curve.within(limit, ANY).share_aligned))
    return parts


FIGURE_8: tuple[Claim, ...] = (
    Claim(
        id="F8a",
        place="Fig. 8",
        kind="stated in figure text",
        statement="at small k_φ alignment does not occur",
        figures=("fig08",),
        measure="share of the softest tenth of the axis that does not align",
        limit=NEARLY_ALL,
        check=_too_soft,
    ),
    Claim(
        id="F8b",
        place="Fig. 8; concl. 2",
        kind="interpretation",
        statement="at higher k_φ alignment is more intensive, that is, faster",
        figures=("fig08",),
        measure="trend of the duration over k_φ",
        limit=FALLS,
        check=durations_trend("fig08", "ν"),
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
        statement="preload by f0 makes a restoring moment that assists: more f0 is faster",
        figures=("fig09",),
        measure="trend of the duration over f0, mean over the k_φ at which two forces align",
        limit=FALLS,
        check=across("fig09", trend),
    ),
    Claim(
        id="F8f",
        place="Fig. 8",
        kind="stated in figure text",
        statement="where friction and elastic resistance equal the drive, matching gets impossible",
        figures=("rubbing",),
        measure="share of the roughest tenth, up to μ = 1, that does not align",
        limit=NEARLY_ALL,
        check=_too_rough,
    ),
    Claim(
        id="F8g",
        place="Fig. 8",
        kind="stated in figure text",
        statement="the area of reliable alignment depends on the excitation frequency",
        figures=("fig08",),
        measure="largest difference of the shares of the axis that align",
        limit=WIDER,
        check=_share_depends,
    ),
    Claim(
        id="F8h",
        place="Fig. 8",
        kind="stated in figure text",
        statement="at higher k_φ the body tilts by a smaller angle",
        figures=("fig08",),
        measure="trend of the largest tilt until alignment over k_φ",
        limit=FALLS,
        check=_tilts_less,
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
        check=_turns_too_far,
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


def _long_when_soft(data: Data) -> list[Part]:
    curve = data.curve("fig09", LIGHTLY)
    soft, stiff = curve.within(10.0, 15.0), curve.within(15.0, ANY)
    return [Part("", ratio(middle(soft.tau), middle(stiff.tau)))]


def _from_ten_on(number: Callable[[Curve], Array]) -> Check:
    def check(data: Data) -> list[Part]:
        curve = data.curve("fig09", LIGHTLY).within(10.0, ANY)
        return [Part("", trend(curve.x, number(curve)))]

    return check


def _tilt_gained(curve: Curve, start: float) -> float:
    return middle(tilt_until_alignment(curve)) - start


def _tilt_changes_little(data: Data) -> list[Part]:
    curve, start = data.curve("fig09", LIGHTLY), data.held("fig09", "initial_tilt")
    first, stiff = curve.within(10.0, 12.0), curve.within(15.0, ANY)
    return [Part("", ratio(_tilt_gained(stiff, start), _tilt_gained(first, start)))]


def _none_below_ten(data: Data) -> list[Part]:
    return [
        labelled("f0", c, c.only(c.x < 10.0).share_aligned) for c in data.between("fig09", *HARD)
    ]


def _halves(curve: Curve) -> tuple[Curve, Curve]:
    """The aligning part of a curve, cut in the middle of its range."""
    found = curve.only(curve.aligned)
    if not found.x.size:
        return found, found
    middle_of_range = 0.5 * (found.x[0] + found.x[-1])
    return found.within(-ANY, middle_of_range), found.within(middle_of_range, ANY)


def _falls_first(data: Data) -> list[Part]:
    parts = []
    for curve in data.between("fig09", *HARD):
        first, later = _halves(curve)
        start = float(first.tau[: max(1, first.tau.size // 5)].mean()) if first.tau.size else NAN
        parts.append(labelled("f0", curve, ratio(start, middle(later.tau))))
    return parts


def _falls_less_later(data: Data) -> list[Part]:
    parts = []
    for curve in data.between("fig09", *HARD):
        first, later = _halves(curve)
        falls = -slope(first.x, first.tau), -slope(later.x, later.tau)
        parts.append(labelled("f0", curve, asymmetry(*falls)))
    return parts


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
        check=_long_when_soft,
    ),
    Claim(
        id="F9b",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 2.5 to 5, k_φ < 10: alignment does not occur",
        figures=("fig09",),
        measure="share of the axis below k_φ = 10 that aligns",
        limit=HARDLY_ANY,
        check=_none_below_ten,
    ),
    Claim(
        id="F9c",
        place="Fig. 9",
        kind="stated in figure text",
        statement="f0 = 2.5 to 5: longer at small k_φ, falling significantly at first",
        figures=("fig09",),
        measure="duration where alignment begins over the usual one in the stiffer half",
        limit=SIGNIFICANT,
        check=_falls_first,
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
        check=_tilt_changes_little,
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
        check=_falls_less_later,
    ),
)


# --- Figures 13 and 14, and the conclusions -----------------------------------------------------

RELIABLE_REACH = 0.05
STIFF = 10.0
_MAPS = {"fig13": "(k_φ, f0)", "fig14": "(k_φ, ν)"}


def _splits(name: str) -> Check:
    def check(data: Data) -> list[Part]:
        share = data.plane(name).share_aligned
        return [Part("", min(share, 1.0 - share))]

    return check


def _one_area(name: str) -> Check:
    def check(data: Data) -> list[Part]:
        return [Part("", data.plane(name).largest_area)]

    return check


def _some_stiffness(data: Data) -> list[Part]:
    plane = data.plane("fig13")
    judged = plane.safe(RELIABLE_REACH)[plane.y <= 10.0]
    return [Part("", float(judged.any(axis=1).mean()) if judged.size else NAN)]


def _stiff_alignments(data: Data) -> list[Part]:
    """Share of the settings with k_φ >= 10 that align, by figure."""
    parts = []
    if data.has("fig06"):
        flags = [c.aligned for c in data.curves("fig06") if c.at >= STIFF]
        parts += [_share("fig06", np.concatenate(flags))] if flags else []
    for name in filter(data.has, ("fig08", "fig09")):
        flags = [c.aligned[c.x >= STIFF] for c in data.curves(name)]
        parts.append(_share(name, np.concatenate(flags)))
    for name in filter(data.has, _MAPS):
        plane = data.plane(name)
        there = plane.regular & (plane.x[None, :] >= STIFF)
        parts.append(_share(name, plane.aligned[there]))
    if not parts:
        raise MissingDataError("there is no dataset of Figs. 6, 8, 9, 13 and 14")
    return parts


def _share(name: str, aligned: Flags) -> Part:
    share = float(aligned.mean()) if aligned.size else NAN
    return Part(f"Fig. {int(name[3:])}", share)


def _faster_when_stiffer(data: Data) -> list[Part]:
    parts = []
    for name in filter(data.has, _MAPS):
        plane = data.plane(name)
        tau = np.where(plane.regular, plane.tau, NAN)
        parts.append(Part(f"Fig. {int(name[3:])}", trend(plane.x, tau)))
    if not parts:
        raise MissingDataError("there is no dataset of Figs. 13 and 14")
    return parts


def _peak(plane: Plane) -> Array:
    """Largest tilt stiffness that aligns in each row, where any does."""
    found = plane.aligned & plane.regular
    return np.array([plane.x[row].max() for row in found if row.any()])


def _peak_depends(data: Data) -> list[Part]:
    plane = data.plane("fig14")
    peaks = _peak(plane)
    if peaks.size < 2:
        return [Part("", NAN)]
    return [Part("", float(np.ptp(peaks) / np.ptp(plane.x)))]


def _reliable(data: Data) -> list[Part]:
    return [
        Part(f"Fig. {int(name[3:])}", float(data.plane(name).safe(RELIABLE_REACH).mean()))
        for name in _MAPS
    ]


def _corners_come_inside(data: Data) -> list[Part]:
    parts = []
    for name in FIGURES:
        if data.has(name):
            points = data.regular(name)
            inside = np.isfinite(points["tau_corners_inside"][points["aligned"]])
            share = float(inside.mean()) if inside.size else NAN
            parts.append(Part(f"Fig. {int(name[3:])}", share))
    if not parts:
        raise MissingDataError("there is no dataset of a figure")
    return parts


def _of_maps() -> list[Claim]:
    """The two claims that Figs. 13 and 14 share."""
    claims = []
    for name, plane in _MAPS.items():
        number = name[3:]
        claims += [
            Claim(
                id=f"F{number}",
                place=f"Fig. {number}; concl. 7" + ("; Fig. 6" if number == "13" else ""),
                kind="stated in figure text",
                statement=f"the {plane} plane splits into an aligning and a non-aligning area: the "
                "two must be matched",
                figures=(name,),
                measure="share of the plane that aligns, or that does not, whichever is smaller",
                limit=VISIBLE.also("both must be seen"),
                check=_splits(name),
            ),
            Claim(
                id=f"F{number}b",
                place=f"Fig. {number}; concl. 7",
                kind="interpretation",
                statement="the settings that align are an area, from which others can be read off",
                figures=(name,),
                measure="share of the aligning settings that hang together",
                limit=at_least(
                    0.9, 0.5, "an area to read settings from is in one piece; a tenth may lie apart"
                ),
                check=_one_area(name),
            ),
        ]
    return claims


AREAS: tuple[Claim, ...] = (
    *_of_maps(),
    Claim(
        id="C1a",
        place="concl. 1",
        kind="conclusion",
        statement="reliable alignment occurs for f0 ≤ 10",
        figures=("fig13",),
        measure="share of the forces up to 10 for which there is a k_φ around which all aligns",
        limit=NEARLY_ALL.also("reliable as in C8; no stiffness is named, so one is enough"),
        check=_some_stiffness,
    ),
    Claim(
        id="C2",
        place="concl. 2",
        kind="conclusion",
        statement="the tilt stiffness has significant influence on the alignment",
        figures=("fig08", "fig09"),
        measure="longest over shortest duration along k_φ, without the outermost twentieths, of "
        "the usual curve",
        limit=SIGNIFICANT,
        check=influence("fig08", "fig09"),
    ),
    Claim(
        id="C2a",
        place="concl. 2",
        kind="conclusion",
        statement="alignment requires k_φ to be smaller than 10",
        figures=("fig06", "fig08", "fig09", "fig13", "fig14"),
        measure="share of the settings with k_φ ≥ 10 that align",
        limit=HARDLY_ANY.also(
            "the paper's own Figs. 6 and 9 show alignment at k_φ = 10 to 20 (F6b, F6c, F9a), so "
            "that one of its sentences must fail"
        ),
        check=_stiff_alignments,
    ),
    Claim(
        id="C2b",
        place="concl. 2",
        kind="conclusion",
        statement="as the tilt stiffness increases, the duration decreases",
        figures=("fig13", "fig14"),
        measure="trend of the duration over k_φ, mean over the rows of the map",
        limit=FALLS,
        check=_faster_when_stiffer,
    ),
    Claim(
        id="C2c",
        place="concl. 2",
        kind="conclusion",
        statement="the peak k_φ under which alignment takes place depends on the frequency",
        figures=("fig14",),
        measure="largest difference, over ν, of the stiffest k_φ that aligns, over the axis",
        limit=WIDER,
        check=_peak_depends,
    ),
    Claim(
        id="C8",
        place="concl. 8; end of sect. 3",
        kind="conclusion",
        statement="properly matched parameters ensure reliable alignment",
        figures=("fig13", "fig14"),
        measure="share of the plane around which all within a twentieth of either axis aligns",
        limit=at_least(
            0.1,
            0.2,
            "reliable: settings may be off by a twentieth; a tenth of the plane is room to choose",
        ),
        check=_reliable,
    ),
    Claim(
        id="C8b",
        place="concl. 8; end of sect. 3",
        kind="conclusion",
        statement="properly matched parameters ensure fast alignment",
        figures=(),
        measure="",
        limit=unmeasured("the paper states no duration, and none to compare with"),
        check=None,
    ),
    Claim(
        id="C8c",
        place="sect. 2",
        kind="stated in figure text",
        statement="to be aligned, the part must bring all four corner conditions about",
        figures=FIGURES,
        measure="share of the runs that fall in whose corners come to be inside",
        limit=NEARLY_ALL.also("what falls in must fit in"),
        check=_corners_come_inside,
    ),
    Claim(
        id="C8d",
        place="sect. 2",
        kind="stated in figure text",
        statement="the part tilts so that the directions of the axes coincide",
        figures=(),
        measure="",
        limit=unmeasured(
            "the model ends when the corners are inside: insertion, with contact on both walls, "
            "is not in the paper's equations"
        ),
        check=None,
    ),
)
