"""Fig. 4: contact scheme: the whole part on the edge A1, and the base yielding at A1 and at A2."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Parameters
from study.schematics.sheet import Place, Scheme
from vibralign.plots import style
from vibralign.plots.pose import Pose, resting_pose, xy

# In centimetres on paper: the depths as drawn, how far B2 hangs below A2, and the recess in the
# base that holds its spring and dashpot, along the face and away from it.
_DEPTH, _HANG = 0.5, 1.9
_ALONG, _DEEP = 2.4, 2.0
_DETAIL = 0.42  # scale of the whole scheme over the scale of a detail


def contact_poses(parameters: Parameters) -> tuple[Pose, Pose, Pose]:
    """Return the poses of the panels: at rest on A1; A1 at depth d; A2 at depth w in the left side.

    In the second A1 keeps its place along the face. In the third the corner B2 hangs below A2.
    """
    resting = resting_pose(parameters)
    p, cm = resting.constants, _DETAIL * resting.centimetre(7.6)
    face = resting.edge_place(RIGHT_EDGE).along_face
    below = resting.with_edge_at(RIGHT_EDGE, face, _DEPTH * cm - p.half_height)
    inside, hang = _DEPTH * cm - p.half_width, _HANG * cm - p.half_height
    return resting, below, resting.with_edge_at(LEFT_EDGE, inside, hang)


@style.context()
def draw(parameters: Parameters) -> Figure:
    """Draw the contact at A1, with a detail of each edge."""
    whole, below, beside = contact_poses(parameters)
    cm = whole.centimetre(7.6)
    height = max(whole.top / cm + 3.5, 11.0)
    figure = style.new_figure(height=height * style.CENTIMETRE)
    _draw_whole(Scheme(figure.add_axes((0.0, 0.0, 0.53, 1.0)), whole, cm, -3.9, -2.3))
    cm *= _DETAIL
    edge, share = whole.constants.slot_half_width / cm, 4.25 / height
    upper = figure.add_axes((0.54, 1.0 - 1.15 / height - share, 0.45, share))
    lower = figure.add_axes((0.54, 0.25 / height, 0.45, share))
    _draw_detail(
        Scheme(upper, below, cm, edge - 3.0, -2.6),
        RIGHT_EDGE, "(b)  edge $A_1$ in the bottom face", "d",
        ("$e_n$", (0.3, -0.05)), ("$A_1$", (0.35, 0.22)), ("$B_1$", (0.3, -0.2)),
    )  # fmt: skip
    _draw_detail(
        Scheme(lower, beside, cm, -edge - 3.4, -2.7),
        LEFT_EDGE, "(c)  edge $A_2$ in the left side face", "w",
        ("$e_t$", (0.05, 0.28)), ("$A_2$", (0.25, -0.3)), ("$B_2$", (0.6, 0.36)),
    )  # fmt: skip
    return figure


def _draw_whole(sheet: Scheme) -> None:
    cm, centre = sheet.cm, sheet.pose.centre
    sheet.base(reach=2.2, depth=1.6)
    sheet.part()
    sheet.frame(sheet.a + 2.75 * cm, 1.4 * cm)
    edges = [sheet.pose.edge(each) for each in (RIGHT_EDGE, LEFT_EDGE)]
    names = ("$B_1$", "$D_1$", "$D_2$", "$B_2$", "$A_1$", "$A_2$")
    shifts = ((0.3, 0.22), (0.33, 0.12), (-0.3, 0.15), (-0.32, -0.14), (-0.3, -0.4), (-0.35, 0.38))
    for point, name, shift in zip([*sheet.pose.corners(), *edges], names, shifts, strict=True):
        sheet.point(point, name, shift, 3.0)
    _mark_sizes(sheet)
    sheet.tilt_of_face(reach=1.4)
    heads = centre + 0.8 * cm * sheet.pose.axes
    sheet.arrow(centre, heads[0], "$e_t$", (-0.2, 0.24), color=Scheme.CONTACT)
    sheet.arrow(centre, heads[1], "$e_n$", (0.3, -0.05), color=Scheme.CONTACT)
    sheet.point(centre, "$C$", (-0.22, -0.3))
    for edge, side, words in zip(edges, (1, -1), ("(b)", "(c)"), strict=True):
        # A ring round the edge, with the letter of the panel that shows it larger.
        away, ring = xy(side, -1.0) / np.sqrt(2.0), 0.26 * cm
        look: dict[str, Any] = {"fill": False, "color": style.GREY, "zorder": 7}
        sheet.axes.add_patch(Circle(tuple(edge), ring, **look))
        sheet.line(edge + ring * away, edge + cm * away, color=style.GREY)
        sheet.text(edge + cm * away, words, 0.3 * away, on=Scheme.BASE)
    sheet.axes.text(0.05, 0.965, "(a)  start, $d = 0$", transform=sheet.axes.transAxes, va="top")


def _mark_sizes(sheet: Scheme) -> None:
    """Mark A and B of the part, L of the slot."""
    right, left, low = sheet.at(1, 1), sheet.at(-1, 1), -1.1 * sheet.cm
    above = sheet.at(1, 1, 0, 0.55), sheet.at(0, 1, 0, 0.55)
    sheet.chain(sheet.at(0, 1, 0, 0.7), sheet.at(0, -1))
    sheet.dimension(*above, "$A$", (0, 0.28), feet=[right])
    beside = sheet.at(-1, 0, -0.7), sheet.at(-1, 1, -0.7)
    sheet.dimension(*beside, "$B$", feet=[sheet.pose.centre, left])
    sheet.chain((0, 0), (0, low - 0.15 * sheet.cm))
    sheet.dimension((0, low), (sheet.half, low), "$L$", (0, -0.25))


def _draw_detail(
    sheet: Scheme, side: float, title: str, depth: str, *names: tuple[str, Place]
) -> None:
    """Draw an edge in a face, and the base that yields along the face's normal.

    ``names`` are those of the normal, the edge and the corner, each with its distance (cm).
    """
    cm, edge, axis = sheet.cm, sheet.pose.edge(side), int(side == RIGHT_EDGE)
    normal, across = sheet.pose.axes[axis], side * sheet.pose.axes[1 - axis]
    foot, head = edge - _DEPTH * cm * normal, edge + 1.1 * cm * normal
    # The base without the material at its edge, whose undeformed outline is dashed.
    inner = edge + cm * (xy(_ALONG, -_DEEP) if axis else xy(-_DEEP, -_ALONG))
    wide, deep = xy(inner[0], 0.0), xy(edge[0], inner[1])
    far, low = xy(edge[0] + side * 20 * cm, 0.0), xy(edge[0], -20 * cm)  # beyond the panel's frame
    profile: list[Place] = [far, wide, inner, deep, low]
    sheet.cut([*profile, xy(far[0], low[1])])
    sheet.line(*profile, width=Scheme.OUTLINE)
    sheet.line(wide, edge, deep, linestyle=(0, (4, 2)), label="base")
    sheet.point(edge, zorder=8)
    sheet.part()
    bar, wall = foot - 0.25 * cm * normal, edge[axis] - _DEEP * cm
    sheet.line(foot, bar, bar + 1.2 * cm * across, width=Scheme.OUTLINE, color=Scheme.SUSPENSION)
    for place, link, words in ((0.25, sheet.spring, "$K_a$"), (1.2, sheet.damper, "$H_a$")):
        start = bar + place * cm * across
        stop = start + (wall - start[axis]) / normal[axis] * normal
        link(start, stop)
        sheet.text((start + stop) / 2, words, 0.46 * across, color=Scheme.SUSPENSION)
    sheet.point(foot, size=3.0, color=Scheme.SUSPENSION)
    aside = -0.6 * cm * across
    for point in (edge, foot):
        sheet.line(point, point + 1.2 * aside)
    sheet.dimension(edge + aside, foot + aside, f"${depth}$", -0.3 * across)
    named, *others = names
    sheet.arrow(edge, head, *named, color=Scheme.CONTACT, zorder=7)
    for point, other in zip((edge, sheet.pose.corners()[3 - 3 * axis]), others, strict=True):
        sheet.text(point, *other)
    # Title and law over the panel, and a frame where part and base are cut off.
    law = f"       $N = K_a {depth} + H_a {depth}^{{\\,\\prime}}$,   ${depth}$ enlarged"
    box: dict[str, Any] = {"transform": sheet.axes.transAxes, "clip_on": False}
    sheet.axes.text(0.0, 1.14, title, va="bottom", **box)
    sheet.axes.text(0.0, 1.03, law, va="bottom", **box)
    look: dict[str, Any] = {"edgecolor": style.GREY, "linewidth": 0.8, "zorder": 10, **box}
    sheet.axes.add_patch(Rectangle((0, 0), 1, 1, fill=False, **look))
