"""Fig. 4: contact scheme: the whole part on the edge A1, and the base yielding at A1 and at A2."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Parameters
from model.show import style
from model.show.schematics.pose import Point, Pose, resting_pose, xy
from model.show.schematics.sheet import (
    BASE_COLOUR,
    CONTACT,
    FORCE,
    OUTLINE,
    SUSPENSION,
    Sheet,
    centimetre,
)

CAPTION = (
    "Contact scheme. (a) The part at the start, its bottom face on the edge A1. The base "
    "yields as a spring and a damper (b) at A1, along the normal e_n of the bottom face, and (c) "
    "at A2, along the normal e_t of the left side face, which it can meet in a later pose. Corners "
    "and edges are where the model has them; the tilt and the depths d and w are enlarged."
)
# In centimetres on paper: the depths as drawn, how far B2 hangs below A2, and the recess in the
# base that holds its spring and dashpot, along the face and away from it.
_DEPTH, _SIDE_DEPTH, _HANG = 0.5, 0.5, 1.9
_RECESS_ALONG, _RECESS_DEEP = 2.4, 2.0
_DETAIL = 0.42  # scale of the whole scheme over the scale of a detail


def contact_poses(parameters: Parameters) -> tuple[Pose, Pose, Pose]:
    """Return the poses of the panels: at rest on A1; A1 at depth d; A2 at depth w in the left side.

    In the second A1 keeps its place along the face. In the third the corner B2 hangs below A2.
    """
    resting = resting_pose(parameters)
    p, cm = resting.constants, _DETAIL * centimetre(resting, 7.6)
    face = resting.edge_place(RIGHT_EDGE).along_face
    below = resting.with_edge_at(RIGHT_EDGE, face, _DEPTH * cm - p.half_height)
    inside, hang = _SIDE_DEPTH * cm - p.half_width, _HANG * cm - p.half_height
    return resting, below, resting.with_edge_at(LEFT_EDGE, inside, hang)


def draw(parameters: Parameters) -> Figure:
    """Draw the contact at A1, with a detail of each edge."""
    whole, below, beside = contact_poses(parameters)
    with style.context():
        cm = centimetre(whole, 7.6)
        height = max(whole.top / cm + 3.5, 11.0)
        figure = style.new_figure(height=height * style.CENTIMETRE)
        figure.set_layout_engine("none")  # the panels are placed by hand
        left = figure.add_axes((0.0, 0.0, 0.53, 1.0))
        _draw_whole(Sheet(left, cm, -3.9, -2.3), whole)
        edge, detail = whole.constants.slot_half_width / (_DETAIL * cm), _DETAIL * cm
        share, floor = 4.25 / height, 0.25 / height
        upper = figure.add_axes((0.54, 1.0 - 1.15 / height - share, 0.45, share))
        _draw_detail(Sheet(upper, detail, edge - 3.0, -2.6), below, _AT_BOTTOM)
        lower = figure.add_axes((0.54, floor, 0.45, share))
        _draw_detail(Sheet(lower, detail, -edge - 3.4, -2.7), beside, _AT_SIDE)
    return figure


# --- (a) The whole part -------------------------------------------------------------------------


def _draw_whole(sheet: Sheet, pose: Pose) -> None:
    cm, p = sheet.cm, pose.constants
    sheet.base(pose, reach=2.2, depth=1.6)
    sheet.part(pose)
    sheet.frame(p.half_width + 2.75 * cm, 1.4 * cm, origin=(-0.17, -0.45))
    _name_points(sheet, pose)
    _mark_sizes(sheet, pose)
    sheet.tilt_of_face(pose, reach=1.9)
    for direction, words, shift in (
        (pose.along_face, "$e_t$", (-0.2, 0.24)),
        (pose.along_axis, "$e_n$", (0.3, -0.05)),
    ):
        sheet.vector(pose.centre, pose.centre + 0.8 * cm * direction, words, shift, color=CONTACT)
    sheet.point(pose.centre, "$C$", (-0.22, -0.3))
    for side, words in ((RIGHT_EDGE, "(b)"), (LEFT_EDGE, "(c)")):
        _point_to_detail(sheet, pose.edge(side), side, words)
    sheet.axes.text(0.05, 0.965, "(a)  start, $d = 0$", transform=sheet.axes.transAxes, va="top")


def _point_to_detail(sheet: Sheet, edge: Point, side: float, words: str) -> None:
    """Draw a ring round the edge, with the letter of the panel that shows it larger."""
    away, ring = xy(side, -1.0) / np.sqrt(2.0), 0.26 * sheet.cm
    circle = Circle((float(edge[0]), float(edge[1])), ring, fill=False, color=style.GREY, zorder=7)
    sheet.axes.add_patch(circle)
    end = edge + 1.0 * sheet.cm * away
    sheet.line(edge + ring * away, end, color=style.GREY)
    sheet.text(end, words, tuple(0.3 * away), on=BASE_COLOUR)


def _name_points(sheet: Sheet, pose: Pose) -> None:
    names = ("$B_1$", "$D_1$", "$D_2$", "$B_2$", "$A_1$", "$A_2$")
    shifts = ((0.3, 0.22), (0.33, 0.12), (-0.3, 0.15), (-0.32, -0.14), (-0.3, -0.4), (-0.35, 0.38))
    points = [*pose.corners(), pose.edge(RIGHT_EDGE), pose.edge(LEFT_EDGE)]
    for point, name, shift in zip(points, names, shifts, strict=True):
        sheet.point(point, name, shift, 3.0)


def _mark_sizes(sheet: Sheet, pose: Pose) -> None:
    """Mark A and B of the part, L of the slot."""
    cm, p = sheet.cm, pose.constants
    above, beside, low = p.half_height + 0.55 * cm, -p.half_width - 0.7 * cm, -1.1 * cm
    sheet.chain(pose.at(0, above + 0.15 * cm), pose.at(0, -p.half_height))
    sheet.line(pose.at(p.half_width, p.half_height), pose.at(p.half_width, above + 0.15 * cm))
    sheet.dimension(pose.at(0, above), pose.at(p.half_width, above), "$A$", (0, 0.28))
    sheet.line(pose.centre, pose.at(beside - 0.15 * cm, 0))
    sheet.line(pose.at(-p.half_width, p.half_height), pose.at(beside - 0.15 * cm, p.half_height))
    sheet.dimension(pose.at(beside, 0), pose.at(beside, p.half_height), "$B$")
    sheet.chain((0, 0), (0, low - 0.15 * cm))
    sheet.dimension((0, low), (p.slot_half_width, low), "$L$", (0, -0.25))


# --- (b), (c) An edge in a face -----------------------------------------------------------------


class _Detail(NamedTuple):
    """A detail of an edge in a face: the base yields along the face's normal."""

    title: str
    side: float  # LEFT_EDGE or RIGHT_EDGE
    axis: int  # of the face's normal: 0 along e_t, 1 along e_n
    across: int  # spring and dashpot are side by side forwards (1) or backwards (-1) along the face
    recess: tuple[float, float]  # its extent from the edge along X and Y, in centimetres
    corner: int  # the row of ``Pose.corners``
    names: tuple[str, str, str, str]  # of the depth, the normal, the edge and the corner
    shifts: tuple[tuple[float, float], ...]  # of the last three


_AT_BOTTOM = _Detail(
    "(b)  edge $A_1$ in the bottom face", RIGHT_EDGE, 1, 1, (_RECESS_ALONG, -_RECESS_DEEP), 0,
    ("d", "$e_n$", "$A_1$", "$B_1$"), ((0.3, -0.05), (0.35, 0.22), (0.3, -0.2)),
)  # fmt: skip
_AT_SIDE = _Detail(
    "(c)  edge $A_2$ in the left side face", LEFT_EDGE, 0, -1, (-_RECESS_DEEP, -_RECESS_ALONG), 3,
    ("w", "$e_t$", "$A_2$", "$B_2$"), ((0.05, 0.28), (0.25, -0.3), (0.6, 0.36)),
)  # fmt: skip


def _draw_detail(sheet: Sheet, pose: Pose, it: _Detail) -> None:
    cm, edge, axis = sheet.cm, pose.edge(it.side), it.axis
    directions = pose.along_face, pose.along_axis
    normal, across = directions[axis], it.across * directions[1 - axis]
    half = (pose.constants.half_width, pose.constants.half_height)[axis]
    foot = edge - (pose.edge_place(it.side)[axis] + half) * normal
    depth, *names = it.names
    _draw_recess(sheet, edge, *(cm * each for each in it.recess))
    sheet.part(pose)
    _draw_yielding(sheet, foot, -normal, across, (axis, edge[axis] - _RECESS_DEEP * cm))
    _mark_depth(sheet, edge, foot, -0.6 * cm * across, f"${depth}$")
    head = edge + 1.1 * cm * normal
    sheet.arrow(edge, head, width=FORCE, color=CONTACT, zorder=7)
    colours = CONTACT, style.BLACK, style.BLACK
    places = head, edge, pose.corners()[it.corner]
    for place, name, shift, colour in zip(places, names, it.shifts, colours, strict=True):
        sheet.text(place, name, shift, color=colour)
    law = f"$N = K_a {depth} + H_a {depth}^{{\\,\\prime}}$,   ${depth}$ enlarged"
    _frame_detail(sheet, it.title, law)


def _draw_recess(sheet: Sheet, edge: Point, wide: float, deep: float) -> None:
    """Draw the base without the material at its edge, whose undeformed outline is dashed.

    The recess runs from the edge to ``wide`` along X and to ``deep`` along Y.
    """
    inner = edge + xy(wide, deep)
    low = sheet.axes.get_ylim()[0] - sheet.cm  # cut off by the panel's frame
    far = edge[0] + np.sign(wide) * 20 * sheet.cm
    wide_end, deep_end = xy(inner[0], 0.0), xy(edge[0], inner[1])
    profile = [xy(far, 0.0), wide_end, inner, deep_end, xy(edge[0], low)]
    sheet.cut([*profile, xy(far, low)])
    sheet.line(*profile, width=OUTLINE)
    sheet.line(wide_end, edge, deep_end, linestyle=(0, (4, 2)), label="base")
    sheet.dot(edge, zorder=8)


def _draw_yielding(
    sheet: Sheet, foot: Point, away: Point, across: Point, wall: tuple[int, float]
) -> None:
    """Draw the spring and the dashpot that carry ``foot``, on the wall of the recess.

    They lie along ``away``, one beside the other along ``across``. ``wall``: index (0 or 1) and
    value of the coordinate that is constant on the wall.
    """
    axis, stand = wall
    cm = sheet.cm
    bar = foot + 0.25 * cm * away
    sheet.line(foot, bar, bar + 1.2 * cm * across, width=OUTLINE, color=SUSPENSION)
    for place, link, words in ((0.25, sheet.spring, "$K_a$"), (1.2, sheet.damper, "$H_a$")):
        start = bar + place * cm * across
        stop = start + (stand - start[axis]) / away[axis] * away
        link(start, stop)
        sheet.text((start + stop) / 2, words, tuple(0.46 * across), color=SUSPENSION)
    sheet.dot(foot, 3.0, color=SUSPENSION)


def _mark_depth(sheet: Sheet, edge: Point, foot: Point, aside: Point, words: str) -> None:
    sheet.line(edge, edge + 1.2 * aside)
    sheet.line(foot, foot + 1.2 * aside)
    sheet.dimension(edge + aside, foot + aside, words, tuple(0.3 * aside / np.hypot(*aside)))


def _frame_detail(sheet: Sheet, title: str, law: str) -> None:
    """Write title and law over a detail, and frame it where part and base are cut off."""
    box: dict[str, Any] = {"transform": sheet.axes.transAxes, "clip_on": False}
    sheet.axes.text(0.0, 1.14, title, va="bottom", ha="left", **box)
    sheet.axes.text(0.0, 1.03, f"       {law}", va="bottom", ha="left", **box)
    border = Rectangle((0, 0), 1, 1, fill=False, zorder=10, **box)
    border.set(edgecolor=style.GREY, linewidth=0.8)
    sheet.axes.add_patch(border)
