"""Overlays of a stability map: contours of the duration, reliable area, points of other figures.

``areas.stability_map`` draws the areas. These functions draw on its axes, and return the handles of
the legend.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet
from matplotlib.lines import Line2D
from matplotlib.patheffects import Stroke, withStroke, withTickedStroke
from matplotlib.ticker import LogLocator, MaxNLocator
from numpy.typing import NDArray

from model.show import style
from model.study.vibration import ONLY_VIBRATED, added

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Place = tuple[float, float]

RELIABLE_LABEL = "reliable: at every phase"
VIBRATION_LABEL = "ticked side: aligns only if vibrated"
MARK_LABEL = "other figures, by number"
_CONTOURS = 5  # approximate number
_CONTOUR_NODES = 128  # nodes along a side from which contours are drawn, at most
_LEAST = 0.004  # share of the map; a contour around a smaller area is left out
_APART = 0.04  # share of the map; least distance between numbers


def add_contours(axes: Axes, x: Floats, y: Floats, values: np.ma.MaskedArray) -> None:
    """Draw labelled contours of ``values``, shape (y, x), at round numbers."""
    levels = round_levels(values.compressed())
    if not levels:
        return
    # Every n-th node of a fine map, for smooth lines where the duration jumps.
    every = max(1, (len(x) - 1) // _CONTOUR_NODES)
    lines = axes.contour(
        x[::every],
        y[::every],
        values[::every, ::every],
        levels,
        colors="white",
        linewidths=0.8,
        zorder=2.5,
    )
    lines.set_label("_contours")
    lines.set_path_effects([Stroke(linewidth=1.4, foreground="#00000066"), Stroke(linewidth=0.8)])
    labels = axes.clabel(
        lines,
        manual=list(_label_places(lines, float(np.ptp(x)), float(np.ptp(y)))),
        fmt=lambda value: f"{value:g}",
        fontsize=7.0,
        inline_spacing=2,
    )
    for label in labels:
        label.set_path_effects([withStroke(linewidth=1.6, foreground="#000000AA")])


def _label_places(lines: QuadContourSet, width: float, height: float) -> Iterator[Any]:
    """Yield one place for each level: the middle of its longest line."""
    for path in lines.get_paths():
        parts = [np.asarray(part) for part in path.to_polygons(closed_only=False)]
        lengths = [np.hypot(*(np.diff(part, axis=0) / (width, height)).T).sum() for part in parts]
        if lengths:
            longest = parts[int(np.argmax(lengths))]
            yield tuple(longest[len(longest) // 2])


def round_levels(values: Floats) -> list[float]:
    """Return round numbers inside the range of ``values``; logarithmic if the range is wide."""
    if values.size == 0:
        return []
    low, high = (float(each) for each in np.quantile(values, [_LEAST, 1.0 - _LEAST]))
    if low > 0.0 and high > 8.0 * low:
        locator: Any = LogLocator(subs=(1.0, 2.0, 3.0, 5.0))
    else:
        locator = MaxNLocator(_CONTOURS, steps=[1, 2, 5, 10])
    found = [float(level) for level in locator.tick_values(low, high) if low < level < high]
    return found[:: max(1, round(len(found) / _CONTOURS))]


def add_reliable(axes: Axes, dataset: "xr.Dataset") -> list[Line2D]:
    """Draw the outline of the reliable area."""
    if "reliable" not in dataset or "ensemble_phases" not in dataset.attrs:
        return []
    reliable = dataset["reliable"].values == 1
    return add_outline(axes, dataset, reliable, RELIABLE_LABEL, style.VERMILLION, "-")


def add_vibration(axes: Axes, dataset: "xr.Dataset") -> list[Line2D]:
    """Draw the outline of the area in which the part does not align without vibration."""
    if "unvibrated" not in dataset:
        return []
    inside = added(dataset) == ONLY_VIBRATED
    return add_outline(axes, dataset, inside, VIBRATION_LABEL, style.BLACK, "--")


def add_outline(
    axes: Axes,
    dataset: "xr.Dataset",
    inside: NDArray[np.bool_],
    label: str,
    colour: str,
    line: Literal["-", "--"],
) -> list[Line2D]:
    """Draw the outline of the nodes ``inside``, ticked inwards; return its handle, if it is any.

    In a patch of the map, where outcomes alternate, there is none.
    """
    if inside.all() or not inside.any():
        return []
    y, x = (dataset[name].values for name in dataset["outcome"].dims)
    patch = dataset["patch"].values == 1 if "patch" in dataset else np.zeros_like(inside)
    outline: QuadContourSet = axes.contour(
        x,
        y,
        np.ma.masked_array(inside.astype(float), patch),
        [0.5],
        colors=colour,
        linestyles=line,
        linewidths=1.6,
        zorder=3.0,
    )
    outline.set_label(f"_{label}")
    ticks = withTickedStroke(spacing=8.0, angle=90.0, length=0.5, linewidth=0.8)
    outline.set_path_effects([withStroke(linewidth=2.6, foreground="white"), ticks])
    return [Line2D([], [], linewidth=1.6, label=label, color=colour, linestyle=line)]


def add_marks(axes: Axes, dataset: "xr.Dataset") -> list[Line2D]:
    """Draw the numbers of other figures at their operating points, and lines along their sweeps."""
    places: dict[tuple[Place, Place], list[str]] = {}  # by (end, start) of a range
    for figure, x, y in json.loads(dataset.attrs.get("operating_points", "[]")):
        inside_x, inside_y = np.clip(x, *axes.get_xlim()), np.clip(y, *axes.get_ylim())
        if (len(x) == 1 and inside_x[0] != x[0]) or (len(y) == 1 and inside_y[0] != y[0]):
            continue  # outside the map
        if max(len(x), len(y)) > 1:
            _add_swept(axes, np.broadcast_to(inside_x, 2), np.broadcast_to(inside_y, 2), figure)
        ends = (inside_x[-1], inside_y[-1]), (inside_x[0], inside_y[0])
        names = places.setdefault(ends, [])
        if figure not in names:
            names.append(figure)
    taken: list[Floats] = []
    for end, start in sorted(
        places, key=lambda ends: ends[0] != ends[1]
    ):  # points first: they cannot move
        _add_number(axes, _free_place(axes, end, start, taken), places[end, start])
    if not places:
        return []
    look: Mapping[str, Any] = {"markerfacecolor": "white", "markeredgecolor": style.BLACK}
    return [Line2D([], [], linestyle="none", marker="o", markersize=6, label=MARK_LABEL, **look)]


def _free_place(axes: Axes, end: Place, start: Place, taken: list[Floats]) -> Place:
    """Return the place nearest to the ``end`` of a range that no other number covers.

    ``taken`` holds the places in use, as shares of the map; the new one is added.
    """
    to_share = axes.transData + axes.transAxes.inverted()
    places = np.linspace(end, start, 41)
    shares = to_share.transform(places)
    free = [all(np.hypot(*(share - other)) > _APART for other in taken) for share in shares]
    chosen = int(np.argmax(free))  # the end, where none is free
    taken.append(shares[chosen])
    return float(places[chosen, 0]), float(places[chosen, 1])


def _add_swept(axes: Axes, x: Floats, y: Floats, figure: str) -> None:
    axes.plot(
        x,
        y,
        color="white",
        linewidth=0.8,
        linestyle=(0, (2, 2)),
        label=f"_swept {figure}",
        path_effects=[Stroke(linewidth=1.5, foreground="#00000055"), Stroke(linewidth=0.8)],
        zorder=3.5,
    )


def _add_number(axes: Axes, place: Place, figures: Sequence[str]) -> None:
    words = ", ".join(figure.removeprefix("fig").lstrip("0") for figure in figures)
    axes.annotate(
        words,
        place,
        ha="center",
        va="center",
        fontsize=5.5,
        bbox={
            "boxstyle": "circle,pad=0.25" if len(words) < 3 else "round,pad=0.3",
            "facecolor": "white",
            "edgecolor": style.BLACK,
            "linewidth": 0.6,
        },
        annotation_clip=False,
        zorder=4.0,
    )
