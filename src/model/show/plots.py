"""Figs. 5-14: what the datasets of the study hold, drawn.

Where a part does not align, a duration does not exist: no line crosses such a gap, and a strip
below the curves, or the hatching of a map, says that nothing is missing there.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerPatch
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Outline
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.show import style
from model.show.maps import add_contours, add_marks, add_reliable
from model.show.words import math

if TYPE_CHECKING:  # a trajectory is drawn where xarray is not installed
    import xarray as xr

    from model.runs.simulate import Trajectory

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_SPREAD_FOR_LOG = 8.0  # longest over shortest duration beyond which colours are logarithmic
_COLOURED_SHARE = 0.99  # share of the durations that such colours tell apart


def draw(dataset: "xr.Dataset") -> Figure:
    """The figure of a dataset of the study, by its attribute ``kind``.

    Raises:
        ValueError: a dataset of no known kind.
    """
    kind = dataset.attrs.get("kind")
    if kind not in _DRAW:
        raise ValueError(f"kind = {kind!r}: must be one of {', '.join(_DRAW)}")
    return _DRAW[kind](dataset)


# --- Words and numbers --------------------------------------------------------------------------


def symbol_of(coordinate: "xr.DataArray") -> str:
    """A parameter's symbol as mathematical text; its name where it has none."""
    symbol = coordinate.attrs.get("symbol", coordinate.name)
    # What has no symbol of its own carries its name.
    return str(symbol) if symbol == coordinate.name else math(symbol)


def axis_label(coordinate: "xr.DataArray") -> str:
    """Words and symbol of a parameter: "initial pressing force $f_{0}$"."""
    words = str(coordinate.attrs.get("long_name", coordinate.name))
    words = re.split(r"; | \(", words, maxsplit=1)[0]  # what follows explains, it does not name
    symbol, unit = symbol_of(coordinate), coordinate.attrs.get("units", "1")
    label = words if symbol == words else f"{words} {symbol}"
    return label if unit == "1" else f"{label} in {unit}"


def cell_edges(values: Floats) -> Floats:
    """Edges of the cells around ``values``, shape (n,) to (n + 1,): halfway between neighbours."""
    middles = 0.5 * (values[1:] + values[:-1])
    first, last = 1.5 * values[0] - 0.5 * values[1], 1.5 * values[-1] - 0.5 * values[-2]
    return np.concatenate([[first], middles, [last]])


def runs_of(mask: Bools) -> Iterator[tuple[int, int]]:
    """Runs of True in ``mask``, shape (n,), as (first, one past the last)."""
    steps = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    yield from zip(steps[::2].tolist(), steps[1::2].tolist(), strict=True)


# --- Fig. 5: one trajectory ---------------------------------------------------------------------


@dataclass(frozen=True)
class _Course:
    """What the panels of Fig. 5 show; arrays have shape (n,)."""

    time: Floats
    panels: Mapping[str, Floats]
    side_force: Floats
    outcome: Outcome
    tau_align: float


def history(dataset: "xr.Dataset") -> Figure:
    """Fig. 5: x, y, tilt and contact force over time, with the moment of alignment."""
    names = {"x": "x", "y": "y", "φ": "tilt", "n": "contact_force"}
    return _draw_course(
        _Course(
            time=dataset["time"].values,
            panels={symbol: dataset[name].values for symbol, name in names.items()},
            side_force=dataset["side_force"].values,
            outcome=Outcome(int(dataset["outcome"])),
            tau_align=float(dataset["tau_align"]),
        )
    )


def trajectory(run: "Trajectory") -> Figure:
    """The figure of ``history`` for a run that was not stored."""
    x, y, tilt = run.state[:, :3].T
    return _draw_course(
        _Course(
            time=run.time,
            panels={"x": x, "y": y, "φ": tilt, "n": run.contact_force},
            side_force=run.side_force,
            outcome=run.outcome,
            tau_align=run.tau_align,
        )
    )


_PANEL_LABELS = {
    "x": "mass centre $x$",
    "y": "mass centre $y$",
    "φ": "tilt $φ$ (rad)",
    "n": "contact force $n$",
}


def _draw_course(course: _Course) -> Figure:
    with style.context():
        figure = style.new_figure(height=15.0 * style.CENTIMETRE)
        panels = figure.subplots(4, 1, sharex=True, height_ratios=[1, 1, 1, 1.35])
        for letter, axes, (symbol, values) in zip(
            "abcd", panels, course.panels.items(), strict=True
        ):
            axes.plot(course.time, values, color=style.BLUE, label=symbol)
            axes.set_ylabel(_PANEL_LABELS[symbol])
            axes.set_title(letter, loc="left", fontweight="bold", pad=3.0)
            axes.margins(x=0.01)
        figure.align_ylabels(panels)
        panels[-1].set_xlabel("time $τ$")
        _mark_end(course, panels)
        return figure


def _mark_end(course: _Course, panels: NDArray[np.object_]) -> None:
    force = panels[-1]
    low, high = force.get_ylim()
    force.set_ylim(low, high + 0.3 * (high - low))  # headroom for the words
    if np.any(course.side_force > 0.0):
        force.plot(
            course.time, course.side_force, color=style.VERMILLION, linestyle="--", label="side"
        )
        force.legend(force.lines, ["under the part", "on its side face"], loc="upper left", ncols=2)
    if course.outcome != Outcome.ALIGNED:
        ending = course.outcome.name.lower().replace("_", " ")
        panels[0].set_title(f"does not align ({ending})", loc="right", pad=3.0)
        return
    for axes in panels:
        axes.axvline(
            course.tau_align, color=style.GREY, linewidth=0.8, linestyle=":", label="alignment"
        )
    before = force_before(course.time, course.panels["n"], course.tau_align)
    words = f"$n$ drops to 0 at $τ$ = {course.tau_align:.4g}"
    if before == 0.0:
        words = f"aligned in flight at $τ$ = {course.tau_align:.4g}"
    force.annotate(
        words,
        xy=(course.tau_align, before),
        xytext=(0.94, 0.9),
        textcoords="axes fraction",
        ha="right",
        va="center",
        arrowprops={"arrowstyle": "->", "color": style.BLACK, "linewidth": 0.8},
    )


def force_before(time: Floats, force: Floats, moment: float) -> float:
    """The force just before ``moment``; where it jumps there, the value it jumps from."""
    return float(force[max(int(np.searchsorted(time, moment - 1e-9 * (1.0 + moment))), 0)])


# --- Figs. 6-12: alignment duration over one parameter ------------------------------------------

SENSITIVE_LABEL = "sensitive: digits uncertain"
FAILED_LABEL = "run failed"
NOT_ALIGNED = "does not align"


def curves(dataset: "xr.Dataset") -> Figure:
    """Figs. 6-12: duration over the swept parameter, a curve for each value of the family's.

    Lines are broken where the part does not align; the strip below shows there, a row for each
    curve, that it does not. An aligned point between two that do not align is drawn as a dot.
    """
    family, swept = (dataset[name] for name in dataset["tau_align"].dims)
    durations = dataset["tau_align"].values
    gaps = np.isnan(durations)
    failed = dataset["outcome"].values == Outcome.FAILED
    with style.context():
        figure, axes, strip = _curve_axes(len(family), bool(gaps.any()))
        handles = [
            _draw_curve(axes, row, swept.values, durations[row], f"{symbol_of(family)} = {value:g}")
            for row, value in enumerate(family.values)
        ]
        notes = _mark_sensitive(axes, swept.values, durations, dataset["sensitive"].values == 1)
        if strip is not None:
            notes += _draw_strip(strip, swept.values, gaps, failed)
        edges = cell_edges(swept.values)
        axes.set_xlim(edges[0], edges[-1])
        longest = np.nanmax(durations) if not gaps.all() else 1.0
        axes.set_ylim(0.0, 1.05 * float(longest))
        axes.set_ylabel(axis_label(dataset["tau_align"]))
        (strip or axes).set_xlabel(axis_label(swept))
        figure.legend(
            handles=handles,
            title=axis_label(family),
            loc="outside upper center",
            ncols=min(len(handles), 5),
        )
        if notes:
            figure.legend(handles=notes, loc="outside lower right", ncols=len(notes))
        return figure


def _curve_axes(rows: int, with_strip: bool) -> tuple[Figure, Axes, Axes | None]:
    height, row = 9.5 * style.CENTIMETRE, 0.22 * style.CENTIMETRE
    if not with_strip:
        figure = style.new_figure(height=height)
        return figure, figure.subplots(), None
    figure = style.new_figure(height=height + rows * row)
    figure.set_layout_engine("constrained", h_pad=0.03, hspace=0.0)
    axes, strip = figure.subplots(2, 1, sharex=True, height_ratios=[height - 2.5 * row, rows * row])
    return figure, axes, strip


def _draw_curve(axes: Axes, index: int, swept: Floats, durations: Floats, name: str) -> Line2D:
    """One curve with its gaps; matplotlib breaks a line at NaN. Returns the handle for a legend."""
    look = style.curve(index, len(swept))
    (line,) = axes.plot(swept, durations, label=name, **look)
    aligned = ~np.isnan(durations)
    lonely = np.zeros_like(aligned)
    for first, end in runs_of(aligned):
        lonely[first] = end - first == 1
    if lonely.any():
        axes.plot(
            swept[lonely],
            durations[lonely],
            linestyle="none",
            marker=".",
            markersize=4.0,
            color=look["color"],
            label=f"_alone {name}",
        )
    return line


def _mark_sensitive(axes: Axes, swept: Floats, durations: Floats, sensitive: Bools) -> list[Line2D]:
    row, column = np.nonzero(sensitive & ~np.isnan(durations))
    if not row.size:
        return []
    return axes.plot(
        swept[column],
        durations[row, column],
        linestyle="none",
        marker="o",
        markersize=4.5,
        markerfacecolor="none",
        markeredgecolor=style.BLACK,
        markeredgewidth=0.7,
        label=SENSITIVE_LABEL,
    )


def _draw_strip(strip: Axes, swept: Floats, gaps: Bools, failed: Bools) -> list[Line2D]:
    edges = cell_edges(swept)
    for row, mask in enumerate(gaps):
        bars = [
            [(edges[i], row - 0.36), (edges[j], row - 0.36), (edges[j], row + 0.36),
             (edges[i], row + 0.36)]
            for i, j in runs_of(mask)
        ]  # fmt: skip
        colour = style.curve(row, 1)["color"]
        strip.add_collection(
            PolyCollection(bars, facecolor=colour, linewidth=0.0, label=f"_{NOT_ALIGNED} {row}"),
            autolim=False,
        )
    strip.set_ylim(len(gaps) - 0.4, -0.6)
    strip.set_yticks([])
    strip.grid(visible=False)
    strip.spines["left"].set_visible(False)
    strip.set_ylabel("does not\nalign", rotation=0, ha="right", va="center", fontsize=8.0)
    rows, columns = np.nonzero(failed)
    if not rows.size:
        return []
    look: dict[str, Any] = {"color": style.BLACK, "markersize": 3.5, "label": FAILED_LABEL}
    return strip.plot(swept[columns], rows, "x", **look)


# --- Figs. 13, 14: areas of stable alignment ----------------------------------------------------

LEFT_LABEL = "of these, leaves the scene"


def stability_map(dataset: "xr.Dataset") -> Figure:
    """Figs. 13, 14: durations in colour where the part aligns, hatching where it does not.

    A map that says how sure it is (study/maps.py) is drawn with contours of the duration, the
    outline of its reliable area, and where other figures stand.
    """
    y, x = (dataset[name] for name in dataset["tau_align"].dims)
    durations = np.ma.masked_invalid(dataset["tau_align"].values)
    outcome = dataset["outcome"].values
    gaps = np.ma.getmaskarray(durations)
    edges = cell_edges(x.values), cell_edges(y.values)
    with style.context():
        figure = style.new_figure(height=11.0 * style.CENTIMETRE)
        axes = figure.subplots()
        axes.grid(visible=False)
        hatched = _add_area(axes, *edges, gaps, NOT_ALIGNED, **style.NON_ALIGNING)
        handles: list[Patch | Line2D] = [hatched]
        left, failed = outcome == Outcome.LEFT_SCENE, outcome == Outcome.FAILED
        if left.any():
            shade: dict[str, Any] = {"facecolor": style.BLACK, "alpha": 0.16, "linewidth": 0.0}
            handles.append(_add_area(axes, *edges, left, LEFT_LABEL, **shade))
        if failed.any():
            shade = {"facecolor": style.VERMILLION, "linewidth": 0.0}
            handles.append(_add_area(axes, *edges, failed, FAILED_LABEL, **shade))
        if not gaps.all():
            _colour_durations(figure, axes, edges, durations, axis_label(dataset["tau_align"]))
        axes.add_collection(
            LineCollection(
                list(_borders(*edges, gaps)), colors=style.BLACK, linewidths=0.7, label="_border"
            ),
            autolim=False,
        )
        axes.set_xlim(edges[0][0], edges[0][-1])
        axes.set_ylim(edges[1][0], edges[1][-1])
        axes.set_xlabel(axis_label(x))
        axes.set_ylabel(axis_label(y))
        axes.spines[["top", "right"]].set_visible(True)
        if "resolution" in dataset.attrs:
            add_contours(axes, x.values, y.values, durations)
            handles += [*add_reliable(axes, dataset), *add_marks(axes, dataset)]
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=len(handles) if len(handles) < 4 else 2,
            handler_map={PathPatch: HandlerPatch()},
            handleheight=1.4,
        )
        return figure


def limit_map(dataset: "xr.Dataset") -> Figure:
    """The largest misalignment up to which every one aligns, in colour with contours."""
    y, x = (dataset[name] for name in dataset["misalignment_max"].dims)
    values = np.ma.masked_invalid(dataset["misalignment_max"].values)
    with style.context():
        figure = style.new_figure(height=11.0 * style.CENTIMETRE)
        axes = figure.subplots()
        axes.grid(visible=False)
        mesh = axes.pcolormesh(cell_edges(x.values), cell_edges(y.values), values, rasterized=True)
        figure.colorbar(mesh, ax=axes, pad=0.02).set_label("largest misalignment $ε$")
        add_contours(axes, x.values, y.values, values)
        axes.set_xlim(x.values[0], x.values[-1])
        axes.set_ylim(y.values[0], y.values[-1])
        axes.set_xlabel(axis_label(x))
        axes.set_ylabel(axis_label(y))
        axes.spines[["top", "right"]].set_visible(True)
        return figure


def _colour_durations(
    figure: Figure,
    axes: Axes,
    edges: tuple[Floats, Floats],
    durations: np.ma.MaskedArray,
    label: str,
) -> None:
    shortest, longest = float(durations.min()), float(durations.max())
    spread = longest > _SPREAD_FOR_LOG * shortest > 0.0
    # A few runs near the border take very long; the colours are for the others.
    top = float(np.quantile(durations.compressed(), _COLOURED_SHARE)) if spread else longest
    norm = LogNorm(shortest, top) if spread else Normalize(shortest, top)
    # Rasterized: thousands of cells as vectors would make SVG and PDF files of many megabytes.
    mesh = axes.pcolormesh(*edges, durations, norm=norm, rasterized=True)
    bar = figure.colorbar(mesh, ax=axes, pad=0.02, extend="max" if spread else "neither")
    bar.set_label(f"{label}, logarithmic" if spread else label)
    if spread:
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0)))
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        bar.ax.yaxis.set_minor_formatter(NullFormatter())


def _add_area(axes: Axes, x: Floats, y: Floats, cells: Bools, label: str, **look: Any) -> Patch:
    """The union of the True ``cells``, shape (y, x), between the edges x and y, as one patch."""
    corners: list[tuple[float, float]] = []
    codes: list[np.uint8] = []
    for row, mask in enumerate(cells):
        for i, j in runs_of(mask):
            low, high = y[row], y[row + 1]
            corners += [(x[i], low), (x[j], low), (x[j], high), (x[i], high), (x[i], low)]
            codes += [Outline.MOVETO, *[Outline.LINETO] * 3, Outline.CLOSEPOLY]
    outline = Outline(np.array(corners, dtype=float).reshape(-1, 2), codes or None)
    patch = PathPatch(outline, label=label, **look)
    axes.add_patch(patch)
    return patch


def _borders(x: Floats, y: Floats, cells: Bools) -> Iterator[list[tuple[float, float]]]:
    """Straight lines between cells that differ: the staircase that surrounds an area."""
    for column, differ in enumerate((cells[:, 1:] != cells[:, :-1]).T, start=1):
        for i, j in runs_of(differ):
            yield [(x[column], y[i]), (x[column], y[j])]
    for row, differ in enumerate(cells[1:] != cells[:-1], start=1):
        for i, j in runs_of(differ):
            yield [(x[i], y[row]), (x[j], y[row])]


_DRAW = {"history": history, "curves": curves, "map": stability_map, "limit": limit_map}
