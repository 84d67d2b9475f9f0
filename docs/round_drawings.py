"""Drawings of the page on round parts: the crescent from above, the lever over misalignment.

``python docs/round_drawings.py docs/peg.yaml build/drawings`` writes both.
"""

import sys
from math import pi, sqrt
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from study.schematics.sheet import Sheet
from vibralign import Parameters, load_device
from vibralign.plots import style

_CRESCENT = "#9CC4E4"
_TILT = 0.03  # of the second pair of curves, in rad
_STEPS = 181


def crescent(device: Parameters) -> Figure:
    """Draw both rims from above: the crescent, its tips, the levers."""
    a, hole, x = 1.0, 1.0 + device.clearance, device.misalignment / device.half_width
    tip = (x * x + hole * hole - a * a) / (2.0 * x)
    across = sqrt(hole * hole - tip * tip)
    round_peg, start = np.arctan2(across, tip - x), np.arctan2(across, tip)
    outer = np.linspace(-round_peg, round_peg, _STEPS)
    inner = np.linspace(start, -start, _STEPS)
    lune = [(x + a * np.cos(v), a * np.sin(v)) for v in outer]
    lune += [(hole * np.cos(v), hole * np.sin(v)) for v in inner]
    turn = np.linspace(0.0, 2.0 * pi, _STEPS)
    with style.context():
        figure = style.new_figure(height=7.8 * style.CENTIMETRE)
        sheet = Sheet(figure.add_axes((0.0, 0.0, 1.0, 1.0)), 0.34, -6.6, -3.9)
        sheet.area([(-2.4, -1.4), (3.5, -1.4), (3.5, 1.4), (-2.4, 1.4)], Sheet.BASE, linewidth=0)
        sheet.area(np.column_stack([hole * np.cos(turn), hole * np.sin(turn)]), "white")
        sheet.area(lune, _CRESCENT, linewidth=0.0)
        sheet.line(*np.column_stack([x + a * np.cos(turn), a * np.sin(turn)]), width=Sheet.OUTLINE)
        sheet.chain((-1.3, 0.0), (1.5, 0.0))
        sheet.chain((tip, -across - 0.12), (tip, across + 0.12))
        sheet.point((0, 0), "$O$", (-0.2, -0.28), 3.0)
        sheet.point((x, 0), "$C$", (0.05, 0.3))
        sheet.point((tip, across), "tip $(X,\\ Z)$", (0.9, 0.32), 5.0, color=Sheet.CONTACT)
        sheet.point((tip, -across), "tip $(X,\\ -Z)$", (1.0, -0.32), 5.0, color=Sheet.CONTACT)
        sheet.line((x, 0.0), (x, -0.72))
        sheet.line((hole, 0.0), (hole, -0.72))
        sheet.dimension((x, -0.3), (tip, -0.3), "$X - x$", (1.0, 0.0))
        sheet.dimension((x, -0.65), (hole, -0.65), "$l - x$", on="white")
        sheet.leader((1.02, 0.5), (1.41, 1.03), "")
        sheet.text((1.55, 0.87), "crescent: the face of the peg\nover the base", ha="left")
        sheet.leader((x + np.cos(0.8), -np.sin(0.8)), (1.89, -0.39), "")
        sheet.text((1.55, -0.87), "rim of the peg", ha="left")
        sheet.leader((-0.8 * hole, -0.6 * hole), (-1.23, -0.66), "")
        sheet.text((-1.3, -0.87), "rim of the hole", ha="right")
    return figure


def lever(device: Parameters) -> Figure:
    """Draw the lever of the press about the support, over misalignment, in half-widths."""
    gap = sqrt((1.0 + device.clearance) ** 2 - 1.0)
    b = device.half_height / device.half_width
    x = np.linspace(0.02, 1.0, 400)
    with style.context():
        figure = style.new_figure(height=8.0 * style.CENTIMETRE)
        axes = figure.add_subplot()
        for tilt, line in ((0.0, "-"), (_TILT, "--")):
            p = x + b * tilt
            arm = (gap**2 + (b * tilt) ** 2 - x**2) / (2.0 * p)
            look = {"linestyle": line, "color": style.VERMILLION}
            touches = p > device.clearance
            axes.plot(x[touches], arm[touches], label=f"round, {tilt:g} rad", **look)
            axes.plot(sqrt(gap**2 + (b * tilt) ** 2), 0.0, "o", color=style.VERMILLION)
        axes.plot(x, 1.0 + device.clearance - x, color=style.BLUE, label="plane, any tilt")
        axes.axhline(0.0, color=style.BLACK, linewidth=0.8)
        own = device.misalignment / device.half_width
        axes.axvline(own, color=style.GREY, linestyle=":")
        axes.text(own, 1.02, " docs/peg.yaml", color=style.GREY, va="bottom")
        words = "beyond: the press\nstands it flat"
        axes.annotate(words, (gap, 0.0), (gap + 0.06, 0.25), arrowprops={"arrowstyle": "->"})
        axes.set(xlim=(0, 1), ylim=(-0.45, 1.1))
        axes.set(xlabel="misalignment $x/a$", ylabel="lever of the press $(X - x)/a$")
        axes.legend(loc="upper right", bbox_to_anchor=(1.0, 0.93))
    return figure


DRAWINGS = {"crescent": crescent, "lever": lever}


def main(device: Path, folder: Path) -> None:
    """Write the drawings."""
    folder.mkdir(parents=True, exist_ok=True)
    parameters = load_device(device).parameters
    for name, draw in DRAWINGS.items():
        style.write(draw(parameters), folder / f"{name}.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
