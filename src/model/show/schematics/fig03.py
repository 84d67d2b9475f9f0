"""Fig. 3: forces and moments on the part; each symbol counts along its arrow."""

from math import pi
from typing import Any

from matplotlib.figure import Figure

from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Parameters
from model.show import style
from model.show.schematics.pose import Pose, resting_pose, towards, xy
from model.show.schematics.sheet import (
    BASE_COLOUR,
    CONTACT,
    FORCE,
    INERTIA,
    PART_COLOUR,
    SUSPENSION,
    THIN,
    Sheet,
    centimetre,
    new_sheet,
)

CAPTION = (
    "Forces and moments on the part in contact with the base, reduced to the mass centre "
    "C; each symbol counts along its arrow. The edge A1 pushes along e_n and, while the part "
    "slides towards the slot, drags it along +e_t, away from the slot (the consistent reading). "
    "The tilt is enlarged."
)
_FORCES = (
    (SUSPENSION, "suspension", "$F_x = R_X$\n$F_y = R_Y + F_1\\,\\sin\\,\\omega t$\n$T_\\varphi$"),
    (style.BLACK, "gravity, press force", "$Mg = F_0$"),
    (
        INERTIA,
        "inertia (d'Alembert)",
        "$M X_C^{\\prime\\prime},\\ \\ M Y_C^{\\prime\\prime},\\ \\ I \\varphi^{\\prime\\prime}$",
    ),
    (
        CONTACT,
        "contact with the edge $A_1$",
        "$N$ along $e_n$\n$\\mu N$ along $+e_t$, while\nthe part slides to the slot",
    ),
)


def draw(parameters: Parameters) -> Figure:
    """Draw the part with its forces and moments."""
    pose = resting_pose(parameters)
    with style.context():
        cm = centimetre(pose, 7.2)
        top = max(pose.top / cm + 1.5, 8.2)
        figure, sheet = new_sheet(cm, -5.4, -2.6, top + 2.6)
        sheet.base(pose, reach=3.2, depth=1.7)
        sheet.part(pose)
        _draw_directions(sheet, pose)
        _draw_forces_at_centre(sheet, pose)
        _draw_moments(sheet, pose)
        _draw_contact_forces(sheet, pose)
        _mark_arms(sheet, pose)
        _mark_tilt(sheet, pose)
        _explain_forces(sheet, top)
    return figure


def _draw_directions(sheet: Sheet, pose: Pose) -> None:
    """Draw X and Y of the base, e_t and e_n of the part, away from the forces."""
    length = 1.2 * sheet.cm
    root = xy(-pose.constants.half_width - 3.0 * sheet.cm, 0.7 * sheet.cm)
    for direction, words, shift, colour in (
        (xy(1, 0), "$X$", (0.15, -0.18), style.BLACK),
        (xy(0, 1), "$Y$", (0.2, 0.15), style.BLACK),
        (pose.along_face, "$e_t$", (0.1, 0.27), style.GREY),
        (pose.along_axis, "$e_n$", (-0.22, 0.18), style.GREY),
    ):
        sheet.vector(root, root + length * direction, words, shift, width=THIN, color=colour)


def _draw_forces_at_centre(sheet: Sheet, pose: Pose) -> None:
    """Draw elastic forces up to C, the weight from there, and inertia on the same line."""
    cm, c = sheet.cm, pose.centre
    side = pose.constants.half_width + 1.9 * cm
    right, left = c + xy(side, 0), c - xy(side, 0)
    up, down = c + xy(0, 2.1 * cm), c - xy(0, 1.3 * cm)
    lower = down - xy(0, 1.0 * cm)
    beside: dict[str, Any] = {"ha": "left", "on": PART_COLOUR}
    sheet.vector(right, c, "$F_x$", (-0.2, 0.28), at=right, color=SUSPENSION)
    sheet.vector(up, c, "$F_y$", (0.3, -0.2), at=up, color=SUSPENSION)
    sheet.vector(c, down, "$Mg$", (0.17, 0.4), **beside)
    sheet.vector(c, left, r"$M X_C^{\prime\prime}$", (0.35, 0.32), color=INERTIA)
    sheet.vector(down, lower, r"$M Y_C^{\prime\prime}$", (0.17, 0.4), color=INERTIA, **beside)
    sheet.point(c, "$C$", (-0.25, -0.28))


def _draw_moments(sheet: Sheet, pose: Pose) -> None:
    """Draw the moments clockwise: they resist φ, which counts counter-clockwise."""
    radius = pose.constants.half_width + 0.75 * sheet.cm
    for start, stop, words, colour in (
        (1.15, 0.2, r"$T_\varphi$", SUSPENSION),
        (pi - 0.2, pi - 1.15, r"$I\varphi^{\prime\prime}$", INERTIA),
    ):
        sheet.arc(pose.centre, radius, start, stop, width=FORCE, color=colour)
        middle, away = (start + stop) / 2, radius + 0.45 * sheet.cm
        sheet.text(pose.centre + away * towards(middle), words, color=colour)


def _draw_contact_forces(sheet: Sheet, pose: Pose) -> None:
    """Draw the force of the edge along e_n, and its friction along e_t."""
    cm, edge = sheet.cm, pose.edge(RIGHT_EDGE)
    tail = edge - 1.5 * cm * pose.along_axis
    contact: dict[str, Any] = {"color": CONTACT, "zorder": 7}
    sheet.vector(tail, edge, "$N$", (0.35, 0.12), at=tail, **contact, on=BASE_COLOUR)
    drag = edge + (pose.constants.half_width + 0.9 * cm) * pose.along_face
    sheet.vector(edge, drag, r"$\mu N$", (0.05, 0.3), **contact)
    sheet.point(edge, "$A_1$", (-0.3, -0.35), zorder=8)
    sheet.point(pose.edge(LEFT_EDGE), "$A_2$", (-0.3, 0.28))


def _mark_arms(sheet: Sheet, pose: Pose) -> None:
    """Mark the arms of the contact forces about C: Q along the bottom face, B along the axis."""
    cm, b = sheet.cm, pose.constants.half_height
    q = pose.edge_place(RIGHT_EDGE).along_face
    far, above = -0.74 * pose.constants.half_width, -b + 0.75 * cm
    sheet.line(pose.centre, pose.at(far - 0.15 * cm, 0))
    sheet.dimension(pose.at(far, -b), pose.at(far, 0), "$B$", on=PART_COLOUR)
    sheet.chain(pose.centre, pose.at(0, -b))
    sheet.line(pose.edge(RIGHT_EDGE), pose.at(q, above + 0.15 * cm))
    sheet.dimension(pose.at(0, above), pose.at(q, above), "$Q$", (0, 0.25), outside=True)


def _mark_tilt(sheet: Sheet, pose: Pose) -> None:
    """Mark φ between the vertical through C and the axis of the part, over its top."""
    reach = pose.constants.half_height + 0.8 * sheet.cm
    end = reach + 0.5 * sheet.cm
    sheet.chain(pose.centre, pose.at(0, end))
    sheet.chain(pose.centre, pose.centre + xy(0, end))
    sheet.tilt(pose, pose.centre, reach, pi / 2, 0.3)


def _explain_forces(sheet: Sheet, top: float) -> None:
    x, y = 5.4 * sheet.cm, (top - 1.0) * sheet.cm
    for colour, title, symbols in _FORCES:
        sheet.text((x, y), title, ha="left", va="top", color=colour, fontweight="bold")
        sheet.text((x, y), symbols, (0.0, -0.5), ha="left", va="top", linespacing=1.5)
        y -= (1.35 + 0.52 * symbols.count("\n")) * sheet.cm
    words = "Each symbol counts along\nits arrow; eqs (1) balance them."
    sheet.text((x, y), words, ha="left", va="top", fontsize=8, color=style.GREY)
