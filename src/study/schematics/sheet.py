"""Axes of equal scales with the primitives of a mechanical scheme, and the part over its base.

Points are in the model's dimensionless lengths. ``cm`` is the length that fills a centimetre on
paper; symbols and all that is not part of the model have sizes in centimetres, so that they stay
legible for a part of any size.
"""

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon

from model.physics.notation import RIGHT_EDGE
from model.physics.parameters import Parameters
from vibralign.plots import style
from vibralign.plots.pose import Point, Pose, resting_pose, towards

Place = Sequence[float] | Point  # a point, or a shift from one in centimetres
_Strokes = Sequence[tuple[float, Sequence[tuple[float, float]]]]

# Strokes of a dashpot: line width (points) and places, each as share of the way from one end to the
# other and centimetres across it.
_DASHPOT: _Strokes = (
    (1.0, ((0.0, 0.0), (0.52, 0.0))),  # rod
    (2.2, ((0.52, 0.12), (0.52, -0.12))),  # piston
    (1.0, ((0.34, 0.17), (0.7, 0.17), (0.7, -0.17), (0.34, -0.17))),  # pot
    (1.0, ((0.7, 0.0), (1.0, 0.0))),  # rod of the pot
)


class Sheet:
    """Axes of equal scales with the primitives of a mechanical scheme.

    The lower left corner of ``axes`` is at (``left``, ``bottom``), in centimetres from O.
    """

    OUTLINE, THIN, FORCE = 1.2, 0.6, 1.5  # line widths in points
    PART, BASE, DEVICE = "#DCE9F3", "#F3EFE6", "#E4E4E4"
    SUSPENSION, INERTIA, CONTACT = style.BLUE, style.GREEN, style.VERMILLION
    EXCITATION = "#8F3A6B"  # the palette's purple, darkened until its text is easy to read

    def __init__(self, axes: Axes, cm: float, left: float, bottom: float) -> None:
        self.axes, self.cm, box = axes, cm, axes.get_position()
        self.figure: Figure = axes.get_figure()  # type: ignore[assignment]
        self.figure.set_layout_engine("none")  # axes are placed by hand
        width, height = self.figure.get_size_inches() / style.CENTIMETRE
        self.top = float(bottom + box.height * height)  # of the axes, in centimetres from O
        axes.set_xlim(left * cm, (left + box.width * width) * cm)
        axes.set_ylim(bottom * cm, self.top * cm)
        axes.set_axis_off()

    def line(self, *points: Place, width: float = THIN, **look: Any) -> None:
        """Draw a polyline."""
        x, y = np.array(points, dtype=float).T
        look = {"color": style.BLACK, "solid_capstyle": "round", "zorder": 3, **look}
        self.axes.plot(x, y, linewidth=width, **look)

    def chain(self, *points: Place) -> None:
        """Draw a chain line: an axis of symmetry."""
        self.line(*points, linestyle=(0, (12, 2.5, 2, 2.5)), dash_capstyle="butt")

    def area(self, points: Sequence[Place] | Point, colour: str, **look: Any) -> None:
        """Draw a filled polygon with an outline."""
        look = {"edgecolor": style.BLACK, "linewidth": self.OUTLINE, "zorder": 2, **look}
        self.axes.add_patch(Polygon(np.array(points), closed=True, facecolor=colour, **look))

    def cut(self, points: Sequence[Place], edgecolor: str = "#B0A890") -> None:
        """Hatch a polygon of cut material, without its outline."""
        self.area(points, self.BASE, hatch="///", edgecolor=edgecolor, linewidth=0.0, zorder=1)

    def text(self, point: Place, words: str, shift: Place = (0, 0), **look: Any) -> None:
        """Write text centred on ``point``, moved by ``shift`` centimetres."""
        look = {"ha": "center", "va": "center", "zorder": 8, **look}
        if "on" in look:  # the colour behind, where lines would run through the words
            look["bbox"] = {"facecolor": look.pop("on"), "edgecolor": "none", "pad": 0.8}
        x, y = np.asarray(point) + self.cm * np.asarray(shift)
        self.axes.text(x, y, words, **look)

    def point(
        self, place: Place, words: str = "", shift: Place = (0, 0), size: float = 3.5, **look: Any
    ) -> None:
        """Draw a point with its name, if it has one."""
        look = {"color": style.BLACK, "zorder": 6, **look}
        self.axes.plot(*place, marker="o", markersize=size, **look)
        if words:
            self.text(place, words, shift)

    def arrow(
        self, tail: Place, head: Place, words: str = "", shift: Place = (0, 0), *,
        heads: str = "-|>", width: float = FORCE, **look: Any,
    ) -> None:  # fmt: skip
        """Draw an arrow, its name by ``head``; ``ha`` and ``on`` of ``look`` are its name's."""
        name = {key: look.pop(key) for key in ("ha", "on") if key in look}
        look = {"color": style.BLACK, "zorder": 5, "shrinkA": 0, "shrinkB": 0, **look}
        look |= {"joinstyle": "miter", "mutation_scale": 7.0 if width < self.FORCE else 11.0}
        shape = f"{heads},head_length=0.6,head_width=0.22"
        ends = tuple(tail), tuple(head)
        self.axes.add_patch(FancyArrowPatch(*ends, arrowstyle=shape, linewidth=width, **look))
        if words:
            self.text(head, words, shift, color=look["color"], **name)

    def arc(self, centre: Point, radius: float, start: float, stop: float, **look: Any) -> None:
        """Draw an arc from angle ``start`` to ``stop`` (radians) with an arrow head at its end."""
        points = centre + radius * towards(np.linspace(start, stop, 61))
        look = {"width": self.THIN, "zorder": 4, **look}
        # The arrow head covers the end of the arc: the line ends before its tip.
        back = max(2, round(60 * 0.12 * self.cm / (radius * abs(stop - start))) + 1)
        self.line(*points[:-back], **look)
        self.arrow(points[-1 - back], points[-1], **look)

    def dimension(
        self, start: Place, stop: Place, words: str, shift: Place = (0, 0),
        *, feet: Sequence[Place] = (), outside: bool = False, on: str = "white",
    ) -> None:  # fmt: skip
        """Draw a dimension line, with extension lines to its ends, or to the first, from ``feet``.

        With ``outside`` the arrows point inwards, where room is short.
        """
        ends = np.array([start, stop], dtype=float)
        for foot, end in zip(feet, ends, strict=False):
            self.line(foot, end + 0.15 * self.cm * _unit(foot, end))
        if outside:
            for end, other in (ends, ends[::-1]):
                self.arrow(end + 0.55 * self.cm * _unit(other, end), end, width=self.THIN)
            self.line(*ends)
        else:
            self.arrow(ends[0], ends[1], heads="<|-|>", width=self.THIN)
        self.text(ends.mean(axis=0), words, shift, on="none" if any(shift) else on)

    def leader(self, point: Place, way: Place, number: str) -> None:
        """Draw a leader line from a part of the scheme to its number, ``way`` (cm) from there."""
        end = np.asarray(point) + self.cm * np.asarray(way)
        self.line(point, end, zorder=7)
        self.point(point, size=2.2, zorder=7)
        self.text(end, number, 0.22 * _unit(point, end), fontsize=10)

    def ground(self, start: Place, stop: Place) -> None:
        """Draw a fixed support, with short strokes to the right of the line to ``stop``."""
        along, pitch = _unit(start, stop), 0.16 * self.cm
        self.line(start, stop, width=self.OUTLINE)
        for place in np.arange(pitch / 2, np.hypot(*np.subtract(stop, start)), pitch):
            foot = start + place * along
            self.line(foot, foot - pitch * (along + _left(along)), width=0.7)

    def spring(self, start: Place, stop: Place, coils: int = 5, **look: Any) -> None:
        """Draw a spring: a zigzag between two points, with straight ends."""
        lead = min(0.2 * self.cm / float(np.hypot(*np.subtract(stop, start))), 0.2)
        turns = np.linspace(lead, 1.0 - lead, 2 * coils + 1)
        shares = [0.0, lead, *(turns[1:] + turns[:-1]) / 2, 1.0 - lead, 1.0]
        sides = [0.0, 0.0, *([0.17, -0.17] * coils), 0.0, 0.0]
        self._link([(1.0, [*zip(shares, sides, strict=True)])], start, stop, **look)

    def damper(self, start: Place, stop: Place, about: Point | None = None) -> None:
        """Draw a dashpot, rod and piston from ``start`` in a pot at ``stop``, round ``about``."""
        self._link(_DASHPOT, start, stop, about)

    def _link(
        self, strokes: _Strokes, start: Place, stop: Place, about: Point | None = None, **look: Any
    ) -> None:
        look = {"color": self.SUSPENSION, **look}
        for width, shape in strokes:
            dense = np.concatenate([np.linspace(p, q, 13) for p, q in itertools.pairwise(shape)])
            share, side = dense[:, :1], self.cm * dense[:, 1:]
            points = start + share * np.subtract(stop, start) + side * _left(_unit(start, stop))
            if about is not None:
                x, y = (np.array([start, stop]) - about).T
                angles = np.interp(share[:, 0], [0.0, 1.0], np.arctan2(y, x))
                points = about + (np.hypot(x[0], y[0]) - side) * towards(angles)
            self.line(*points, width=width, **look)


class Scheme(Sheet):
    """A sheet with the part in its ``pose``, and the shapes that several figures share.

    ``a``, ``b`` and ``half`` are half-width and half-height of the part and half-width of the slot.
    """

    def __init__(self, axes: Axes, pose: Pose, cm: float, left: float, bottom: float) -> None:
        super().__init__(axes, cm, left, bottom)
        self.pose, p = pose, pose.constants
        self.a, self.b, self.half = p.half_width, p.half_height, p.slot_half_width

    def at(self, face: float, axis: float, along: float = 0.0, up: float = 0.0) -> Point:
        """Return C + face a e_t + axis b e_n, moved ``along`` cm along e_t and ``up`` along e_n."""
        return self.pose.at(face * self.a + along * self.cm, axis * self.b + up * self.cm)

    def part(self) -> None:
        """Draw the part."""
        self.area(self.pose.corners(), self.PART, label="part")

    def base(self, reach: float, depth: float) -> None:
        """Draw a base ``reach`` cm to either side of a blind slot that is ``depth`` cm deep."""
        half, far, floor = self.half, self.half + reach * self.cm, -depth * self.cm
        slot = [(-half, 0.0), (-half, floor), (half, floor), (half, 0.0)]
        profile = [(-far, 0.0), *slot, (far, 0.0)]
        self.cut([*profile, (far, floor - 0.4 * self.cm), (-far, floor - 0.4 * self.cm)])
        self.line(*profile, width=self.OUTLINE, label="base")

    def frame(self, right: float, top: float) -> None:
        """Draw the axes X and Y from O up to ``right`` and ``top``."""
        self.arrow((0, 0), (right, 0), "$X$", (0.0, -0.28), width=self.THIN, zorder=4)
        self.arrow((0, 0), (0, top), "$Y$", (-0.28, 0.0), width=self.THIN, zorder=4)
        self.point((0, 0), "$O$", (-0.25, 0.22), 3.0)

    def tilt(self, pivot: Point, radius: float, start: float, clear: float) -> None:
        """Mark φ about ``pivot`` from the angle ``start``, its name ``clear`` cm farther out."""
        self.arc(pivot, radius, start, start + self.pose.tilt)
        away = (radius + clear * self.cm) * towards(start + self.pose.tilt / 2)
        self.text(pivot + away, r"$\varphi$")

    def tilt_of_face(self, reach: float) -> None:
        """Mark φ between the base and the bottom face, extended by ``reach`` cm to the right."""
        edge, end = self.pose.edge(RIGHT_EDGE), self.at(1, -1, reach)
        self.line(edge, self.at(1, -1, reach + 0.12), linestyle=(0, (4, 2)))
        self.tilt(edge, float(np.hypot(*(end - edge))), 0.0, 0.32)


def new_scheme(
    parameters: Parameters, part: float, left: float, bottom: float, above: float, least: float = 0
) -> Scheme:
    """Return a page with the part at rest on A1, ``part`` cm high (see ``Pose.centimetre``).

    The page begins at (``left``, ``bottom``), in centimetres from O, and ends ``above`` cm over the
    part, but not below ``least``.
    """
    pose = resting_pose(parameters)
    cm = pose.centimetre(part)
    height = max(pose.top / cm + above, least) - bottom
    figure = style.new_figure(height=height * style.CENTIMETRE)
    return Scheme(figure.add_axes((0.0, 0.0, 1.0, 1.0)), pose, cm, left, bottom)


def _unit(start: Place, stop: Place) -> Point:
    way = np.subtract(stop, start, dtype=float)
    return np.asarray(way / np.hypot(*way))


def _left(vector: Point) -> Point:
    return np.array([-vector[1], vector[0]])
