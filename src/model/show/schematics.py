"""Figs. 1-4 of the paper, drawn from the model's own geometry and parameters.

Part and slot stand exactly where ``model.physics.geometry`` puts them. Two things are drawn larger
than life and no more: the tilt, which at the start is far too small to see, and in Fig. 4 the
depths d and w. Whatever is not part of the model (the robot, the length of a spring) is sized in
centimetres on paper, so that it stays legible for a part of any size.
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import asin, atan2, cos, hypot, pi, sin
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle
from numpy.typing import ArrayLike, NDArray

from model.physics import geometry
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Batch, Constants, Parameters
from model.physics.readings import Readings
from model.show import style

Point = NDArray[np.float64]

CAPTIONS: Mapping[str, str] = {
    "fig01": "Scheme of vibratory alignment under kinematical excitation: 1 robot arm, 2 housing "
    "of the electromagnetic vibrator, 3 electromagnet, 4 gripper holder (elastic), 5 gripper, "
    "6 peg, 7 bushing; Δ axial misalignment, φ tilt. Peg, bushing and Δ are to scale; the tilt is "
    "enlarged.",
    "fig02": "Dynamic model: a part on springs and dampers, pressed on a base with a slot by F0 "
    "and excited through its upper support by Y sin ωt. K_X = K_X1 + … + K_X4, "
    "K_Y = K_Y1 + K_Y2. Part and slot are to scale; the tilt is enlarged.",
    "fig03": "Forces and moments on the part in contact with the base, reduced to the mass centre "
    "C; each symbol counts along its arrow. The edge A1 pushes along e_n and, while the part "
    "slides towards the slot, drags it along +e_t, away from the slot (the consistent reading). "
    "The tilt is enlarged.",
    "fig04": "Contact scheme. (a) The part at the start, its bottom face on the edge A1. The base "
    "yields as a spring and a damper (b) at A1, along the normal e_n of the bottom face, and (c) "
    "at A2, along the normal e_t of the left side face, which it can meet in a later pose. Corners "
    "and edges stand where the model has them; the tilt and the depths d and w are enlarged.",
}


# --- The part in a pose -------------------------------------------------------------------------


def _xy(x: float, y: float) -> Point:
    return np.array([x, y], dtype=float)


def _towards(angle: float) -> Point:
    """The unit vector at ``angle`` (radians) from X."""
    return _xy(cos(angle), sin(angle))


@dataclass(frozen=True)
class Pose:
    """A part in the frame of the slot: mass centre (x, y), ``tilt``, and the model's constants."""

    x: float
    y: float
    tilt: float
    constants: Constants

    @property
    def centre(self) -> Point:
        """C."""
        return _xy(self.x, self.y)

    @property
    def along_face(self) -> Point:
        """e_t."""
        return _towards(self.tilt)

    @property
    def along_axis(self) -> Point:
        """e_n."""
        return _xy(-sin(self.tilt), cos(self.tilt))

    def at(self, face: float, axis: float) -> Point:
        """The point C + face e_t + axis e_n."""
        return self.centre + face * self.along_face + axis * self.along_axis

    def corners(self) -> Point:
        """B1, D1, D2, B2 as rows; the top ones by point symmetry about C."""
        right, left = (
            np.array(geometry.bottom_corner(side, self.x, self.y, self.tilt, self.constants))
            for side in (RIGHT_EDGE, LEFT_EDGE)
        )
        return np.array([right, 2 * self.centre - left, 2 * self.centre - right, left])

    def edge(self, side: float) -> Point:
        """A1 or A2."""
        return _xy(side * self.constants.slot_half_width, 0.0)

    def edge_place(self, side: float) -> geometry.EdgePlace:
        """Where A1 or A2 stands in the frame of the part."""
        return geometry.EdgePlace(
            *geometry.edge_place(side, self.x, self.y, self.tilt, self.constants)
        )


def _constants(parameters: Parameters) -> Constants:
    row = Batch.stack([parameters]).constants(Readings.consistent())[0]
    return Constants(*(float(value) for value in row))


def drawing_tilt(parameters: Parameters) -> float:
    """A tilt (radians) that can be seen: it brings A1 well inside the bottom face.

    A1 is moved a quarter of the way from where an upright part has it to the corner B2, which is
    to solve b sin φ + s cos φ = l - x for φ; a short part stops at 0.2.
    """
    reach = parameters.slot_half_width - parameters.misalignment
    face = reach - 0.25 * (reach + parameters.half_width)
    radius = hypot(parameters.half_height, face)
    return min(asin(min(reach / radius, 1.0)) - atan2(face, parameters.half_height), 0.2)


def resting_pose(parameters: Parameters) -> Pose:
    """The start of the model, tilted until it can be seen: the bottom face touches A1, d = 0."""
    tilt = drawing_tilt(parameters)
    constants = _constants(parameters.replace(initial_tilt=tilt))
    return Pose(parameters.misalignment, geometry.resting_height(constants), tilt, constants)


def pose_with_edge(resting: Pose, side: float, face: float, axis: float) -> Pose:
    """``resting``, moved until the edge A1 or A2 stands at face e_t + axis e_n from C."""
    x, y = resting.edge(side) - (resting.at(face, axis) - resting.centre)
    return Pose(float(x), float(y), resting.tilt, resting.constants)


# --- The primitives of a mechanical scheme ------------------------------------------------------

OUTLINE, THIN, FORCE = 1.2, 0.6, 1.5  # line widths in points
PART_COLOUR, BASE_COLOUR = "#DCE9F3", "#F3EFE6"
SUSPENSION, INERTIA, CONTACT = style.BLUE, style.GREEN, style.VERMILLION
EXCITATION = "#8F3A6B"  # the palette's purple, darkened until its text is easy to read


# Rod, piston, pot and the pot's rod, as line width (points) and places: share of the way from one
# end to the other, and centimetres across it.
_DASHPOT = (
    (1.0, ((0.0, 0.0), (0.52, 0.0))),
    (2.2, ((0.52, 0.12), (0.52, -0.12))),
    (1.0, ((0.34, 0.17), (0.7, 0.17), (0.7, -0.17), (0.34, -0.17))),
    (1.0, ((0.7, 0.0), (1.0, 0.0))),
)


class Sheet:
    """Axes of equal scales and the primitives of a mechanical scheme.

    Points are in the model's dimensionless lengths. ``cm`` is the length that fills a centimetre
    on paper, by which symbols are sized.
    """

    def __init__(self, axes: Axes, cm: float, left: float, bottom: float) -> None:
        """``left``, ``bottom``: the lower left corner of ``axes``, in centimetres from O."""
        self.axes, self.cm = axes, cm
        box = axes.get_position()
        width, height = axes.get_figure().get_size_inches() / style.CENTIMETRE  # type: ignore[union-attr]
        axes.set_xlim(left * cm, (left + box.width * width) * cm)
        axes.set_ylim(bottom * cm, (bottom + box.height * height) * cm)
        axes.set_axis_off()

    def line(self, *points: ArrayLike, width: float = THIN, **look: Any) -> None:
        """A polyline."""
        x, y = np.array(points, dtype=float).T
        look = {"color": style.BLACK, "solid_capstyle": "round", "zorder": 3, **look}
        self.axes.plot(x, y, linewidth=width, **look)

    def chain(self, *points: ArrayLike, **look: Any) -> None:
        """A chain line: an axis of symmetry."""
        self.line(*points, linestyle=(0, (12, 2.5, 2, 2.5)), dash_capstyle="butt", **look)

    def area(self, points: ArrayLike, colour: str, **look: Any) -> None:
        """A filled polygon with an outline."""
        look = {"edgecolor": style.BLACK, "linewidth": OUTLINE, "zorder": 2, **look}
        self.axes.add_patch(Polygon(np.asarray(points), closed=True, facecolor=colour, **look))

    def cut(self, points: ArrayLike, hatch: str = "///", **look: Any) -> None:
        """A polygon of material that is cut: hatched, its outline left to the caller."""
        grey = {"edgecolor": "#B0A890", "linewidth": 0.0, "zorder": 1}
        self.area(points, BASE_COLOUR, hatch=hatch, **{**grey, **look})

    def dot(self, point: ArrayLike, size: float = 3.5, **look: Any) -> None:
        """A point of the scheme."""
        look = {"color": style.BLACK, "zorder": 6, **look}
        self.axes.plot(*np.asarray(point), marker="o", markersize=size, **look)

    def text(
        self, point: ArrayLike, words: str, shift: Sequence[float] = (0, 0), **look: Any
    ) -> None:
        """Text centred on ``point``, moved by ``shift`` centimetres."""
        x, y = np.asarray(point) + np.asarray(shift) * self.cm
        look = {"ha": "center", "va": "center", "zorder": 8, **look}
        if "on" in look:  # the colour behind, where lines would run through the words
            look["bbox"] = {"facecolor": look.pop("on"), "edgecolor": "none", "pad": 0.8}
        self.axes.text(x, y, words, **look)

    def arrow(
        self, tail: ArrayLike, head: ArrayLike, heads: str = "-|>", width: float = THIN, **look: Any
    ) -> None:
        """A straight arrow; force arrows are ``width=FORCE``."""
        scale = 7.0 if width < FORCE else 11.0
        look = {"color": style.BLACK, "zorder": 5, **look}
        self.axes.add_patch(
            FancyArrowPatch(
                tuple(np.asarray(tail)),
                tuple(np.asarray(head)),
                arrowstyle=f"{heads},head_length=0.6,head_width=0.22",
                mutation_scale=scale,
                linewidth=width,
                shrinkA=0,
                shrinkB=0,
                joinstyle="miter",
                **look,
            )
        )

    def arc(self, centre: ArrayLike, radius: float, start: float, stop: float, **look: Any) -> None:
        """An arc from angle ``start`` to ``stop`` (radians) with an arrow head at its end."""
        angles = np.linspace(start, stop, 61)
        points = np.asarray(centre) + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        width, zorder = look.pop("width", THIN), look.pop("zorder", 4)
        # The head covers the end of the arc, so the line stops short of its point.
        back = max(2, round(60 * 0.12 * self.cm / (radius * abs(stop - start))) + 1)
        self.line(*points[:-back], width=width, zorder=zorder, **look)
        self.arrow(points[-1 - back], points[-1], width=width, zorder=zorder, **look)

    def dimension(
        self,
        start: ArrayLike,
        stop: ArrayLike,
        words: str,
        shift: Sequence[float] = (0, 0),
        *,
        outside: bool = False,
        on: str = "white",
    ) -> None:
        """A dimension line; ``outside`` has the arrows point inwards where there is no room."""
        first, last = np.asarray(start, dtype=float), np.asarray(stop, dtype=float)
        if outside:
            away = 0.55 * self.cm * (last - first) / np.hypot(*(last - first))
            self.arrow(first - away, first)
            self.arrow(last + away, last)
            self.line(first, last)
        else:
            self.arrow(first, last, heads="<|-|>")
        self.text((first + last) / 2, words, shift, **({} if any(shift) else {"on": on}))

    def leader(self, point: ArrayLike, end: ArrayLike, number: str) -> None:
        """A leader line from a part of the scheme to its number."""
        self.line(point, end, zorder=7)
        self.dot(point, 2.2, zorder=7)
        away = np.asarray(end) - np.asarray(point)
        self.text(end, number, tuple(0.22 * away / np.hypot(*away)), fontsize=10)

    def spring(self, start: ArrayLike, stop: ArrayLike, coils: int = 5, **look: Any) -> None:
        """A zigzag between two points, with straight ends."""
        along, across, length = self._frame(start, stop)
        lead = min(0.2 * self.cm, 0.2 * length)
        turns = np.linspace(lead, length - lead, 2 * coils + 1)
        turns = np.concatenate([turns[:1], (turns[1:] + turns[:-1]) / 2, turns[-1:]])
        sides = 0.17 * self.cm * np.array([0.0, *([1.0, -1.0] * coils), 0.0])
        zigzag = np.outer(turns, along) + np.outer(sides, across) + np.asarray(start)
        look = {"color": SUSPENSION, "solid_joinstyle": "round", **look}
        self.line(start, *zigzag, stop, width=1.0, **look)

    def damper(self, start: ArrayLike, stop: ArrayLike, **look: Any) -> None:
        """A dashpot: rod and piston from ``start`` in a pot held at ``stop``."""
        along, across, length = self._frame(start, stop)
        for width, shape in _DASHPOT:
            points = [
                np.asarray(start) + share * length * along + side * self.cm * across
                for share, side in shape
            ]
            self.line(*points, width=width, **{"color": SUSPENSION, **look})

    def bent_damper(self, centre: ArrayLike, radius: float, start: float, stop: float) -> None:
        """A dashpot bent round ``centre`` from angle ``start`` to ``stop``: it resists turning."""
        for width, shape in _DASHPOT:
            rounded = np.concatenate([np.linspace(p, q, 13) for p, q in itertools.pairwise(shape)])
            angles = start + rounded[:, 0] * (stop - start)
            radii = radius - rounded[:, 1] * self.cm
            points = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
            self.line(*(np.asarray(centre) + points), width=width, color=SUSPENSION)

    def spiral(self, centre: ArrayLike, radii: tuple[float, float], end: float) -> Point:
        """A spiral spring between ``radii`` (cm) that ends at angle ``end``; its outer end."""
        angles = np.linspace(end - 3.5 * pi, end, 181)
        turns = np.column_stack([np.cos(angles), np.sin(angles)])
        points = np.asarray(centre) + np.linspace(*radii, 181)[:, None] * self.cm * turns
        self.line(*points, width=1.0, color=SUSPENSION)
        return np.asarray(points[-1])

    def ground(self, start: ArrayLike, stop: ArrayLike) -> None:
        """A line held fast: short strokes on the right of the way from ``start`` to ``stop``."""
        along, across, length = self._frame(start, stop)
        self.line(start, stop, width=OUTLINE)
        pitch = 0.16 * self.cm
        for place in np.arange(pitch / 2, length, pitch):
            foot = np.asarray(start) + place * along
            self.line(foot, foot - pitch * (along + across), width=0.7)

    @staticmethod
    def _frame(start: ArrayLike, stop: ArrayLike) -> tuple[Point, Point, float]:
        away = np.asarray(stop, dtype=float) - np.asarray(start, dtype=float)
        length = float(np.hypot(*away))
        along = away / length
        return along, np.array([-along[1], along[0]]), length


def _new_sheet(cm: float, left: float, bottom: float, height: float) -> tuple[Figure, Sheet]:
    """A figure of the full text width with one sheet on it; sizes in centimetres."""
    figure = style.new_figure(height=height * style.CENTIMETRE)
    figure.set_layout_engine("none")  # the sheet fills the figure, by construction
    return figure, Sheet(figure.add_axes((0.0, 0.0, 1.0, 1.0)), cm, left, bottom)


def _centimetre(pose: Pose, part_height: float) -> float:
    """The length that fills a centimetre for a part ``part_height`` cm high, 3.4 wide at most."""
    p = pose.constants
    return max(2 * p.half_height / part_height, 2 * p.half_width / 3.4)


def _draw_part(sheet: Sheet, pose: Pose, **look: Any) -> None:
    sheet.area(pose.corners(), PART_COLOUR, label="part", **look)


def _draw_base(sheet: Sheet, pose: Pose, reach: float, depth: float) -> None:
    """A base with a blind slot, ``reach`` cm to either side of it, the slot ``depth`` cm deep."""
    cm, half = sheet.cm, pose.constants.slot_half_width
    far, floor = half + reach * cm, -depth * cm
    profile = [(-far, 0.0), (-half, 0.0), (-half, floor), (half, floor), (half, 0.0), (far, 0.0)]
    sheet.cut([*profile, (far, floor - 0.4 * cm), (-far, floor - 0.4 * cm)])
    sheet.line(*profile, width=OUTLINE, label="base")


def _draw_frame(
    sheet: Sheet, right: float, top: float, origin: Sequence[float] = (-0.3, -0.38)
) -> None:
    """The axes X and Y, reaching ``right`` and ``top``; ``origin`` is where the letter O goes."""
    sheet.arrow((0, 0), (right, 0), zorder=4)
    sheet.arrow((0, 0), (0, top), zorder=4)
    sheet.dot((0, 0), 3.0)
    sheet.text((right, 0), "$X$", (0.0, -0.28))
    sheet.text((0, top), "$Y$", (-0.28, 0.0))
    sheet.text((0, 0), "$O$", origin)


# --- Fig. 1 -------------------------------------------------------------------------------------

_KEY = (
    "1  robot arm",
    "2  housing of the\n    electromagnetic vibrator",
    "3  electromagnet",
    "4  gripper holder (elastic)",
    "5  gripper",
    "6  peg",
    "7  bushing",
)


def fig01(parameters: Parameters) -> Figure:
    """Scheme of the device, numbered as in the paper's Fig. 1."""
    pose = resting_pose(parameters)
    with style.context():
        cm = _centimetre(pose, 6.2)
        top = pose.corners()[:, 1].max() / cm + 6.3
        figure, sheet = _new_sheet(cm, -4.7, -3.2, top + 3.2)
        _draw_bushing(sheet, pose)
        _draw_part(sheet, pose)
        palm = _draw_gripper(sheet, pose)
        platform = _draw_holder(sheet, pose, palm)
        _draw_vibrator(sheet, pose, platform)
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
    """The jaws around the upper part of the peg; returns the height of the palm, along e_n."""
    cm, a, b = sheet.cm, pose.constants.half_width, pose.constants.half_height
    far, low, palm = a + 0.4 * cm, 0.3 * b, b + 0.45 * cm
    outline = [(-a, low), (-far, low), (-far, palm), (far, palm), (far, low), (a, low)]
    outline += [(a, b), (-a, b)]
    sheet.area([pose.at(*place) for place in outline], "#E4E4E4")
    grip = pose.at(far - 0.2 * cm, 0.6 * b)
    sheet.leader(grip, grip + _xy(1.1, 0.45) * cm, "5")
    peg = pose.at(0.6 * a, -0.25 * b)
    sheet.leader(peg, peg + _xy(1.1 * cm + 0.4 * a, 0.45 * cm), "6")
    return palm


def _draw_holder(sheet: Sheet, pose: Pose, palm: float) -> float:
    """The platform on its elastic elements; returns the height of the platform's upper face."""
    cm, a = sheet.cm, pose.constants.half_width
    low = float(pose.at(a, palm)[1]) + 1.15 * cm
    high = low + 0.3 * cm
    left, right = pose.x - a - 0.9 * cm, pose.x + a + 0.9 * cm
    sheet.area([(left, low), (right, low), (right, high), (left, high)], "#E4E4E4")
    for place in (-0.8, 0.0, 0.8):
        foot = pose.at(place * a, palm)
        sheet.spring(foot, (foot[0], low), coils=4, color=style.BLACK)
    spring = pose.at(0.8 * a, palm) + _xy(0.0, 0.55 * cm)
    sheet.leader(spring, spring + _xy(1.5, -0.25) * cm, "4")
    shaker = right + 0.45 * cm
    ends = (shaker, low - 0.4 * cm), (shaker, high + 0.4 * cm)
    sheet.arrow(*ends, heads="<|-|>", color=EXCITATION)
    words, middle = r"$Y\,\sin\,\omega t$", (shaker, (low + high) / 2)
    sheet.text(middle, words, (0.15, 0), ha="left", color=EXCITATION)
    return high


def _draw_vibrator(sheet: Sheet, pose: Pose, platform: float) -> None:
    """Armature and rod over the platform, the electromagnet in its housing, the arm above."""
    cm, x = sheet.cm, pose.x

    def box(left: float, right: float, low: float, high: float, colour: str) -> None:
        corners = [(left, low), (right, low), (right, high), (left, high)]
        sheet.area([(x + u * cm, platform + v * cm) for u, v in corners], colour)

    box(-1.75, 1.75, 0.45, 2.95, "#D2D2D2")
    box(-1.5, 1.5, 0.7, 2.7, "white")
    box(-0.3, 0.3, 0.45, 0.7, "white")  # the rod's way through the floor of the housing
    box(-0.15, 0.15, 0.0, 1.0, "#E4E4E4")
    box(-1.0, 1.0, 0.95, 1.2, "#E4E4E4")
    box(-1.0, 1.0, 2.2, 2.7, "#C6C6C6")
    for left in (-1.0, -0.2, 0.6):
        box(left, left + 0.4, 1.4, 2.2, "#C6C6C6")
    for left in (-0.6, 0.2):
        box(left, left + 0.4, 1.6, 2.1, "#E3B98A")  # the coil, cut
    box(-0.5, 0.5, 2.95, 3.35, "#E4E4E4")
    box(-3.4, 0.9, 3.35, 3.95, "#E4E4E4")
    _break_line(sheet, x - 3.4 * cm, platform + 3.35 * cm, platform + 3.95 * cm)
    _number_vibrator(sheet, x, platform)


def _number_vibrator(sheet: Sheet, x: float, platform: float) -> None:
    places = {
        "1": ((0.6, 3.65), (2.3, 3.9)),
        "2": ((1.62, 2.5), (2.6, 2.85)),
        "3": ((0.8, 1.85), (2.6, 1.65)),
    }
    for number, (point, end) in places.items():
        base = _xy(x, platform)
        sheet.leader(base + np.array(point) * sheet.cm, base + np.array(end) * sheet.cm, number)


def _break_line(sheet: Sheet, x: float, low: float, high: float) -> None:
    """The wavy end of something that goes on beyond the drawing."""
    height = np.linspace(low, high, 41)
    wave = x + 0.08 * sheet.cm * np.sin(2 * pi * (height - low) / (high - low))
    sheet.line((x, low), (x, high), width=2.5, color="white")
    sheet.line(*np.column_stack([wave, height]), width=THIN)


def _mark_misalignment(sheet: Sheet, pose: Pose) -> None:
    """Δ between the axes of bushing and device, under the bushing; φ at the peg's lower end."""
    cm, low = sheet.cm, -2.75 * sheet.cm
    sheet.chain((0, 0.6 * cm), (0, low - 0.2 * cm))
    sheet.chain((pose.x, pose.y), (pose.x, low - 0.2 * cm))
    sheet.dimension((0, low), (pose.x, low), r"$\Delta$", (0.88, 0.0), outside=True)
    _mark_tilt_below(sheet, pose, reach=pose.constants.half_height + 1.2 * cm)


def _mark_tilt_below(sheet: Sheet, pose: Pose, reach: float) -> None:
    """φ between the vertical through C and the axis of the part, ``reach`` below C."""
    sheet.chain(pose.at(0, pose.constants.half_height * 0.2), pose.at(0, -reach - 0.6 * sheet.cm))
    sheet.dot(pose.centre)
    sheet.text(pose.centre, "$C$", (-0.25, 0.05))
    sheet.arc(pose.centre, reach, -pi / 2, -pi / 2 + pose.tilt)
    half_way = -pi / 2 + 0.5 * pose.tilt
    below = reach + 0.28 * sheet.cm
    sheet.text(pose.centre + below * _towards(half_way), r"$\varphi$")


def _write_key(sheet: Sheet, top: float) -> None:
    for row, words in enumerate(_KEY):
        drop = 0.55 * row + (0.4 if row > 1 else 0.0)
        sheet.text((5.4 * sheet.cm, (top - 1.2 - drop) * sheet.cm), words, ha="left", va="top")
    symbols = "$\\Delta$  axial misalignment\n$\\varphi$  tilt (enlarged)"
    sheet.text((5.4 * sheet.cm, (top - 5.9) * sheet.cm), symbols, ha="left", va="top")


# --- Fig. 2 -------------------------------------------------------------------------------------


def fig02(parameters: Parameters) -> Figure:
    """Dynamic model: the part on its suspension, the excited upper support, the base."""
    pose = resting_pose(parameters)
    with style.context():
        cm = _centimetre(pose, 7.0)
        plate = pose.corners()[:, 1].max() / cm + 1.7
        figure, sheet = _new_sheet(cm, -8.0, -2.5, plate + 4.1)
        _draw_base(sheet, pose, reach=5.2, depth=1.8)
        _draw_part(sheet, pose)
        inner = _draw_support(sheet, pose, plate * cm)
        _draw_lateral_suspension(sheet, pose, inner)
        _draw_axial_suspension(sheet, pose, plate * cm)
        _draw_tilt_suspension(sheet, pose, inner[1])
        _draw_frame(sheet, pose.constants.half_width + 5.6 * cm, 1.5 * cm)
        _mark_coordinates(sheet, pose)
    return figure


def _draw_support(sheet: Sheet, pose: Pose, plate: float) -> tuple[float, float]:
    """The vibrator's platform astride the part; returns the inner faces of its two legs."""
    cm, middle = sheet.cm, float(pose.at(0, 0.6 * pose.constants.half_height)[0])
    half, thick, foot = pose.constants.half_width + 2.5 * cm, 0.32 * cm, pose.y + 0.2 * cm
    inner, outer = (middle - half, middle + half), (middle - half - thick, middle + half + thick)
    high = plate + thick
    outline = [(outer[0], foot), (outer[0], high), (outer[1], high), (outer[1], foot)]
    outline += [(inner[1], foot), (inner[1], plate), (inner[0], plate), (inner[0], foot)]
    sheet.area(outline, "#E4E4E4")
    shake = _xy(middle, high + 0.12 * cm)
    sheet.arrow(shake, shake + _xy(0, 0.95 * cm), heads="<|-|>", width=FORCE, color=EXCITATION)
    words = r"$Y(t) = Y\,\sin\,\omega t$"
    sheet.text(shake + _xy(0, 0.5 * cm), words, (0.25, 0), ha="left", color=EXCITATION)
    return inner


def _draw_lateral_suspension(sheet: Sheet, pose: Pose, inner: tuple[float, float]) -> None:
    a, b = pose.constants.half_width, pose.constants.half_height
    for level, left, right in ((0.88, "1", "2"), (0.36, "3", "4")):
        for side, leg, number in ((-a, inner[0], left), (a, inner[1], right)):
            hold = pose.at(side, level * b)
            sheet.spring((leg, hold[1]), hold, coils=6)
            middle = ((leg + hold[0]) / 2, hold[1])
            sheet.text(middle, f"$K_{{X_{number}}}$", (0, 0.4), color=SUSPENSION)
            sheet.dot(hold, 2.5, color=SUSPENSION)
    hold = pose.at(-a, 0.62 * b)
    sheet.damper((inner[0], hold[1]), hold)
    sheet.text(((inner[0] + hold[0]) / 2, hold[1]), "$H_X$", (0, 0.4), color=SUSPENSION)
    sheet.dot(hold, 2.5, color=SUSPENSION)


def _draw_axial_suspension(sheet: Sheet, pose: Pose, plate: float) -> None:
    a, b = pose.constants.half_width, pose.constants.half_height
    for place, words, shift in ((-0.9, "K_{Y_1}", -0.5), (0.0, "H_Y", 0.31), (0.9, "K_{Y_2}", 0.5)):
        hold = pose.at(place * a, b)
        draw = sheet.damper if place == 0.0 else sheet.spring
        draw((hold[0], plate), hold)
        # The damper's symbol stands by its rod, where there is room between the springs.
        level = plate - 0.35 * sheet.cm if place == 0.0 else (plate + hold[1]) / 2
        sheet.text((hold[0], level), f"${words}$", (shift, 0), color=SUSPENSION)
        sheet.dot(hold, 2.5, color=SUSPENSION)


def _draw_tilt_suspension(sheet: Sheet, pose: Pose, leg: float) -> None:
    """Spiral spring and bent dashpot about C, both held by a bracket on the support."""
    bracket, outer = 0.36 * sheet.cm, 0.85 * sheet.cm
    end = sheet.spiral(pose.centre, (0.05, 0.58), asin(0.36 / 0.58))
    grip = asin(bracket / outer)
    sheet.bent_damper(pose.centre, outer, grip, grip + 1.75)
    loose = grip + 1.75
    sheet.dot(pose.centre + outer * _towards(loose), 2.5, color=SUSPENSION)
    sheet.line(end, (leg, end[1]), width=OUTLINE, zorder=4)
    middle = ((leg + pose.at(pose.constants.half_width, 0)[0]) / 2, end[1])
    sheet.text(middle, r"$K_\varphi,\ H_\varphi$", (0, -0.33), color=SUSPENSION)


def _mark_coordinates(sheet: Sheet, pose: Pose) -> None:
    """C with X_C and Y_C, the press force, and φ between the bottom face and the base."""
    cm, low = sheet.cm, -1.25 * sheet.cm
    sheet.dot(pose.centre)
    sheet.text(pose.centre, "$C$", (-0.5, -0.55))
    sheet.line(pose.centre, (pose.x, low - 0.15 * cm))
    sheet.line((0, -0.5 * cm), (0, low - 0.15 * cm))
    sheet.dimension((0, low), (pose.x, low), "$X_C$", (0.42, -0.25), outside=True)
    far = -pose.constants.half_width - 1.7 * cm
    sheet.line(pose.centre, (far - 0.15 * cm, pose.y))
    sheet.dimension((far, 0), (far, pose.y), "$Y_C$")
    press = pose.centre - _xy(0, 1.5 * cm)
    sheet.arrow(pose.centre, press, width=FORCE)
    sheet.text(press, "$F_0$", (0.18, 0.25), ha="left")
    sheet.text(pose.at(0, 0.62 * pose.constants.half_height), "$M,\\ I$")
    _mark_tilt_of_face(sheet, pose, reach=2.6)


def _mark_tilt_of_face(sheet: Sheet, pose: Pose, reach: float) -> None:
    """φ between the base and the bottom face, which is drawn on ``reach`` cm to the right."""
    edge = pose.edge(RIGHT_EDGE)
    radius = float(np.hypot(*(pose.corners()[0] - edge))) + reach * sheet.cm
    sheet.line(edge, edge + (radius + 0.12 * sheet.cm) * pose.along_face, linestyle=(0, (4, 2)))
    sheet.arc(edge, radius, 0.0, pose.tilt)
    middle = edge + (radius + 0.32 * sheet.cm) * _towards(pose.tilt / 2)
    sheet.text(middle, r"$\varphi$")


# --- Fig. 3 -------------------------------------------------------------------------------------

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


def fig03(parameters: Parameters) -> Figure:
    """Forces and moments on the part; each symbol counts along its arrow."""
    pose = resting_pose(parameters)
    with style.context():
        cm = _centimetre(pose, 7.2)
        top = max(pose.corners()[:, 1].max() / cm + 1.5, 8.2)
        figure, sheet = _new_sheet(cm, -5.4, -2.6, top + 2.6)
        _draw_base(sheet, pose, reach=3.2, depth=1.7)
        _draw_part(sheet, pose)
        _draw_directions(sheet, pose)
        _draw_forces_at_centre(sheet, pose)
        _draw_moments(sheet, pose)
        _draw_contact_forces(sheet, pose)
        _mark_arms(sheet, pose)
        _mark_tilt_above(sheet, pose)
        _explain_forces(sheet, top)
    return figure


def _draw_directions(sheet: Sheet, pose: Pose) -> None:
    """The directions X, Y of the base and e_t, e_n of the part, away from the forces."""
    cm, half = sheet.cm, pose.constants.half_width
    root = _xy(-half - 3.0 * cm, 0.7 * cm)
    grey: dict[str, Any] = {"color": style.GREY}
    sheet.arrow(root, root + _xy(1.2 * cm, 0))
    sheet.arrow(root, root + _xy(0, 1.2 * cm))
    sheet.arrow(root, root + 1.2 * cm * pose.along_face, **grey)
    sheet.arrow(root, root + 1.2 * cm * pose.along_axis, **grey)
    sheet.text(root, "$X$", (1.35, -0.18))
    sheet.text(root, "$Y$", (0.2, 1.35))
    sheet.text(root + 1.2 * cm * pose.along_face, "$e_t$", (0.1, 0.27), **grey)
    sheet.text(root + 1.2 * cm * pose.along_axis, "$e_n$", (-0.22, 0.18), **grey)


def _draw_forces_at_centre(sheet: Sheet, pose: Pose) -> None:
    """Elastic forces end at C, the weight starts there, inertia follows on the same line."""
    cm, c = sheet.cm, pose.centre
    side = pose.constants.half_width + 1.9 * cm
    right, left = c + _xy(side, 0), c - _xy(side, 0)
    up, down = c + _xy(0, 2.1 * cm), c - _xy(0, 1.3 * cm)
    sheet.arrow(right, c, width=FORCE, color=SUSPENSION)
    sheet.text(right, "$F_x$", (-0.2, 0.28), color=SUSPENSION)
    sheet.arrow(up, c, width=FORCE, color=SUSPENSION)
    sheet.text(up, "$F_y$", (0.3, -0.2), color=SUSPENSION)
    sheet.arrow(c, down, width=FORCE)
    sheet.text(down, "$Mg$", (0.17, 0.4), ha="left", on=PART_COLOUR)
    sheet.arrow(c, left, width=FORCE, color=INERTIA)
    sheet.text(left, r"$M X_C^{\prime\prime}$", (0.35, 0.32), color=INERTIA)
    lower = down - _xy(0, 1.0 * cm)
    sheet.arrow(down, lower, width=FORCE, color=INERTIA)
    look = {"ha": "left", "color": INERTIA, "on": PART_COLOUR}
    sheet.text(lower, r"$M Y_C^{\prime\prime}$", (0.17, 0.4), **look)
    sheet.dot(c)
    sheet.text(c, "$C$", (-0.25, -0.28))


def _draw_moments(sheet: Sheet, pose: Pose) -> None:
    """Both turn clockwise: they resist φ, which counts counter-clockwise."""
    radius = pose.constants.half_width + 0.75 * sheet.cm
    for start, stop, words, colour in (
        (1.15, 0.2, r"$T_\varphi$", SUSPENSION),
        (pi - 0.2, pi - 1.15, r"$I\varphi^{\prime\prime}$", INERTIA),
    ):
        sheet.arc(pose.centre, radius, start, stop, width=FORCE, color=colour)
        middle, away = (start + stop) / 2, radius + 0.45 * sheet.cm
        sheet.text(pose.centre + away * _towards(middle), words, color=colour)


def _draw_contact_forces(sheet: Sheet, pose: Pose) -> None:
    """The edge pushes along e_n and drags along e_t."""
    cm, edge = sheet.cm, pose.edge(RIGHT_EDGE)
    tail = edge - 1.5 * cm * pose.along_axis
    sheet.arrow(tail, edge, width=FORCE, color=CONTACT, zorder=7)
    sheet.text(tail, "$N$", (0.35, 0.12), color=CONTACT, on=BASE_COLOUR)
    drag = edge + (pose.constants.half_width + 0.9 * cm) * pose.along_face
    sheet.arrow(edge, drag, width=FORCE, color=CONTACT, zorder=7)
    sheet.text(drag, r"$\mu N$", (0.05, 0.3), color=CONTACT)
    sheet.dot(edge, zorder=8)
    sheet.text(edge, "$A_1$", (-0.3, -0.35))
    sheet.dot(pose.edge(LEFT_EDGE))
    sheet.text(pose.edge(LEFT_EDGE), "$A_2$", (-0.3, 0.28))


def _mark_arms(sheet: Sheet, pose: Pose) -> None:
    """The arms of the contact forces about C: Q along the bottom face, B along the axis."""
    cm, b = sheet.cm, pose.constants.half_height
    q = pose.edge_place(RIGHT_EDGE).along_face
    far, above = -0.74 * pose.constants.half_width, -b + 0.75 * cm
    sheet.line(pose.centre, pose.at(far - 0.15 * cm, 0))
    sheet.dimension(pose.at(far, -b), pose.at(far, 0), "$B$", on=PART_COLOUR)
    sheet.chain(pose.centre, pose.at(0, -b))
    sheet.line(pose.edge(RIGHT_EDGE), pose.at(q, above + 0.15 * cm))
    sheet.dimension(pose.at(0, above), pose.at(q, above), "$Q$", (0, 0.25), outside=True)


def _mark_tilt_above(sheet: Sheet, pose: Pose) -> None:
    """φ between the vertical through C and the axis of the part, over its top."""
    reach = pose.constants.half_height + 0.8 * sheet.cm
    end = reach + 0.5 * sheet.cm
    sheet.chain(pose.centre, pose.at(0, end))
    sheet.chain(pose.centre, pose.centre + _xy(0, end))
    sheet.arc(pose.centre, reach, pi / 2, pi / 2 + pose.tilt)
    half_way, middle = pi / 2 + pose.tilt / 2, reach + 0.3 * sheet.cm
    sheet.text(pose.centre + middle * _towards(half_way), r"$\varphi$")


def _explain_forces(sheet: Sheet, top: float) -> None:
    x, y = 5.4 * sheet.cm, (top - 1.0) * sheet.cm
    for colour, title, symbols in _FORCES:
        sheet.text((x, y), title, ha="left", va="top", color=colour, fontweight="bold")
        sheet.text((x, y), symbols, (0.0, -0.5), ha="left", va="top", linespacing=1.5)
        y -= (1.35 + 0.52 * symbols.count("\n")) * sheet.cm
    words = "Each symbol counts along\nits arrow; eqs (1) balance them."
    sheet.text((x, y), words, ha="left", va="top", fontsize=8, color=style.GREY)


# --- Fig. 4 -------------------------------------------------------------------------------------

# In centimetres on paper: the depths as drawn, how far B2 hangs below A2, and the recess in the
# base that holds its spring and dashpot, along the face and away from it.
DRAWN_DEPTH, DRAWN_SIDE_DEPTH, _HANG = 0.5, 0.5, 1.9
_RECESS_ALONG, _RECESS_DEEP = 2.4, 2.0
_DETAIL = 0.42  # length that fills a centimetre in a detail, against that in the whole scheme


def contact_poses(parameters: Parameters) -> tuple[Pose, Pose, Pose]:
    """The poses that Fig. 4 draws: at rest on A1; A1 at depth d; A2 at depth w in the left side.

    In the second A1 keeps its place along the face. In the third the corner B2 hangs below A2.
    """
    resting = resting_pose(parameters)
    p, cm = resting.constants, _DETAIL * _centimetre(resting, 7.6)
    face = resting.edge_place(RIGHT_EDGE).along_face
    below = pose_with_edge(resting, RIGHT_EDGE, face, DRAWN_DEPTH * cm - p.half_height)
    inside, hang = DRAWN_SIDE_DEPTH * cm - p.half_width, _HANG * cm - p.half_height
    return resting, below, pose_with_edge(resting, LEFT_EDGE, inside, hang)


def fig04(parameters: Parameters) -> Figure:
    """Contact scheme: the whole part at A1, and what yields at A1 and at A2."""
    whole, below, beside = contact_poses(parameters)
    with style.context():
        cm = _centimetre(whole, 7.6)
        height = max(whole.corners()[:, 1].max() / cm + 3.5, 11.0)
        figure = style.new_figure(height=height * style.CENTIMETRE)
        figure.set_layout_engine("none")  # the panels are placed by hand
        left = figure.add_axes((0.0, 0.0, 0.53, 1.0))
        _draw_whole_contact(Sheet(left, cm, -3.9, -2.3), whole)
        edge, detail = whole.constants.slot_half_width / (_DETAIL * cm), _DETAIL * cm
        share, floor = 4.25 / height, 0.25 / height
        upper = figure.add_axes((0.54, 1.0 - 1.15 / height - share, 0.45, share))
        _draw_edge_contact(Sheet(upper, detail, edge - 3.0, -2.6), below)
        lower = figure.add_axes((0.54, floor, 0.45, share))
        _draw_side_contact(Sheet(lower, detail, -edge - 3.4, -2.7), beside)
    return figure


def _frame_detail(sheet: Sheet, title: str, law: str) -> None:
    """A title over a detail, and a frame round it where part and base are cut off."""
    box: dict[str, Any] = {"transform": sheet.axes.transAxes, "clip_on": False}
    sheet.axes.text(0.0, 1.14, title, va="bottom", ha="left", **box)
    sheet.axes.text(0.0, 1.03, f"       {law}", va="bottom", ha="left", **box)
    border = Rectangle((0, 0), 1, 1, fill=False, zorder=10, **box)
    border.set(edgecolor=style.GREY, linewidth=0.8)
    sheet.axes.add_patch(border)


def _draw_whole_contact(sheet: Sheet, pose: Pose) -> None:
    cm, p = sheet.cm, pose.constants
    _draw_base(sheet, pose, reach=2.2, depth=1.6)
    _draw_part(sheet, pose)
    _draw_frame(sheet, p.half_width + 2.75 * cm, 1.4 * cm, origin=(0.24, -0.34))
    _name_corners(sheet, pose)
    _mark_sizes(sheet, pose)
    _mark_tilt_of_face(sheet, pose, reach=1.9)
    for end, words, shift in (
        (pose.along_face, "$e_t$", (-0.2, 0.24)),
        (pose.along_axis, "$e_n$", (0.3, -0.05)),
    ):
        sheet.arrow(pose.centre, pose.centre + 0.8 * cm * end, width=FORCE, color=CONTACT)
        sheet.text(pose.centre + 0.8 * cm * end, words, shift, color=CONTACT)
    sheet.dot(pose.centre)
    sheet.text(pose.centre, "$C$", (-0.22, -0.3))
    for side, words in ((RIGHT_EDGE, "(b)"), (LEFT_EDGE, "(c)")):
        _point_to_detail(sheet, pose.edge(side), side, words)
    sheet.axes.text(0.05, 0.965, "(a)  start, $d = 0$", transform=sheet.axes.transAxes, va="top")


def _point_to_detail(sheet: Sheet, edge: Point, side: float, words: str) -> None:
    """A ring round the edge and the letter of the panel that shows it larger."""
    away, ring = _xy(side, -1.0) / np.sqrt(2.0), 0.26 * sheet.cm
    circle = Circle((float(edge[0]), float(edge[1])), ring, fill=False, color=style.GREY, zorder=7)
    sheet.axes.add_patch(circle)
    end = edge + 1.0 * sheet.cm * away
    sheet.line(edge + ring * away, end, color=style.GREY)
    sheet.text(end, words, tuple(0.3 * away), on=BASE_COLOUR)


def _name_corners(sheet: Sheet, pose: Pose) -> None:
    places = ((0.3, 0.22), (0.33, 0.12), (-0.3, 0.15), (-0.32, -0.14))
    names = ("$B_1$", "$D_1$", "$D_2$", "$B_2$")
    for corner, name, shift in zip(pose.corners(), names, places, strict=True):
        sheet.dot(corner, 3.0)
        sheet.text(corner, name, shift)
    edges = ((RIGHT_EDGE, "$A_1$", (-0.3, -0.4)), (LEFT_EDGE, "$A_2$", (-0.35, 0.38)))
    for side, name, shift in edges:
        sheet.dot(pose.edge(side), 3.0)
        sheet.text(pose.edge(side), name, shift)


def _mark_sizes(sheet: Sheet, pose: Pose) -> None:
    """A and B of the part, L of the slot."""
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


def _draw_edge_contact(sheet: Sheet, pose: Pose) -> None:
    """A1 under the bottom face: the base yields along e_n."""
    cm, edge = sheet.cm, pose.edge(RIGHT_EDGE)
    _draw_recess(sheet, edge, _RECESS_ALONG * cm, -_RECESS_DEEP * cm)
    _draw_part(sheet, pose)
    depth = pose.edge_place(RIGHT_EDGE).along_axis + pose.constants.half_height
    foot = edge - depth * pose.along_axis
    _draw_yielding(sheet, foot, -pose.along_axis, pose.along_face, (1, edge[1] - _RECESS_DEEP * cm))
    _mark_depth(sheet, edge, foot, -0.6 * cm * pose.along_face, "$d$")
    sheet.arrow(edge, edge + 1.1 * cm * pose.along_axis, width=FORCE, color=CONTACT, zorder=7)
    sheet.text(edge + 1.1 * cm * pose.along_axis, "$e_n$", (0.3, -0.05), color=CONTACT)
    sheet.text(edge, "$A_1$", (0.35, 0.22))
    sheet.text(pose.corners()[0], "$B_1$", (0.3, -0.2))
    law = "$N = K_a d + H_a d^{\\,\\prime}$,   $d$ enlarged"
    _frame_detail(sheet, "(b)  edge $A_1$ in the bottom face", law)


def _draw_side_contact(sheet: Sheet, pose: Pose) -> None:
    """A2 beside the left side face: the base yields along e_t."""
    cm, edge = sheet.cm, pose.edge(LEFT_EDGE)
    _draw_recess(sheet, edge, -_RECESS_DEEP * cm, -_RECESS_ALONG * cm)
    _draw_part(sheet, pose)
    depth = pose.edge_place(LEFT_EDGE).along_face + pose.constants.half_width
    foot = edge - depth * pose.along_face
    _draw_yielding(
        sheet, foot, -pose.along_face, -pose.along_axis, (0, edge[0] - _RECESS_DEEP * cm)
    )
    _mark_depth(sheet, edge, foot, 0.6 * cm * pose.along_axis, "$w$")
    sheet.arrow(edge, edge + 1.1 * cm * pose.along_face, width=FORCE, color=CONTACT, zorder=7)
    sheet.text(edge + 1.1 * cm * pose.along_face, "$e_t$", (0.05, 0.28), color=CONTACT)
    sheet.text(edge, "$A_2$", (0.25, -0.3))
    sheet.text(pose.corners()[3], "$B_2$", (0.6, 0.36))
    law = "$N = K_a w + H_a w^{\\,\\prime}$,   $w$ enlarged"
    _frame_detail(sheet, "(c)  edge $A_2$ in the left side face", law)


def _draw_recess(sheet: Sheet, edge: Point, wide: float, deep: float) -> None:
    """The base without the material at its edge, whose undeformed outline is dashed.

    The recess runs from the edge to ``wide`` along X and to ``deep`` along Y.
    """
    inner = edge + _xy(wide, deep)
    low = sheet.axes.get_ylim()[0] - sheet.cm  # cut off by the panel's frame
    far = edge[0] + np.sign(wide) * 20 * sheet.cm
    wide_end, deep_end = _xy(inner[0], 0.0), _xy(edge[0], inner[1])
    profile = [_xy(far, 0.0), wide_end, inner, deep_end, _xy(edge[0], low)]
    sheet.cut([*profile, _xy(far, low)])
    sheet.line(*profile, width=OUTLINE)
    sheet.line(wide_end, edge, deep_end, linestyle=(0, (4, 2)), label="base")
    sheet.dot(edge, zorder=8)


def _draw_yielding(
    sheet: Sheet, foot: Point, away: Point, across: Point, wall: tuple[int, float]
) -> None:
    """Spring and dashpot that carry ``foot`` and stand on the wall of the recess.

    They lie along ``away``, one beside the other along ``across``. ``wall``: which of its
    coordinates (0 or 1) the wall keeps, and at what value.
    """
    axis, stand = wall
    cm = sheet.cm
    bar = foot + 0.25 * cm * away
    sheet.line(foot, bar, bar + 1.2 * cm * across, width=OUTLINE, color=SUSPENSION)
    for place, draw in ((0.25, sheet.spring), (1.2, sheet.damper)):
        start = bar + place * cm * across
        stop = start + (stand - start[axis]) / away[axis] * away
        draw(start, stop)
        words = "$K_a$" if place < 1 else "$H_a$"
        sheet.text((start + stop) / 2, words, tuple(0.46 * across), color=SUSPENSION)
    sheet.dot(foot, 3.0, color=SUSPENSION)


def _mark_depth(sheet: Sheet, edge: Point, foot: Point, aside: Point, words: str) -> None:
    sheet.line(edge, edge + 1.2 * aside)
    sheet.line(foot, foot + 1.2 * aside)
    sheet.dimension(edge + aside, foot + aside, words, tuple(0.3 * aside / np.hypot(*aside)))


DRAWINGS: Mapping[str, Callable[[Parameters], Figure]] = {
    "fig01": fig01,
    "fig02": fig02,
    "fig03": fig03,
    "fig04": fig04,
}
