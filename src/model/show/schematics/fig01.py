"""Fig. 1: scheme of the device, numbered as in the paper."""

from math import pi

import numpy as np
from matplotlib.figure import Figure

from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Parameters
from model.show import style
from model.show.schematics.pose import Pose, resting_pose, xy
from model.show.schematics.sheet import EXCITATION, OUTLINE, THIN, Sheet, centimetre, new_sheet

CAPTION = (
    "Scheme of vibratory alignment under kinematical excitation: 1 robot arm, 2 housing "
    "of the electromagnetic vibrator, 3 electromagnet, 4 gripper holder (elastic), 5 gripper, "
    "6 peg, 7 bushing; Δ axial misalignment, φ tilt. Peg, bushing and Δ are to scale; the tilt is "
    "enlarged."
)
_KEY = (
    "1  robot arm",
    "2  housing of the\n    electromagnetic vibrator",
    "3  electromagnet",
    "4  gripper holder (elastic)",
    "5  gripper",
    "6  peg",
    "7  bushing",
)
_LIGHT, _GREY, _DARK, _COPPER = "#E4E4E4", "#D2D2D2", "#C6C6C6", "#E3B98A"
# The vibrator from the platform up, as left, right, low and high (cm) and colour.
_VIBRATOR = (
    (-1.75, 1.75, 0.45, 2.95, _GREY),  # the housing
    (-1.5, 1.5, 0.7, 2.7, "white"),
    (-0.3, 0.3, 0.45, 0.7, "white"),  # opening for the rod in the floor of the housing
    (-0.15, 0.15, 0.0, 1.0, _LIGHT),  # the rod, and the armature on it
    (-1.0, 1.0, 0.95, 1.2, _LIGHT),
    (-1.0, 1.0, 2.2, 2.7, _DARK),  # the electromagnet
    (-1.0, -0.6, 1.4, 2.2, _DARK),
    (-0.2, 0.2, 1.4, 2.2, _DARK),
    (0.6, 1.0, 1.4, 2.2, _DARK),
    (-0.6, -0.2, 1.6, 2.1, _COPPER),  # its coil, cut
    (0.2, 0.6, 1.6, 2.1, _COPPER),
    (-0.5, 0.5, 2.95, 3.35, _LIGHT),  # the robot arm
    (-3.4, 0.9, 3.35, 3.95, _LIGHT),
)


def draw(parameters: Parameters) -> Figure:
    """Draw the device over the bushing."""
    pose = resting_pose(parameters)
    with style.context():
        cm = centimetre(pose, 6.2)
        top = pose.top / cm + 6.3
        figure, sheet = new_sheet(cm, -4.7, -3.2, top + 3.2)
        _draw_bushing(sheet, pose)
        sheet.part(pose)
        palm = _draw_gripper(sheet, pose)
        platform = _draw_holder(sheet, pose, palm)
        _draw_vibrator(sheet, pose.x, platform)
        _mark_misalignment(sheet, pose)
        _write_key(sheet, top)
    return figure


def _draw_bushing(sheet: Sheet, pose: Pose) -> None:
    cm, half = sheet.cm, pose.constants.slot_half_width
    far, floor = half + 1.5 * cm, -2.0 * cm
    for side in (RIGHT_EDGE, LEFT_EDGE):
        wall = [(side * half, 0), (side * far, 0), (side * far, floor), (side * half, floor)]
        sheet.cut(wall, edgecolor=style.GREY)
        sheet.line(*wall, wall[0], width=OUTLINE, label="base")
    for rim in (0.0, floor):  # the far half of the bore's rims, seen behind the peg
        sheet.line((-half, rim), (half, rim), zorder=1.5)
    sheet.ground((-far - 0.5 * cm, floor), (-half, floor))
    sheet.ground((half, floor), (far + 0.5 * cm, floor))
    sheet.leader((far - 0.4 * cm, -0.9 * cm), (far + 0.9 * cm, -0.5 * cm), "7")


def _draw_gripper(sheet: Sheet, pose: Pose) -> float:
    """Draw the jaws around the upper part of the peg; return the height of the palm, along e_n."""
    cm, a, b = sheet.cm, pose.constants.half_width, pose.constants.half_height
    far, low, palm = a + 0.4 * cm, 0.3 * b, b + 0.45 * cm
    outline = [(-a, low), (-far, low), (-far, palm), (far, palm), (far, low), (a, low)]
    outline += [(a, b), (-a, b)]
    sheet.area([pose.at(*place) for place in outline], _LIGHT)
    grip = pose.at(far - 0.2 * cm, 0.6 * b)
    sheet.leader(grip, grip + xy(1.1, 0.45) * cm, "5")
    peg = pose.at(0.6 * a, -0.25 * b)
    sheet.leader(peg, peg + xy(1.1 * cm + 0.4 * a, 0.45 * cm), "6")
    return palm


def _draw_holder(sheet: Sheet, pose: Pose, palm: float) -> float:
    """Draw the platform on its springs; return the height of its upper face."""
    cm, a = sheet.cm, pose.constants.half_width
    low = float(pose.at(a, palm)[1]) + 1.15 * cm
    high = low + 0.3 * cm
    left, right = pose.x - a - 0.9 * cm, pose.x + a + 0.9 * cm
    sheet.box(left, right, low, high, _LIGHT)
    for place in (-0.8, 0.0, 0.8):
        foot = pose.at(place * a, palm)
        sheet.spring(foot, (foot[0], low), coils=4, color=style.BLACK)
    spring = pose.at(0.8 * a, palm) + xy(0.0, 0.55 * cm)
    sheet.leader(spring, spring + xy(1.5, -0.25) * cm, "4")
    shaker = right + 0.45 * cm
    ends = (shaker, low - 0.4 * cm), (shaker, high + 0.4 * cm)
    sheet.arrow(*ends, heads="<|-|>", color=EXCITATION)
    words, middle = r"$Y\,\sin\,\omega t$", (shaker, (low + high) / 2)
    sheet.text(middle, words, (0.15, 0), ha="left", color=EXCITATION)
    return high


def _draw_vibrator(sheet: Sheet, x: float, platform: float) -> None:
    """Draw armature and rod over the platform, the electromagnet in its housing, the arm above."""
    cm = sheet.cm
    for left, right, low, high, colour in _VIBRATOR:
        sheet.box(x + left * cm, x + right * cm, platform + low * cm, platform + high * cm, colour)
    _break_line(sheet, x - 3.4 * cm, platform + 3.35 * cm, platform + 3.95 * cm)
    for number, point, end in (
        ("1", (0.6, 3.65), (2.3, 3.9)),
        ("2", (1.62, 2.5), (2.6, 2.85)),
        ("3", (0.8, 1.85), (2.6, 1.65)),
    ):
        base = xy(x, platform)
        sheet.leader(base + xy(*point) * cm, base + xy(*end) * cm, number)


def _break_line(sheet: Sheet, x: float, low: float, high: float) -> None:
    """Draw the wavy end of something that continues beyond the drawing."""
    height = np.linspace(low, high, 41)
    wave = x + 0.08 * sheet.cm * np.sin(2 * pi * (height - low) / (high - low))
    sheet.line((x, low), (x, high), width=2.5, color="white")
    sheet.line(*np.column_stack([wave, height]), width=THIN)


def _mark_misalignment(sheet: Sheet, pose: Pose) -> None:
    """Mark Δ between the axes of bushing and device, and φ at the peg's lower end."""
    cm, low, b = sheet.cm, -2.75 * sheet.cm, pose.constants.half_height
    sheet.chain((0, 0.6 * cm), (0, low - 0.2 * cm))
    sheet.chain((pose.x, pose.y), (pose.x, low - 0.2 * cm))
    sheet.dimension((0, low), (pose.x, low), r"$\Delta$", (0.88, 0.0), outside=True)
    reach = b + 1.2 * cm
    sheet.chain(pose.at(0, 0.2 * b), pose.at(0, -reach - 0.6 * cm))
    sheet.point(pose.centre, "$C$", (-0.25, 0.05))
    sheet.tilt(pose, pose.centre, reach, -pi / 2, 0.28)


def _write_key(sheet: Sheet, top: float) -> None:
    x, cm = 5.4 * sheet.cm, sheet.cm
    for row, words in enumerate(_KEY):
        drop = 0.55 * row + (0.4 if row > 1 else 0.0)
        sheet.text((x, (top - 1.2 - drop) * cm), words, ha="left", va="top")
    symbols = "$\\Delta$  axial misalignment\n$\\varphi$  tilt (enlarged)"
    sheet.text((x, (top - 5.9) * cm), symbols, ha="left", va="top")
