"""Stability maps, such as Figs. 13 and 14: areas, borders and contours."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerPatch
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Outline
from matplotlib.patheffects import Stroke, withStroke, withTickedStroke
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from model.events.outcomes import Outcome
from model.sweeps.vibration import ONLY_VIBRATED, added, success_of
from vibralign.answers.si import readable
from vibralign.plots import style
from vibralign.plots.style import Bools, Floats

Place = tuple[float, float]
Handle = Patch | Line2D
Look = Mapping[str, Any]  # keyword arguments of an artist

LEFT_LABEL, NOT_IN = "of these, leaves the scene", "does not go in"
SLOW_LABEL = "ticked side: rests if pressed slowly"
RELIABLE_LABEL = "ticked side: aligns from every start"
VIBRATION_LABEL = "ticked side: aligns only if vibrated"
# In the order of ``vibration.added``.
ADDED_LABELS = (
    "aligns, vibrated or not",
    "aligns only if vibrated",
    "aligns only if not vibrated",
    "does not align, vibrated or not",
)

_PLAIN: Look = {"linewidth": 0.0}
# The area where the parts do not align is hatched as in the paper.
NON_ALIGNING: Look = {**_PLAIN, "facecolor": "#F4F4F4", "edgecolor": style.GREY, "hatch": "////"}
_OVER: Look = {**_PLAIN, "zorder": 2.0}  # over the colour of the duration
_DOTTED: Look = {**_OVER, "facecolor": "none", "edgecolor": "#FFFFFF", "hatch": "...."}
_DOTS: Look = {**_DOTTED, "facecolor": style.BLUE}  # in the legend, where nothing is behind them
_ADDED: tuple[Look, ...] = (
    {**_PLAIN, "facecolor": style.SKY_BLUE, "edgecolor": style.BLUE, "hatch": "..."},
    {**_PLAIN, "facecolor": style.GREEN},
    {**_PLAIN, "facecolor": style.ORANGE, "edgecolor": style.BLACK, "hatch": "\\\\\\\\"},
    NON_ALIGNING,
)

_SPREAD_FOR_LOG = 8.0  # longest over shortest duration beyond which colours are logarithmic
_COLOURED_SHARE = 0.99  # share of the durations that the colour scale covers
_DECADE = (1.0, 2.0, 3.0, 5.0)  # round numbers of a logarithmic scale
_CONTOURS = 5  # approximate number
_CONTOUR_NODES = 128  # nodes along a side from which contours are drawn, at most
_APART = 0.035  # share of the map, between labels of contours
_LETTERS = 80  # of a legend in one row, at most
_LEAST = 0.004  # share of the map; a contour around a smaller area is left out


def stability_map(
    dataset: xr.Dataset, marked: Callable[[Axes], list[Handle]] = lambda _: []
) -> Figure:
    """Draw durations in colour where the part aligns, hatching where it does not.

    Dots mark where it aligns and does not go in. Contours of the duration, and the outlines of the
    reliable area and of the one that needs vibration, are drawn over it. What is in SI units is
    drawn in mm, ms, kN/m. ``marked`` draws more, and returns the handles for the legend.
    """
    dataset = readable(dataset)
    durations = np.ma.masked_invalid(dataset["tau_align"].values)
    outcome, label, every = dataset["outcome"].values, style.NOT_ALIGNED, RELIABLE_LABEL
    if success_of(dataset) is Outcome.INSERTED:
        durations = np.ma.masked_where(outcome != Outcome.INSERTED, durations)
        label, every = NOT_IN, RELIABLE_LABEL.replace("aligns", "goes in")
    gaps = np.ma.getmaskarray(durations)
    with style.context():
        drawing = _Drawing(dataset)
        drawing.area(gaps, label, NON_ALIGNING)
        left = np.isin(outcome, (Outcome.LEFT_SCENE, Outcome.CLIMBED_OUT))
        if left.any():
            drawing.area(left, LEFT_LABEL, {**_PLAIN, "facecolor": style.BLACK, "alpha": 0.16})
        failed = outcome == Outcome.FAILED
        if failed.any():
            drawing.area(failed, style.FAILED_LABEL, {**_PLAIN, "facecolor": style.VERMILLION})
        lost = style.not_inserted(dataset)
        if lost.any():
            drawing.area(lost, style.NOT_INSERTED, _DOTTED)
            drawing.handles[-1] = Patch(label=style.NOT_INSERTED, **_DOTS)
        if not gaps.all():
            drawing.durations(durations, style.axis_label(dataset["tau_align"]))
        drawing.borders(gaps)
        drawing.contours(durations)
        if "reliable" in dataset:
            drawing.reliable(dataset["reliable"] == 1, every, style.VERMILLION)
        if "unvibrated" in dataset:
            needed = dataset["unvibrated"].copy(data=added(dataset) == ONLY_VIBRATED)
            drawing.outline(needed, VIBRATION_LABEL, style.BLACK, "--")
        drawing.handles += marked(drawing.axes)
        return drawing.with_legend()


def vibration_map(dataset: xr.Dataset) -> Figure:
    """Draw where the part aligns only if vibrated, only if not, in both cases, and in neither.

    A line, ticked inwards, surrounds the parts that rest on the edge if they are pressed slowly.
    """
    areas = added(dataset)
    with style.context():
        drawing = _Drawing(dataset)
        for area, (label, look) in enumerate(zip(ADDED_LABELS, _ADDED, strict=True)):
            drawing.area(areas == area, label, look)
        drawing.outline(dataset["slow_tilt"].notnull(), SLOW_LABEL, style.BLACK, "-")
        return drawing.with_legend()


def round_levels(values: Floats) -> list[float]:
    """Return round numbers inside the range of ``values``; logarithmic if the range is wide."""
    if values.size == 0:
        return []
    low, high = (float(value) for value in np.quantile(values, [_LEAST, 1.0 - _LEAST]))
    linear = MaxNLocator(_CONTOURS, steps=[1, 2, 5, 10])
    ticks = (LogLocator(subs=_DECADE) if _spreads(low, high) else linear).tick_values(low, high)
    levels = [float(level) for level in ticks if low < level < high]
    return levels[:: max(1, round(len(levels) / _CONTOURS))]


def _spreads(low: float, high: float) -> bool:
    return high > _SPREAD_FOR_LOG * low > 0.0


class _Drawing:
    """A figure with the axes of a dataset's two parameters, and the handles of its legend.

    Arrays have the shape (y, x) of the dataset's nodes; a node stands for the cell around it.
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        y, x = (dataset[str(name)] for name in dataset["outcome"].dims)
        self.x, self.y = x, y
        self.edges = style.cell_edges(x.values), style.cell_edges(y.values)
        self.handles: list[Handle] = []
        self.figure = style.new_figure(height=11.0 * style.CENTIMETRE)
        self.axes = self.figure.subplots()
        self.axes.grid(visible=False)
        self.axes.spines[["top", "right"]].set_visible(True)
        self.axes.set_xlim(self.edges[0][0], self.edges[0][-1])
        self.axes.set_ylim(self.edges[1][0], self.edges[1][-1])
        for set_label, each in ((self.axes.set_xlabel, x), (self.axes.set_ylabel, y)):
            in_si = dataset["tau_align"].attrs.get("units", "1") != "1"
            own = style.label_of(str(each.name), each.attrs.get("units", ""))
            set_label(own if in_si else style.axis_label(each))

    def with_legend(self) -> Figure:
        """Return the figure with its legend below."""
        letters = sum(len(str(handle.get_label())) for handle in self.handles)
        is_short = len(self.handles) < 4 and letters < _LETTERS
        self.figure.legend(
            handles=self.handles,
            loc="outside lower center",
            ncols=len(self.handles) if is_short else 2,
            handler_map={PathPatch: HandlerPatch()},
            handleheight=1.4,
        )
        return self.figure

    def area(self, cells: Bools, label: str, look: Look) -> None:
        """Draw the cells where ``cells`` is True as one patch, if there are any."""
        if not cells.any():
            return
        x, y = self.edges
        corners: list[Place] = []
        codes: list[np.uint8] = []
        for row, mask in enumerate(cells):
            for i, j in style.runs_of(mask):
                low, high = y[row], y[row + 1]
                corners += [(x[i], low), (x[j], low), (x[j], high), (x[i], high), (x[i], low)]
                codes += [Outline.MOVETO, *[Outline.LINETO] * 3, Outline.CLOSEPOLY]
        outline = Outline(np.array(corners, dtype=float).reshape(-1, 2), codes or None)
        self.handles.append(self.axes.add_patch(PathPatch(outline, label=label, **look)))

    def durations(self, durations: np.ma.MaskedArray, label: str) -> None:
        """Colour the cells by their duration, with a colour bar."""
        shortest, longest = float(durations.min()), float(durations.max())
        spread = _spreads(shortest, longest)
        # A few runs near the border take very long: the scale leaves them out.
        top = float(np.quantile(durations.compressed(), _COLOURED_SHARE)) if spread else longest
        norm = LogNorm(shortest, top) if spread else Normalize(shortest, top)
        # Rasterized: thousands of cells as vectors would make SVG and PDF files of many megabytes.
        mesh = self.axes.pcolormesh(*self.edges, durations, norm=norm, rasterized=True)
        extend = "max" if spread else "neither"
        bar = self.figure.colorbar(mesh, ax=self.axes, pad=0.02, extend=extend)
        bar.set_label(f"{label}, logarithmic" if spread else label)
        if spread:
            bar.ax.yaxis.set_major_locator(LogLocator(subs=_DECADE))
            bar.ax.yaxis.set_major_formatter("{x:g}")
            bar.ax.yaxis.set_minor_formatter(NullFormatter())

    def borders(self, cells: Bools) -> None:
        """Draw straight lines between cells that differ."""
        lines: list[list[Place]] = []
        x, y = self.edges
        for turned, (across, along) in ((False, (x, y)), (True, (y, x))):
            inside = cells if turned else cells.T
            differ = inside[1:] != inside[:-1]
            for at, mask in zip(across[1:-1], differ, strict=True):
                for i, j in style.runs_of(mask):
                    ends = (at, along[i]), (at, along[j])
                    lines.append([end[::-1] if turned else end for end in ends])
        look: Look = {"colors": style.BLACK, "linewidths": 0.7, "label": "_border"}
        self.axes.add_collection(LineCollection(lines, **look), autolim=False)

    def contours(self, values: np.ma.MaskedArray) -> None:
        """Draw labelled contours of ``values`` at round numbers."""
        levels = round_levels(values.compressed())
        if not levels:
            return
        # Of a fine map every n-th node: this smooths the lines where the duration jumps.
        every = max(1, (self.x.size - 1) // _CONTOUR_NODES)
        nodes = self.x.values[::every], self.y.values[::every], values[::every, ::every]
        lines = self.axes.contour(*nodes, levels, colors="white", linewidths=0.8, zorder=2.5)
        lines.set_label("_contours")
        shadow = Stroke(linewidth=1.4, foreground="#00000066")
        lines.set_path_effects([shadow, Stroke(linewidth=0.8)])
        labels = self.axes.clabel(
            lines,
            manual=list(self._label_places(lines)),
            fmt=lambda value: f"{value:g}",
            fontsize=7.0,
            inline_spacing=2,
        )
        for label in labels:
            label.set_path_effects([withStroke(linewidth=1.6, foreground="#000000AA")])

    def _label_places(self, lines: QuadContourSet) -> Iterator[Any]:
        """Yield a place for each level: the middle of its longest line, unless near another's."""
        taken: list[Any] = []
        size = float(np.ptp(self.x.values)), float(np.ptp(self.y.values))
        for path in lines.get_paths():
            parts = [np.asarray(part) for part in path.to_polygons(closed_only=False)]
            lengths = [np.hypot(*(np.diff(part, axis=0) / size).T).sum() for part in parts]
            if lengths:
                longest = parts[int(np.argmax(lengths))]
                place = longest[len(longest) // 2]
                if all(np.hypot(*((place - each) / size)) > _APART for each in taken):
                    taken.append(place)
                    yield tuple(place)

    def reliable(self, inside: xr.DataArray, label: str, colour: str) -> None:
        """Outline the nodes ``inside``; on a coarser grid mark each, as a line would join them."""
        if inside.size == self.x.size * self.y.size:
            self.outline(inside, label, colour, "-")
        elif inside.any():
            y, x = (inside[name].values for name in inside.dims)
            rows, columns = np.nonzero(inside.values)
            words = label.removeprefix("ticked side: ") + ", where these are tried"
            look: Look = {"linestyle": "none", "marker": ".", "markersize": 2.0, "color": colour}
            self.axes.plot(x[columns], y[rows], label=f"_{words}", **look)
            self.handles.append(Line2D([], [], label=words, **{**look, "markersize": 6.0}))

    def outline(
        self, inside: xr.DataArray, label: str, colour: str, line: Literal["-", "--"]
    ) -> None:
        """Outline the nodes ``inside``, with ticks inwards, halfway between nodes."""
        if inside.all() or not inside.any():
            return
        y, x = (inside[name].values for name in inside.dims)
        outline: QuadContourSet = self.axes.contour(
            x,
            y,
            inside.values.astype(float),
            [0.5],
            colors=colour,
            linestyles=line,
            linewidths=1.6,
            zorder=3.0,
        )
        outline.set_label(f"_{label}")
        ticks = withTickedStroke(spacing=8.0, angle=90.0, length=0.5, linewidth=0.8)
        outline.set_path_effects([withStroke(linewidth=2.6, foreground="white"), ticks])
        look: Look = {"linewidth": 1.6, "color": colour, "linestyle": line}
        self.handles.append(Line2D([], [], label=label, **look))
