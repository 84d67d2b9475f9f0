"""Fig. 2: dynamic model: the part on its suspension, the excited upper support, the base."""

from math import asin, pi
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from model.physics.parameters import Parameters
from study.schematics.sheet import Scheme, new_scheme
from vibralign.plots import style
from vibralign.plots.pose import towards, xy

# The suspension: where it holds the part (half-widths, half-heights); its other end, on the left
# leg of the platform (-1), its right leg (1) or its plate (0); its symbol, and how far (cm) that is
# from the middle, or for H_Y from the plate.
_LINKS = (
    (-1.0, 0.88, -1, "K_{X_1}", (0.0, 0.4)),
    (1.0, 0.88, 1, "K_{X_2}", (0.0, 0.4)),
    (-1.0, 0.36, -1, "K_{X_3}", (0.0, 0.4)),
    (1.0, 0.36, 1, "K_{X_4}", (0.0, 0.4)),
    (-1.0, 0.62, -1, "H_X", (0.0, 0.4)),
    (-0.9, 1.0, 0, "K_{Y_1}", (-0.5, 0.0)),
    (0.0, 1.0, 0, "H_Y", (0.31, -0.35)),  # by its rod, where there is room between the springs
    (0.9, 1.0, 0, "K_{Y_2}", (0.5, 0.0)),
)


@style.context()
def draw(parameters: Parameters) -> Figure:
    """Draw the part on its suspension."""
    sheet = new_scheme(parameters, 7.0, -8.0, -2.5, above=3.3)
    sheet.base(reach=5.2, depth=1.8)
    sheet.part()
    _draw_support(sheet)
    sheet.frame(sheet.a + 5.6 * sheet.cm, 1.5 * sheet.cm)
    _mark_coordinates(sheet)
    return sheet.figure


def _draw_support(sheet: Scheme) -> None:
    """Draw the vibrator's platform astride the part, and the suspension between them."""
    cm, plate = sheet.cm, (sheet.top - 1.6) * sheet.cm
    middle, half = float(sheet.at(0, 0.6)[0]), sheet.a + 2.5 * cm
    foot, thick = sheet.pose.y + 0.2 * cm, 0.32 * cm
    outside, inside = (
        [(middle - wide, foot), (middle - wide, high), (middle + wide, high), (middle + wide, foot)]
        for wide, high in ((half + thick, plate + thick), (half, plate))
    )
    sheet.area([*outside, *inside[::-1]], Scheme.DEVICE)
    shake = xy(middle, plate + thick + 0.12 * cm)
    look: dict[str, Any] = {"ha": "left", "heads": "<|-|>", "color": Scheme.EXCITATION}
    words = r"$Y(t) = Y\,\sin\,\omega t$"
    sheet.arrow(shake, shake + xy(0, 0.95 * cm), words, (0.25, -0.45), **look)
    for face, axis, leg, symbol, shift in _LINKS:
        hold = sheet.at(face, axis)
        start = xy(middle + leg * half, hold[1]) if leg else xy(hold[0], plate)
        if symbol.startswith("H"):
            sheet.damper(start, hold)
        else:
            sheet.spring(start, hold, coils=6 if leg else 5)
        named = start if symbol == "H_Y" else (start + hold) / 2
        sheet.text(named, f"${symbol}$", shift, color=Scheme.SUSPENSION)
        sheet.point(hold, size=2.5, color=Scheme.SUSPENSION)
    _draw_tilt_suspension(sheet, middle + half)


def _draw_tilt_suspension(sheet: Scheme, leg: float) -> None:
    """Draw spiral spring and bent dashpot about C, both held by a bracket on the leg at x."""
    cm, centre = sheet.cm, sheet.pose.centre
    angles = asin(0.36 / 0.58) + np.linspace(-3.5 * pi, 0.0, 181)
    spiral = centre + cm * np.linspace(0.05, 0.58, 181)[:, None] * towards(angles)
    sheet.line(*spiral, width=1.0, color=Scheme.SUSPENSION)
    held, loose = (centre + 0.85 * cm * towards(asin(0.36 / 0.85) + turn) for turn in (0.0, 1.75))
    sheet.damper(held, loose, about=centre)
    sheet.point(loose, size=2.5, color=Scheme.SUSPENSION)
    end = spiral[-1]
    sheet.line(end, (leg, end[1]), width=Scheme.OUTLINE, zorder=4)
    middle = (leg + float(sheet.at(1, 0)[0])) / 2
    sheet.text((middle, end[1]), r"$K_\varphi,\ H_\varphi$", (0, -0.33), color=Scheme.SUSPENSION)


def _mark_coordinates(sheet: Scheme) -> None:
    """Mark C with X_C and Y_C, the press force, and φ between the bottom face and the base."""
    cm, centre = sheet.cm, sheet.pose.centre
    low, far = -1.25 * cm, -sheet.a - 1.7 * cm
    sheet.point(centre, "$C$", (-0.5, -0.55))
    ends, feet = ((centre[0], low), (0, low)), (centre, (0, -0.5 * cm))
    sheet.dimension(*ends, "$X_C$", (0.42, -0.25), feet=feet, outside=True)
    sheet.dimension((far, centre[1]), (far, 0), "$Y_C$", feet=[centre])
    sheet.arrow(centre, centre - xy(0, 1.5 * cm), "$F_0$", (0.18, 0.25), ha="left")
    sheet.text(sheet.at(0, 0.62), "$M,\\ I$")
    sheet.tilt_of_face(reach=2.6)
