"""Claims on areas of reliable alignment (Figs. 13 and 14), and the conclusions drawn from all."""

from collections.abc import Callable, Mapping

import numpy as np

from model.study.claims.durations import influence
from model.study.claims.ledger import Check, Claim, Part
from model.study.claims.limits import (
    FALLS,
    HARDLY_ANY,
    NEARLY_ALL,
    SIGNIFICANT,
    VISIBLE,
    WIDER,
    at_least,
    unmeasured,
)
from model.study.claims.mechanism import FIGURES
from model.study.claims.reading import NAN, Array, Data, Flags, MissingDataError, Plane, trend
from model.study.claims.shapes import each_figure, of_points, one
from model.study.claims.stiffness import STIFF

RELIABLE_REACH = 0.05
_MAPS = {"fig13": "(k_φ, f0)", "fig14": "(k_φ, ν)"}


def _of_plane(name: str, number: Callable[[Plane], float]) -> Check:
    return one(lambda data: number(data.plane(name)))


def _smaller_area(plane: Plane) -> float:
    return min(plane.share_aligned, 1.0 - plane.share_aligned)


def _some_stiffness(plane: Plane) -> float:
    judged = plane.safe(RELIABLE_REACH)[plane.y <= 10.0]
    return float(judged.any(axis=1).mean()) if judged.size else NAN


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


def _faster_when_stiffer(data: Data, name: str) -> float:
    plane = data.plane(name)
    return trend(plane.x, np.where(plane.regular, plane.tau, NAN))


def _peak(x: Array, aligned: Flags, regular: Flags) -> tuple[float, float] | None:
    """Bounds of the stiffest k_φ that aligns in a row: sensitive cells right above it may, too."""
    surely = np.flatnonzero(aligned & regular)
    if not surely.size:
        return None
    least = most = int(surely[-1])
    while most + 1 < x.size and not regular[most + 1]:
        most += 1
    return float(x[least]), float(x[most])


def _peak_depends(plane: Plane) -> float:
    rows = zip(plane.aligned, plane.regular, strict=True)
    peaks = [peak for row in rows if (peak := _peak(plane.x, *row)) is not None]
    if len(peaks) < 2:
        return NAN
    apart = max(least for least, _ in peaks) - min(most for _, most in peaks)
    return max(0.0, apart / float(np.ptp(plane.x)))


def _reliable(data: Data) -> list[Part]:
    return [
        Part(f"Fig. {int(name[3:])}", float(data.plane(name).safe(RELIABLE_REACH).mean()))
        for name in _MAPS
    ]


def _corners_come_inside(points: Mapping[str, Array]) -> float:
    inside = np.isfinite(points["tau_corners_inside"][points["aligned"]])
    return float(inside.mean()) if inside.size else NAN


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
                check=_of_plane(name, _smaller_area),
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
                check=_of_plane(name, lambda plane: plane.largest_area),
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
        check=_of_plane("fig13", _some_stiffness),
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
        check=each_figure(tuple(_MAPS), _faster_when_stiffer),
    ),
    Claim(
        id="C2c",
        place="concl. 2",
        kind="conclusion",
        statement="the peak k_φ under which alignment takes place depends on the frequency",
        figures=("fig14",),
        measure="largest difference, over ν, of the stiffest k_φ that aligns, over the axis",
        limit=WIDER,
        check=_of_plane("fig14", _peak_depends),
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
        check=each_figure(FIGURES, of_points(_corners_come_inside)),
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
