"""Axes of equal scales, with the primitives of a mechanical scheme and shapes of several figures.

Points are in the model's dimensionless lengths. ``cm`` is the length that fills a centimetre on
paper; symbols and all that is not part of the model have sizes in ``cm``, so that they stay legible
for a part of any size.

schemdraw was weighed for the primitives: it places electrical elements on a grid of its own and
has no dashpot, cut material or dimension line.
"""

import itertools
from collections.abc import Sequence
from math import pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon
from numpy.typing import ArrayLike

from model.physics.notation import RIGHT_EDGE
from model.show import style
from model.show.schematics.pose import Point, Pose, towards

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
    """Axes of equal scales with the primitives of a mechanical scheme.

    Args:
        axes: to draw on.
        cm: the length that fills a centimetre on paper.
        left: the lower left corner of ``axes``, in centimetres from O.
        bottom: likewise.
    """

    def __init__(self, axes: Axes, cm: float, left: float, bottom: float) -> None:
        self.axes, self.cm = axes, cm
        box = axes.get_position()
        width, height = axes.get_figure().get_size_inches() / style.CENTIMETRE  # type: ignore[union-attr]
        axes.set_xlim(left * cm, (left + box.width * width) * cm)
        axes.set_ylim(bottom * cm, (bottom + box.height * height) * cm)
        axes.set_axis_off()

    def line(self, *points: ArrayLike, width: float = THIN, **look: Any) -> None:
        """Draw a polyline."""
        x, y = np.array(points, dtype=float).T
        look = {"color": style.BLACK, "solid_capstyle": "round", "zorder": 3, **look}
        self.axes.plot(x, y, linewidth=width, **look)

    def chain(self, *points: ArrayLike, **look: Any) -> None:
        """Draw a chain line: an axis of symmetry."""
        self.line(*points, linestyle=(0, (12, 2.5, 2, 2.5)), dash_capstyle="butt", **look)

    def area(self, points: ArrayLike, colour: str, **look: Any) -> None:
        """Draw a filled polygon with an outline."""
        look = {"edgecolor": style.BLACK, "linewidth": OUTLINE, "zorder": 2, **look}
        self.axes.add_patch(Polygon(np.asarray(points), closed=True, facecolor=colour, **look))

    def cut(self, points: ArrayLike, **look: Any) -> None:
        """Hatch a polygon of cut material, without its outline."""
        grey = {"hatch": "///", "edgecolor": "#B0A890", "linewidth": 0.0, "zorder": 1}
        self.area(points, BASE_COLOUR, **{**grey, **look})

    def dot(self, point: ArrayLike, size: float = 3.5, **look: Any) -> None:
        """Draw a point of the scheme."""
        look = {"color": style.BLACK, "zorder": 6, **look}
        self.axes.plot(*np.asarray(point), marker="o", markersize=size, **look)

    def text(
        self, point: ArrayLike, words: str, shift: Sequence[float] = (0, 0), **look: Any
    ) -> None:
        """Write text centred on ``point``, moved by ``shift`` centimetres."""
        x, y = np.asarray(point) + np.asarray(shift) * self.cm
        look = {"ha": "center", "va": "center", "zorder": 8, **look}
        if "on" in look:  # the colour behind, where lines would run through the words
            look["bbox"] = {"facecolor": look.pop("on"), "edgecolor": "none", "pad": 0.8}
        self.axes.text(x, y, words, **look)

    def arrow(
        self, tail: ArrayLike, head: ArrayLike, heads: str = "-|>", width: float = THIN, **look: Any
    ) -> None:
        """Draw a straight arrow; force arrows have ``width=FORCE``."""
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

    def point(
        self, place: ArrayLike, words: str, shift: Sequence[float], size: float = 3.5, **look: Any
    ) -> None:
        """Draw a point with its name."""
        self.dot(place, size, **look)
        self.text(place, words, shift)

    def vector(
        self,
        tail: ArrayLike,
        head: ArrayLike,
        words: str,
        shift: Sequence[float],
        *,
        at: ArrayLike | None = None,
        color: str = style.BLACK,
        width: float = FORCE,
        zorder: float = 5,
        **look: Any,
    ) -> None:
        """Draw an arrow with its name by its head, or by ``at``."""
        self.arrow(tail, head, width=width, color=color, zorder=zorder)
        self.text(head if at is None else at, words, shift, color=color, **look)

    def box(self, left: float, right: float, low: float, high: float, colour: str) -> None:
        """Draw an upright rectangle."""
        self.area([(left, low), (right, low), (right, high), (left, high)], colour)

    def arc(self, centre: ArrayLike, radius: float, start: float, stop: float, **look: Any) -> None:
        """Draw an arc from angle ``start`` to ``stop`` (radians) with an arrow head at its end."""
        angles = np.linspace(start, stop, 61)
        points = np.asarray(centre) + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        width, zorder = look.pop("width", THIN), look.pop("zorder", 4)
        # The arrow head covers the end of the arc: the line ends before its tip.
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
        """Draw a dimension line; with ``outside`` the arrows point inwards, where room is short."""
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
        """Draw a leader line from a part of the scheme to its number."""
        self.line(point, end, zorder=7)
        self.dot(point, 2.2, zorder=7)
        away = np.asarray(end) - np.asarray(point)
        self.text(end, number, tuple(0.22 * away / np.hypot(*away)), fontsize=10)

    def spring(self, start: ArrayLike, stop: ArrayLike, coils: int = 5, **look: Any) -> None:
        """Draw a spring: a zigzag between two points, with straight ends."""
        along, across, length = self._frame(start, stop)
        lead = min(0.2 * self.cm, 0.2 * length)
        turns = np.linspace(lead, length - lead, 2 * coils + 1)
        turns = np.concatenate([turns[:1], (turns[1:] + turns[:-1]) / 2, turns[-1:]])
        sides = 0.17 * self.cm * np.array([0.0, *([1.0, -1.0] * coils), 0.0])
        zigzag = np.outer(turns, along) + np.outer(sides, across) + np.asarray(start)
        look = {"color": SUSPENSION, "solid_joinstyle": "round", **look}
        self.line(start, *zigzag, stop, width=1.0, **look)

    def damper(self, start: ArrayLike, stop: ArrayLike, **look: Any) -> None:
        """Draw a dashpot: rod and piston from ``start`` in a pot held at ``stop``."""
        along, across, length = self._frame(start, stop)
        for width, shape in _DASHPOT:
            points = [
                np.asarray(start) + share * length * along + side * self.cm * across
                for share, side in shape
            ]
            self.line(*points, width=width, **{"color": SUSPENSION, **look})

    def bent_damper(self, centre: ArrayLike, radius: float, start: float, stop: float) -> None:
        """Draw a dashpot bent round ``centre`` from angle ``start`` to ``stop``."""
        for width, shape in _DASHPOT:
            rounded = np.concatenate([np.linspace(p, q, 13) for p, q in itertools.pairwise(shape)])
            angles = start + rounded[:, 0] * (stop - start)
            radii = radius - rounded[:, 1] * self.cm
            points = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
            self.line(*(np.asarray(centre) + points), width=width, color=SUSPENSION)

    def spiral(self, centre: ArrayLike, radii: tuple[float, float], end: float) -> Point:
        """Draw a spiral spring between ``radii`` (cm) to angle ``end``; return its outer end."""
        angles = np.linspace(end - 3.5 * pi, end, 181)
        turns = np.column_stack([np.cos(angles), np.sin(angles)])
        points = np.asarray(centre) + np.linspace(*radii, 181)[:, None] * self.cm * turns
        self.line(*points, width=1.0, color=SUSPENSION)
        return np.asarray(points[-1])

    def ground(self, start: ArrayLike, stop: ArrayLike) -> None:
        """Draw a fixed support, with short strokes to the right of the line to ``stop``."""
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

    # --- Shared by several figures --------------------------------------------------------------

    def part(self, pose: Pose) -> None:
        """Draw the part."""
        self.area(pose.corners(), PART_COLOUR, label="part")

    def base(self, pose: Pose, reach: float, depth: float) -> None:
        """Draw a base ``reach`` cm to either side of a blind slot that is ``depth`` cm deep."""
        cm, half = self.cm, pose.constants.slot_half_width
        far, floor = half + reach * cm, -depth * cm
        slot = [(-half, 0.0), (-half, floor), (half, floor), (half, 0.0)]
        profile = [(-far, 0.0), *slot, (far, 0.0)]
        self.cut([*profile, (far, floor - 0.4 * cm), (-far, floor - 0.4 * cm)])
        self.line(*profile, width=OUTLINE, label="base")

    def frame(self, right: float, top: float, origin: Sequence[float] = (-0.3, -0.38)) -> None:
        """Draw the axes X and Y up to ``right`` and ``top``; the letter O is at ``origin``."""
        self.vector((0, 0), (right, 0), "$X$", (0.0, -0.28), width=THIN, zorder=4)
        self.vector((0, 0), (0, top), "$Y$", (-0.28, 0.0), width=THIN, zorder=4)
        self.point((0, 0), "$O$", origin, 3.0)

    def tilt(self, pose: Pose, pivot: Point, radius: float, start: float, clear: float) -> None:
        """Mark φ about ``pivot`` from the angle ``start``, its name ``clear`` cm farther out."""
        self.arc(pivot, radius, start, start + pose.tilt)
        middle = start + pose.tilt / 2
        self.text(pivot + (radius + clear * self.cm) * towards(middle), r"$\varphi$")

    def tilt_of_face(self, pose: Pose, reach: float) -> None:
        """Mark φ between the base and the bottom face, extended by ``reach`` cm to the right."""
        edge = pose.edge(RIGHT_EDGE)
        radius = float(np.hypot(*(pose.corners()[0] - edge))) + reach * self.cm
        self.line(edge, edge + (radius + 0.12 * self.cm) * pose.along_face, linestyle=(0, (4, 2)))
        self.tilt(pose, edge, radius, 0.0, 0.32)


def new_sheet(cm: float, left: float, bottom: float, height: float) -> tuple[Figure, Sheet]:
    """Return a figure of the full text width with one sheet on it; sizes in centimetres."""
    figure = style.new_figure(height=height * style.CENTIMETRE)
    figure.set_layout_engine("none")  # the sheet fills the figure, by construction
    return figure, Sheet(figure.add_axes((0.0, 0.0, 1.0, 1.0)), cm, left, bottom)


def centimetre(pose: Pose, part_height: float) -> float:
    """Return the length of a centimetre for a part ``part_height`` cm high, 3.4 wide at most."""
    p = pose.constants
    return max(2 * p.half_height / part_height, 2 * p.half_width / 3.4)
