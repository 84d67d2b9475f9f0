"""Fig. 3: forces and moments on the part; each symbol counts along its arrow."""

from math import pi
from typing import Any

from matplotlib.figure import Figure

from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Parameters
from study.schematics.sheet import Scheme, new_scheme
from vibralign.plots import style
from vibralign.plots.pose import towards, xy

_PUSHED = "$N$ along $e_n$\n$\\mu N$ along $+e_t$, while\nthe part slides to the slot"
_INERTIA = r"$M X_C^{\prime\prime},\ \ M Y_C^{\prime\prime},\ \ I \varphi^{\prime\prime}$"
_ELASTIC = "$F_x = R_X$\n$F_y = R_Y + F_1\\,\\sin\\,\\omega t$\n$T_\\varphi$"
_FORCES = (
    (Scheme.SUSPENSION, "suspension", _ELASTIC),
    (style.BLACK, "gravity, press force", "$Mg = F_0$"),
    (Scheme.INERTIA, "inertia (d'Alembert)", _INERTIA),
    (Scheme.CONTACT, "contact with the edge $A_1$", _PUSHED),
)


@style.context()
def draw(parameters: Parameters) -> Figure:
    """Draw the part with its forces and moments."""
    sheet = new_scheme(parameters, 7.2, -5.4, -2.6, above=1.5, least=8.2)
    sheet.base(reach=3.2, depth=1.7)
    sheet.part()
    _draw_directions(sheet)
    _draw_forces(sheet)
    _mark_arms_and_tilt(sheet)
    _explain_forces(sheet)
    return sheet.figure


def _draw_directions(sheet: Scheme) -> None:
    """Draw X and Y of the base, e_t and e_n of the part, away from the forces."""
    root = xy(-sheet.a - 3.0 * sheet.cm, 0.7 * sheet.cm)
    along_face, along_axis = sheet.pose.axes
    for direction, words, shift, colour in (
        (xy(1, 0), "$X$", (0.15, -0.18), style.BLACK),
        (xy(0, 1), "$Y$", (0.2, 0.15), style.BLACK),
        (along_face, "$e_t$", (0.1, 0.27), style.GREY),
        (along_axis, "$e_n$", (-0.22, 0.18), style.GREY),
    ):
        head = root + 1.2 * sheet.cm * direction
        sheet.arrow(root, head, words, shift, width=Scheme.THIN, color=colour)


def _draw_forces(sheet: Scheme) -> None:
    """Draw forces and moments at C, and the force and friction of the edge A1.

    Elastic forces end at C, the weight begins there, and inertia is on the same lines. Moments are
    drawn clockwise: they resist φ, which counts counter-clockwise.
    """
    cm, c, edge = sheet.cm, sheet.pose.centre, sheet.pose.edge(RIGHT_EDGE)
    side, up, (e_t, e_n) = xy(sheet.a + 1.9 * cm, 0), xy(0, cm), sheet.pose.axes
    weight, drag = c - 1.3 * up, (sheet.a + 0.9 * cm) * e_t
    inward: dict[str, Any] = {"heads": "<|-"}  # its name is by its tail
    inside: dict[str, Any] = {"ha": "left", "on": Scheme.PART}
    below: dict[str, Any] = {**inward, "on": Scheme.BASE, "zorder": 7}
    for start, stop, words, shift, colour, look in (
        (c, c + side, "$F_x$", (-0.2, 0.28), Scheme.SUSPENSION, inward),
        (c, c + 2.1 * up, "$F_y$", (0.3, -0.2), Scheme.SUSPENSION, inward),
        (c, weight, "$Mg$", (0.17, 0.4), style.BLACK, inside),
        (c, c - side, r"$M X_C^{\prime\prime}$", (0.35, 0.32), Scheme.INERTIA, {}),
        (weight, weight - up, r"$M Y_C^{\prime\prime}$", (0.17, 0.4), Scheme.INERTIA, inside),
        (edge, edge - 1.5 * cm * e_n, "$N$", (0.35, 0.12), Scheme.CONTACT, below),
        (edge, edge + drag, r"$\mu N$", (0.05, 0.3), Scheme.CONTACT, {"zorder": 7}),
    ):
        sheet.arrow(start, stop, words, shift, color=colour, **look)
    radius = sheet.a + 0.75 * cm
    for first, last, words, colour in (
        (1.15, 0.2, r"$T_\varphi$", Scheme.SUSPENSION),
        (pi - 0.2, pi - 1.15, r"$I\varphi^{\prime\prime}$", Scheme.INERTIA),
    ):
        sheet.arc(c, radius, first, last, width=Scheme.FORCE, color=colour)
        away = (radius + 0.45 * cm) * towards((first + last) / 2)
        sheet.text(c + away, words, color=colour)
    sheet.point(c, "$C$", (-0.25, -0.28))
    sheet.point(edge, "$A_1$", (-0.3, -0.35), zorder=8)
    sheet.point(sheet.pose.edge(LEFT_EDGE), "$A_2$", (-0.3, 0.28))


def _mark_arms_and_tilt(sheet: Scheme) -> None:
    """Mark the arms about C, Q along the bottom face and B along the axis, and φ over the top."""
    c, edge, b = sheet.pose.centre, sheet.pose.edge(RIGHT_EDGE), sheet.b
    place = sheet.pose.edge_place(RIGHT_EDGE).along_face / sheet.a
    sheet.dimension(sheet.at(-0.74, 0), sheet.at(-0.74, -1), "$B$", feet=[c], on=Scheme.PART)
    sheet.chain(c, sheet.at(0, -1))
    arm = sheet.at(place, -1, 0, 0.75), sheet.at(0, -1, 0, 0.75)
    sheet.dimension(*arm, "$Q$", (0, 0.25), feet=[edge], outside=True)
    sheet.chain(c, sheet.at(0, 1, 0, 1.3))
    sheet.chain(c, c + xy(0, b + 1.3 * sheet.cm))
    sheet.tilt(c, b + 0.8 * sheet.cm, pi / 2, 0.3)


def _explain_forces(sheet: Scheme) -> None:
    place = sheet.cm * xy(5.4, sheet.top - 1.0)
    for colour, title, symbols in _FORCES:
        sheet.text(place, title, ha="left", va="top", color=colour, fontweight="bold")
        sheet.text(place, symbols, (0.0, -0.5), ha="left", va="top", linespacing=1.5)
        place -= xy(0, (1.35 + 0.52 * symbols.count("\n")) * sheet.cm)
    words = "Each symbol counts along\nits arrow; eqs (1) balance them."
    sheet.text(place, words, ha="left", va="top", fontsize=8, color=style.GREY)
