"""Fig. 2: dynamic model: the part on its suspension, the excited upper support, the base."""

from math import asin

from matplotlib.figure import Figure

from model.physics.parameters import Parameters
from model.show import style
from model.show.schematics.pose import Pose, resting_pose, towards, xy
from model.show.schematics.sheet import (
    EXCITATION,
    FORCE,
    OUTLINE,
    SUSPENSION,
    Sheet,
    centimetre,
    new_sheet,
)

CAPTION = (
    "Dynamic model: a part on springs and dampers, pressed on a base with a slot by F0 "
    "and excited through its upper support by Y sin ωt. K_X = K_X1 + … + K_X4, "
    "K_Y = K_Y1 + K_Y2. Part and slot are to scale; the tilt is enlarged."
)


def draw(parameters: Parameters) -> Figure:
    """Draw the part on its suspension."""
    pose = resting_pose(parameters)
    with style.context():
        cm = centimetre(pose, 7.0)
        plate = pose.top / cm + 1.7
        figure, sheet = new_sheet(cm, -8.0, -2.5, plate + 4.1)
        sheet.base(pose, reach=5.2, depth=1.8)
        sheet.part(pose)
        left, right = _draw_support(sheet, pose, plate * cm)
        _draw_lateral_suspension(sheet, pose, left, right)
        _draw_axial_suspension(sheet, pose, plate * cm)
        _draw_tilt_suspension(sheet, pose, right)
        sheet.frame(pose.constants.half_width + 5.6 * cm, 1.5 * cm)
        _mark_coordinates(sheet, pose)
    return figure


def _draw_support(sheet: Sheet, pose: Pose, plate: float) -> tuple[float, float]:
    """Draw the vibrator's platform astride the part; return the inner faces of its two legs."""
    cm, middle = sheet.cm, float(pose.at(0, 0.6 * pose.constants.half_height)[0])
    half, thick, foot = pose.constants.half_width + 2.5 * cm, 0.32 * cm, pose.y + 0.2 * cm
    inner, outer = (middle - half, middle + half), (middle - half - thick, middle + half + thick)
    high = plate + thick
    outline = [(outer[0], foot), (outer[0], high), (outer[1], high), (outer[1], foot)]
    outline += [(inner[1], foot), (inner[1], plate), (inner[0], plate), (inner[0], foot)]
    sheet.area(outline, "#E4E4E4")
    shake = xy(middle, high + 0.12 * cm)
    sheet.arrow(shake, shake + xy(0, 0.95 * cm), heads="<|-|>", width=FORCE, color=EXCITATION)
    words = r"$Y(t) = Y\,\sin\,\omega t$"
    sheet.text(shake + xy(0, 0.5 * cm), words, (0.25, 0), ha="left", color=EXCITATION)
    return inner


def _draw_lateral_suspension(sheet: Sheet, pose: Pose, left: float, right: float) -> None:
    a, b = pose.constants.half_width, pose.constants.half_height
    for level, face, leg, words in (
        (0.88, -a, left, "$K_{X_1}$"),
        (0.88, a, right, "$K_{X_2}$"),
        (0.36, -a, left, "$K_{X_3}$"),
        (0.36, a, right, "$K_{X_4}$"),
        (0.62, -a, left, "$H_X$"),
    ):
        hold = pose.at(face, level * b)
        if words == "$H_X$":
            sheet.damper((leg, hold[1]), hold)
        else:
            sheet.spring((leg, hold[1]), hold, coils=6)
        sheet.text(((leg + hold[0]) / 2, hold[1]), words, (0, 0.4), color=SUSPENSION)
        sheet.dot(hold, 2.5, color=SUSPENSION)


def _draw_axial_suspension(sheet: Sheet, pose: Pose, plate: float) -> None:
    a, b = pose.constants.half_width, pose.constants.half_height
    for place, words, shift in ((-0.9, "K_{Y_1}", -0.5), (0.0, "H_Y", 0.31), (0.9, "K_{Y_2}", 0.5)):
        hold = pose.at(place * a, b)
        link = sheet.damper if place == 0.0 else sheet.spring
        link((hold[0], plate), hold)
        # The damper's symbol is by its rod, where there is room between the springs.
        level = plate - 0.35 * sheet.cm if place == 0.0 else (plate + hold[1]) / 2
        sheet.text((hold[0], level), f"${words}$", (shift, 0), color=SUSPENSION)
        sheet.dot(hold, 2.5, color=SUSPENSION)


def _draw_tilt_suspension(sheet: Sheet, pose: Pose, leg: float) -> None:
    """Draw spiral spring and bent dashpot about C, both held by a bracket on the support."""
    bracket, outer = 0.36 * sheet.cm, 0.85 * sheet.cm
    end = sheet.spiral(pose.centre, (0.05, 0.58), asin(0.36 / 0.58))
    grip = asin(bracket / outer)
    loose = grip + 1.75
    sheet.bent_damper(pose.centre, outer, grip, loose)
    sheet.dot(pose.centre + outer * towards(loose), 2.5, color=SUSPENSION)
    sheet.line(end, (leg, end[1]), width=OUTLINE, zorder=4)
    middle = ((leg + pose.at(pose.constants.half_width, 0)[0]) / 2, end[1])
    sheet.text(middle, r"$K_\varphi,\ H_\varphi$", (0, -0.33), color=SUSPENSION)


def _mark_coordinates(sheet: Sheet, pose: Pose) -> None:
    """Mark C with X_C and Y_C, the press force, and φ between the bottom face and the base."""
    cm, low = sheet.cm, -1.25 * sheet.cm
    sheet.point(pose.centre, "$C$", (-0.5, -0.55))
    sheet.line(pose.centre, (pose.x, low - 0.15 * cm))
    sheet.line((0, -0.5 * cm), (0, low - 0.15 * cm))
    sheet.dimension((0, low), (pose.x, low), "$X_C$", (0.42, -0.25), outside=True)
    far = -pose.constants.half_width - 1.7 * cm
    sheet.line(pose.centre, (far - 0.15 * cm, pose.y))
    sheet.dimension((far, 0), (far, pose.y), "$Y_C$")
    press = pose.centre - xy(0, 1.5 * cm)
    sheet.vector(pose.centre, press, "$F_0$", (0.18, 0.25), ha="left")
    sheet.text(pose.at(0, 0.62 * pose.constants.half_height), "$M,\\ I$")
    sheet.tilt_of_face(pose, reach=2.6)
