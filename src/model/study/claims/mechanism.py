"""Claims on the mechanism (summary, sections 1 to 3) and on the course of one run (Fig. 5)."""

from collections.abc import Mapping

import numpy as np

from model.events.outcomes import Outcome
from model.study.claims.ledger import Claim, Part, labelled
from model.study.claims.limits import FALLS, NEARLY_ALL, RISES, at_least, at_most, unmeasured
from model.study.claims.reading import (
    NAN,
    Array,
    Course,
    Curve,
    Data,
    MissingDataError,
    middle,
    ratio,
    trend,
)
from model.study.claims.shapes import each_curve, each_figure, of_points, one

FIGURES = tuple(f"fig{number:02}" for number in range(5, 15))
SMALL_ANGLE = 0.175


# --- Summary and sections 1 to 3 ----------------------------------------------------------------


def _without_impact(points: Mapping[str, Array]) -> float:
    met = points["separations"][points["aligned"]]
    return float((met == 0).mean()) if met.size else NAN


def _by_clearance(data: Data) -> float:
    """Largest misalignment up to which every run aligns, over the clearance, at the best force."""
    clearance = data.held("misaligned", "clearance") * data.held("misaligned", "half_width")
    reached = []
    for curve in data.curves("misaligned"):
        failing = np.flatnonzero(~curve.aligned)
        last = curve.x[: failing[0]] if failing.size else curve.x
        reached.append(float(last[-1]) / clearance if last.size else 0.0)
    return max(reached)


def _rests(curve: Curve) -> float:
    alone = curve.rows["side_force_max"] == 0.0
    resting = (curve.rows["outcome"] == Outcome.SETTLED) & alone
    return float(resting.mean()) if resting.size else NAN


def _rest_tilt_over_force(curve: Curve) -> float:
    return trend(curve.x, curve.rows["tilt_end"])


def _rest_tilt_over_stiffness(data: Data) -> float:
    curves = data.curves("pressed")
    forces = sorted(set.intersection(*(set(c.x.tolist()) for c in curves)))
    if not forces or len(curves) < 2:
        raise MissingDataError("pressed has no force at which all stiffnesses are known")
    stiffness = np.array([c.at for c in curves])
    tilts = np.array([c.rows["tilt_end"][np.isin(c.x, forces)] for c in curves])
    return trend(stiffness, tilts.T)


def _driven_by_tilt(data: Data) -> list[Part]:
    parts = []
    for curve in data.curves("fig07"):
        smooth = curve.within(0.0, 0.0)
        if smooth.x.size:
            parts.append(labelled("f0", curve, float(smooth.aligned[0])))
    if not parts:
        raise MissingDataError("Fig. 7 has no regular point without friction")
    return parts


def _largest_excursion(curve: Curve) -> float:
    moved = curve.rows["excursion"]
    return float(moved.max()) if moved.size else NAN


def _usual_excursion(data: Data) -> float:
    moved = np.concatenate([c.rows["excursion"] for c in data.curves("misaligned")])
    return middle(moved)


def _without_asymmetry(data: Data) -> float:
    return ratio(_largest_excursion(data.curve("centred", 0.0)), _usual_excursion(data))


def _with_small_tilt(data: Data) -> list[Part]:
    still = _largest_excursion(data.curve("centred", 0.0))
    tilted = [c for c in data.curves("centred") if c.at > 0.0]
    if not tilted:
        raise MissingDataError("centred has no tilted start")
    floor = 1e-12 * max(_usual_excursion(data), 1.0)
    return [
        labelled("φ(0)", c, float(np.log10(max(_largest_excursion(c), floor) / max(still, floor))))
        for c in tilted
    ]


def _force_peak(curve: Curve) -> float:
    return trend(curve.x, curve.rows["contact_force_max"])


def _side_contact(data: Data) -> float:
    forces = np.concatenate([c.rows["side_force_max"] for c in data.curves("displaced")])
    return float((forces > 0.0).mean()) if forces.size else NAN


def _two_moments(points: Mapping[str, Array]) -> float:
    tau = points["tau_align"][points["aligned"]]
    later = points["tau_corners_inside"][points["aligned"]] - tau
    known = np.isfinite(later) & (tau > 0.0)
    return middle(np.abs(later[known]) / tau[known])


MECHANISM: tuple[Claim, ...] = (
    Claim(
        id="N1",
        place="summary, in three languages",
        kind="conclusion",
        statement="the regime is non-impact: the part stays in contact until it aligns",
        figures=FIGURES,
        measure="share of the aligning runs that never leave the base",
        limit=NEARLY_ALL.also("equations (3) hold in contact only"),
        check=each_figure(FIGURES, of_points(_without_impact)),
    ),
    Claim(
        id="M1",
        place="sect. 3",
        kind="stated in figure text",
        statement="vibratory displacement may occur only if asymmetry exists",
        figures=("centred", "misaligned"),
        measure="farthest way from an upright start with the force through the mass centre, over "
        "the usual way from the paper's start",
        limit=at_most(
            1e-3,
            1e-3,
            "none is claimed; a thousandth is far above the accuracy of the runs, and invisible",
        ),
        check=one(_without_asymmetry),
    ),
    Claim(
        id="M1b",
        place="sect. 3",
        kind="stated in figure text",
        statement="tilted even by a small angle, force asymmetry and kinematical excitation exist",
        figures=("centred",),
        measure="decades by which a small tilt at the start lengthens the way from there",
        limit=at_least(1.0, 3.0, "one decade: what is claimed is something as against nothing"),
        check=_with_small_tilt,
    ),
    Claim(
        id="M2",
        place="sect. 3",
        kind="stated in figure text",
        statement="the pressing force tilts the body relative to the base",
        figures=("pressed",),
        measure="trend of the resting tilt over f0, not vibrated",
        limit=RISES,
        check=each_curve("pressed", "k_φ", _rest_tilt_over_force),
    ),
    Claim(
        id="M2b",
        place="sect. 3",
        kind="stated in figure text",
        statement="so a horizontal component of n emerges, which predetermines the displacement",
        figures=("fig07",),
        measure="whether the part aligns without friction (1) or not (0)",
        limit=at_least(
            0.5, 1.0, "without friction nothing but that component can move the part sideways"
        ),
        check=_driven_by_tilt,
    ),
    Claim(
        id="M2c",
        place="sect. 2",
        kind="stated in figure text",
        statement="the tilt depends on the rigidity of the elastic elements, and on the force",
        figures=("pressed",),
        measure="trend of the resting tilt over k_φ, not vibrated",
        limit=FALLS,
        check=one(_rest_tilt_over_stiffness),
    ),
    Claim(
        id="M3",
        place="sect. 1",
        kind="stated in figure text",
        statement="the method suits significant positioning errors",
        figures=("misaligned",),
        measure="misalignment up to which all runs align at the best of the forces tried, over the "
        "clearance δa",
        limit=at_least(
            5.0,
            5.0,
            "δa is what joins unhindered, and the paper's own start is at about twice that; "
            "significant must be clearly more",
        ),
        check=one(_by_clearance),
    ),
    Claim(
        id="M4",
        place="sect. 2",
        kind="interpretation",
        statement="pressed by the force, the part tilts and takes a stable equilibrium",
        figures=("pressed",),
        measure="share of the runs without vibration that come to rest on the edge",
        limit=NEARLY_ALL.also(
            "the force sets in at once, as in all runs; a part that leans on A2 as well is jammed"
        ),
        check=each_curve("pressed", "k_φ", _rests),
    ),
    Claim(
        id="M5",
        place="sect. 3",
        kind="stated in figure text",
        statement="during alignment the body may touch the base at A2",
        figures=("displaced",),
        measure="share of the runs in which the left side presses on A2 before the part aligns",
        limit=at_least(0.01, 0.1, "it may, so one run in a hundred is enough"),
        check=one(_side_contact),
    ),
    Claim(
        id="M6",
        place="sect. 2 and 3",
        kind="interpretation",
        statement="the parts are aligned when n drops to zero, and when the four corner conditions "
        "hold: one moment",
        figures=FIGURES,
        measure="usual delay from the one to the other, over the duration",
        limit=at_most(
            0.05, 0.1, "a twentieth of a duration is what can just be read off a printed axis"
        ),
        check=each_figure(FIGURES, of_points(_two_moments)),
    ),
    Claim(
        id="M7",
        place="sect. 3",
        kind="stated in figure text",
        statement="the force n between body and base depends on the initial pressing force",
        figures=("fig06",),
        measure="trend of the largest n over f0",
        limit=RISES,
        check=each_curve("fig06", "k_φ", _force_peak),
    ),
    Claim(
        id="M8",
        place="sect. 2",
        kind="stated in figure text",
        statement="the character of the displacement depends on excitation law and trajectory",
        figures=(),
        measure="",
        limit=unmeasured("the paper and this model have one law only: a sine along the axis"),
        check=None,
    ),
)


# --- Figure 5 -----------------------------------------------------------------------------------


def _course_trend(course: Course, name: str) -> float:
    way = getattr(course, name) - getattr(course, name)[0]
    return trend(np.arange(float(way.size)), way)


def _approaches(data: Data) -> float:
    return _course_trend(data.course("fig05"), "x")


def _tilts_and_sinks(data: Data) -> list[Part]:
    course = data.course("fig05")
    return [Part("φ", _course_trend(course, "tilt")), Part("-y", -_course_trend(course, "y"))]


def _force_varies(data: Data) -> float:
    force = data.course("fig05").force
    level = float(force.mean())
    return float(force.std() / level) if level > 0.0 else NAN


def _force_drops(data: Data) -> float:
    course = data.course("fig05")
    return course.fall if course.aligned else NAN


def _falls_in_upright(data: Data) -> float:
    return abs(data.held("fig05", "tilt_at_alignment"))


def _tilt_over_clearance(curve: Curve) -> float:
    return abs(trend(curve.x, np.where(curve.aligned, curve.rows["tilt_at_alignment"], NAN)))


HISTORY: tuple[Claim, ...] = (
    Claim(
        id="F5a",
        place="Fig. 5",
        kind="stated in figure text",
        statement="from x(0) = 0.2 and φ(0) = 0.001, x diminishes toward the axis",
        figures=("fig05",),
        measure="trend of x over time, averaged over an excitation period",
        limit=FALLS.also("the vibration itself is no trend"),
        check=one(_approaches),
    ),
    Claim(
        id="F5b",
        place="Fig. 5",
        kind="stated in figure text",
        statement="the tilt increases and therefore y diminishes",
        figures=("fig05",),
        measure="trend over time, averaged over an excitation period",
        limit=RISES.also("the vibration itself is no trend"),
        check=_tilts_and_sinks,
    ),
    Claim(
        id="F5c",
        place="Fig. 5",
        kind="stated in figure text",
        statement="n changes during the displacement",
        figures=("fig05",),
        measure="standard deviation of n over its mean, until the part aligns",
        limit=at_least(0.1, 0.5, "a tenth is what can be told from a constant in a printed figure"),
        check=one(_force_varies),
    ),
    Claim(
        id="F5d",
        place="Fig. 5",
        kind="stated in figure text",
        statement="at the moment of falling in, the body is tilted by a small angle",
        figures=("fig05",),
        measure="tilt at alignment in radians",
        limit=at_most(
            SMALL_ANGLE, SMALL_ANGLE, "ten degrees: sine, tangent and angle then agree within 2 %"
        ),
        check=one(_falls_in_upright),
    ),
    Claim(
        id="F5e",
        place="Fig. 5",
        kind="stated in figure text",
        statement="when the body falls into the slot, n suddenly drops to zero",
        figures=("fig05",),
        measure="time from the last moment with n above half its mean until alignment, over the "
        "duration",
        limit=at_most(
            0.05,
            0.1,
            "suddenly: within a twentieth of the duration, which looks upright in the figure",
        ),
        check=one(_force_drops),
    ),
    Claim(
        id="F5f",
        place="Fig. 5",
        kind="interpretation",
        statement="that angle is small because of δ = 0.09: it depends on the clearance",
        figures=("fig11",),
        measure="strength of the trend of the tilt at alignment over δ, whatever its sign",
        limit=RISES.also("the sentence does not say whether more clearance means more tilt"),
        check=each_curve("fig11", "μ", _tilt_over_clearance),
    ),
)
