"""Curves: Figs. 6 to 12 over one parameter, the runs of the claims, and the front of a design.

Where a part does not align there is no duration. The curve has a gap, and a strip below the curves
marks the gap, so that it is not taken for missing data.
"""

from collections.abc import Mapping
from string import ascii_lowercase
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from model.events.outcomes import Outcome
from model.show import style
from model.show.style import Bools, Floats

SENSITIVE_LABEL = "sensitive: digits uncertain"
_ALONE: Mapping[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 4.0}
_THIN: Mapping[str, Any] = {"markeredgecolor": style.BLACK, "markeredgewidth": 0.7}
_MARK: Mapping[str, Any] = {"color": style.BLACK, "linestyle": "none", "markersize": 3.5}
_RING: Mapping[str, Any] = {**_MARK, "marker": "o", "markersize": 4.5, "markerfacecolor": "none"}
_CROSS: Mapping[str, Any] = {**_MARK, "marker": "x"}
_ARROW: Mapping[str, Any] = {**_MARK, "marker": "^"}
_NEARLY_ALL = 0.98  # of the points: the rest may lie beyond the axis
_DURATION = ("tau_align", "alignment duration $τ$")
# Variable and label of the claims' own runs that are not judged by the duration.
_CLAIMED: Mapping[str, tuple[str, str]] = {
    "centred": ("excursion", "largest displacement in $x$"),
    "pressed": ("tilt_end", "tilt at the end (rad)"),
    "displaced": ("way", "share of the distance to the slot"),
}
_LOWEST = -1.5  # end of an axis: a part that turns over moves far away from the slot


def curves(dataset: xr.Dataset) -> Figure:
    """Draw the duration over the swept parameter, a curve for each value of the family parameter.

    Where the part does not align, the curve has a gap, and the strip below has a bar in the row of
    this curve. A single aligned point between two gaps is a dot.
    """
    family, swept = (dataset[name] for name in dataset["tau_align"].dims)
    durations = dataset["tau_align"].values
    gaps = np.isnan(durations)
    with style.context():
        figure, axes, strip = _curve_axes(len(family), bool(gaps.any()))
        symbol = style.symbol_of(family)
        handles = [
            _draw_curve(axes, row, swept.values, durations[row], f"{symbol} = {value:g}")
            for row, value in enumerate(family.values)
        ]
        notes = []
        for label, look, marked in (
            (SENSITIVE_LABEL, {**_RING, **_THIN}, dataset["sensitive"].values == 1),
            (style.NOT_INSERTED, {**_CROSS, **_THIN}, style.not_inserted(dataset)),
        ):
            rows, columns = np.nonzero(marked & ~gaps)
            if rows.size:
                x, y = swept.values[columns], durations[rows, columns]
                notes += axes.plot(x, y, label=label, **look)
        if strip is not None:
            failed = dataset["outcome"].values == Outcome.FAILED
            notes += _draw_strip(strip, swept.values, gaps, failed)
        axes.set_xlim(*style.cell_edges(swept.values)[[0, -1]])
        top, longest = _end_of_axis(durations[~gaps])
        axes.set_ylim(0.0, top)
        if longest > top:
            label = f"longer than the axis, up to $τ$ = {longest:.0f}"
            notes += axes.plot([], [], label=label, **_ARROW)
        axes.set_ylabel(style.axis_label(dataset["tau_align"]))
        (strip or axes).set_xlabel(style.axis_label(swept))
        title, ncols = style.axis_label(family), min(len(handles), 5)
        figure.legend(handles=handles, title=title, loc="outside upper center", ncols=ncols)
        if notes:
            figure.legend(handles=notes, loc="outside lower right", ncols=len(notes))
        return figure


def _end_of_axis(durations: Floats) -> tuple[float, float]:
    """Return where the axis of durations ends, and the longest duration.

    A few durations far longer than all others lie beyond the axis: they would flatten the curves.
    """
    if not durations.size:
        return 1.0, 0.0
    longest, usual = float(durations.max()), float(np.quantile(durations, _NEARLY_ALL))
    return (1.05 * longest if longest < 3.0 * usual else 1.5 * usual), longest


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
    """Draw one curve, which matplotlib breaks at NaN; return its handle for a legend."""
    look = style.curve(index, len(swept))
    (line,) = axes.plot(swept, durations, label=name, **look)
    lonely = [first for first, end in style.runs_of(~np.isnan(durations)) if end - first == 1]
    if lonely:
        dots = {**_ALONE, "color": look["color"], "label": f"_alone {name}"}
        axes.plot(swept[lonely], durations[lonely], **dots)
    return line


def _draw_strip(strip: Axes, swept: Floats, gaps: Bools, failed: Bools) -> list[Line2D]:
    edges = style.cell_edges(swept)
    for row, mask in enumerate(gaps):
        low, high = row - 0.36, row + 0.36
        bars = [
            [(edges[i], low), (edges[j], low), (edges[j], high), (edges[i], high)]
            for i, j in style.runs_of(mask)
        ]
        colour, label = style.curve(row, 1)["color"], f"_{style.NOT_ALIGNED} {row}"
        drawn = PolyCollection(bars, facecolor=colour, linewidth=0.0, label=label)
        strip.add_collection(drawn, autolim=False)
    strip.set_ylim(len(gaps) - 0.4, -0.6)
    strip.set_yticks([])
    strip.grid(visible=False)
    strip.spines["left"].set_visible(False)
    strip.set_ylabel("does not\nalign", rotation=0, ha="right", va="center", fontsize=8.0)
    rows, columns = np.nonzero(failed)
    if not rows.size:
        return []
    return strip.plot(swept[columns], rows, label=style.FAILED_LABEL, **_CROSS)


def draw_runs(*datasets: xr.Dataset) -> Figure:
    """Draw the runs made for the claims alone, a panel for each dataset in the order given."""
    rows = -(-len(datasets) // 2)
    with style.context():
        figure = style.new_figure(height=7.2 * rows * style.CENTIMETRE)
        panels = figure.subplots(rows, 2, squeeze=False).flat
        for letter, axes, dataset in zip(ascii_lowercase, panels, datasets, strict=False):
            title = str(dataset.attrs["title"])
            axes.set_title(f"$\\bf{{{letter}}}$  {title}", loc="left")
            _draw_run(axes, dataset, *_CLAIMED.get(dataset.attrs["figure"], _DURATION))
        for axes in [*figure.axes][len(datasets) :]:
            axes.set_visible(False)
        return figure


def _draw_run(axes: Axes, dataset: xr.Dataset, variable: str, label: str) -> None:
    family, swept = (dataset[str(name)] for name in dataset["tau_align"].dims)
    for row, value in enumerate(family.values):
        values = dataset[variable].values[row]
        look = style.curve(row, values.size, markers=5)
        axes.plot(swept.values, values, label=f"{style.symbol_of(family)} = {value:g}", **look)
        aligned = np.isfinite(dataset["tau_align"].values[row])
        if variable != _DURATION[0] and aligned.any():
            axes.plot(swept.values[aligned], values[aligned], **_CROSS)
    axes.set_xlim(*style.cell_edges(swept.values)[[0, -1]])
    axes.set_ylim(bottom=max(_LOWEST, min(0.0, axes.get_ylim()[0])))
    axes.set_xlabel(style.axis_label(swept))
    axes.set_ylabel(label)
    axes.legend(loc="best")


def draw_front(dataset: xr.Dataset) -> Figure:
    """Draw margin over alignment time for all settings of a design with which every device goes in.

    A line joins the Pareto front; a star is the recommended setting.
    """
    time, margin = 1e3 * dataset["time"].values, dataset["margin"].values
    all_in = dataset["share"].values == 1.0
    front = np.flatnonzero(dataset["front"].values)
    front = front[np.argsort(time[front])]
    best = int(dataset.attrs["recommended"])
    with style.context():
        figure = style.new_figure(height=9.0 * style.CENTIMETRE)
        axes = figure.subplots()
        for chosen, mark, look in (
            (all_in, "o", {"color": style.SKY_BLUE, "markersize": 3, "label": "tried"}),
            (front, "-s", {"color": style.VERMILLION, "label": "front, within the limits",
                           "drawstyle": "steps-post"}),
            ([best], "*", {"color": style.BLACK, "markersize": 12, "label": "chosen"}),
        ):  # fmt: skip
            axes.plot(time[chosen], margin[chosen], mark, **look)
        axes.set_xlabel("longest alignment time within the tolerances (ms)")
        axes.set_ylabel("nearest failure (tolerances)")
        axes.set_ylim(bottom=0.0, top=3.2)
        axes.legend(loc="lower right")
        return figure
