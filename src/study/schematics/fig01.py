"""Fig. 1: scheme of the device, numbered as in the paper."""

from math import pi
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Parameters
from study.schematics.sheet import Scheme, new_scheme
from vibralign.plots import style
from vibralign.plots.pose import xy

_KEY = (  # each with its distance below the upper end of the page (cm)
    (1.2, "1  robot arm"),
    (1.75, "2  housing of the\n    electromagnetic vibrator"),
    (2.7, "3  electromagnet"),
    (3.25, "4  gripper holder (elastic)"),
    (3.8, "5  gripper"),
    (4.35, "6  peg"),
    (4.9, "7  bushing"),
    (5.9, "$\\Delta$  axial misalignment\n$\\varphi$  tilt (enlarged)"),
)
_GREY, _DARK, _COPPER = "#D2D2D2", "#C6C6C6", "#E3B98A"
# The vibrator from the platform up, as left, right, low and high (cm) and colour.
_VIBRATOR = (
    (-1.75, 1.75, 0.45, 2.95, _GREY),  # the housing
    (-1.5, 1.5, 0.7, 2.7, "white"),
    (-0.3, 0.3, 0.45, 0.7, "white"),  # opening for the rod in the floor of the housing
    (-0.15, 0.15, 0.0, 1.0, Scheme.DEVICE),  # the rod, and the armature on it
    (-1.0, 1.0, 0.95, 1.2, Scheme.DEVICE),
    (-1.0, 1.0, 2.2, 2.7, _DARK),  # the electromagnet
    (-1.0, -0.6, 1.4, 2.2, _DARK),
    (-0.2, 0.2, 1.4, 2.2, _DARK),
    (0.6, 1.0, 1.4, 2.2, _DARK),
    (-0.6, -0.2, 1.6, 2.1, _COPPER),  # its coil, cut
    (0.2, 0.6, 1.6, 2.1, _COPPER),
    (-0.5, 0.5, 2.95, 3.35, Scheme.DEVICE),  # the robot arm
    (-3.4, 0.9, 3.35, 3.95, Scheme.DEVICE),
)


@style.context()
def draw(parameters: Parameters) -> Figure:
    """Draw the device over the bushing."""
    sheet = new_scheme(parameters, 6.2, -4.7, -3.2, above=6.3)
    _draw_bushing(sheet)
    sheet.part()
    _draw_device(sheet)
    _mark_misalignment(sheet)
    for drop, words in _KEY:
        sheet.text(sheet.cm * xy(5.4, sheet.top - drop), words, ha="left", va="top")
    return sheet.figure


def _draw_bushing(sheet: Scheme) -> None:
    cm, half = sheet.cm, sheet.half
    far, floor = half + 1.5 * cm, -2.0 * cm
    for side in (RIGHT_EDGE, LEFT_EDGE):
        wall = [(side * half, 0), (side * far, 0), (side * far, floor), (side * half, floor)]
        sheet.cut(wall, edgecolor=style.GREY)
        sheet.line(*wall, wall[0], width=Scheme.OUTLINE, label="base")
    for rim in (0.0, floor):  # the far half of the bore's rims, seen behind the peg
        sheet.line((-half, rim), (half, rim), zorder=1.5)
    sheet.ground((-far - 0.5 * cm, floor), (-half, floor))
    sheet.ground((half, floor), (far + 0.5 * cm, floor))
    sheet.leader((far - 0.4 * cm, -0.9 * cm), (1.3, 0.4), "7")


def _draw_device(sheet: Scheme) -> None:
    """Draw the gripper round the peg's upper part, the platform on springs, vibrator and arm."""
    x, cm = sheet.pose.x, sheet.cm
    jaw = (1, 0.3), (1, 0.3, 0.4), (1, 1, 0.4, 0.45)
    other = (-1, 1, -0.4, 0.45), (-1, 0.3, -0.4), (-1, 0.3)
    sheet.area([sheet.at(*each) for each in (*jaw, *other, (-1, 1), (1, 1))], Scheme.DEVICE)
    low = float(sheet.at(1, 1, 0, 0.45)[1]) + 1.15 * cm
    platform = xy(x, low + 0.3 * cm)
    for face in (-0.8, 0.0, 0.8):
        foot = sheet.at(face, 1, 0, 0.45)
        sheet.spring(foot, (foot[0], low), coils=4, color=style.BLACK)
    half = sheet.a / cm + 0.9
    for left, right, lower, upper, colour in ((-half, half, -0.3, 0.0, Scheme.DEVICE), *_VIBRATOR):
        corners = (left, lower), (right, lower), (right, upper), (left, upper)
        sheet.area(platform + cm * np.array(corners), colour)
    height = np.linspace(3.35, 3.95, 41)  # of the wavy end of the arm, which goes on beyond it
    wave = 0.08 * np.sin(2 * pi * (height - 3.35) / 0.6) - 3.4
    sheet.line(*(platform + cm * np.array([[-3.4, 3.35], [-3.4, 3.95]])), width=2.5, color="white")
    sheet.line(*(platform + cm * np.column_stack([wave, height])))
    low_end, high_end = (platform + cm * xy(half + 0.45, height) for height in (-0.7, 0.4))
    look: dict[str, Any] = {"ha": "left", "color": Scheme.EXCITATION, "width": Scheme.THIN}
    words = r"$Y\,\sin\,\omega t$"
    sheet.arrow(low_end, high_end, words, (0.15, -0.55), heads="<|-|>", **look)
    for number, point, way in (
        ("1", platform + cm * xy(0.6, 3.65), (1.7, 0.25)),
        ("2", platform + cm * xy(1.62, 2.5), (0.98, 0.35)),
        ("3", platform + cm * xy(0.8, 1.85), (1.8, -0.2)),
        ("4", sheet.at(0.8, 1, 0, 0.45) + cm * xy(0, 0.55), (1.5, -0.25)),
        ("5", sheet.at(1, 0.6, 0.2), (1.1, 0.45)),
        ("6", sheet.at(0.6, -0.25), (1.1 + 0.4 * sheet.a / cm, 0.45)),
    ):
        sheet.leader(point, way, number)


def _mark_misalignment(sheet: Scheme) -> None:
    """Mark Δ between the axes of bushing and device, and φ at the peg's lower end."""
    cm, low, centre = sheet.cm, -2.75 * sheet.cm, sheet.pose.centre
    sheet.chain((0, 0.6 * cm), (0, low - 0.2 * cm))
    sheet.chain(centre, (centre[0], low - 0.2 * cm))
    sheet.dimension((0, low), (centre[0], low), r"$\Delta$", (0.88, 0.0), outside=True)
    sheet.chain(sheet.at(0, 0.2), sheet.at(0, -1, 0, -1.8))
    sheet.point(centre, "$C$", (-0.25, 0.05))
    sheet.tilt(centre, sheet.b + 1.2 * cm, -pi / 2, 0.28)
