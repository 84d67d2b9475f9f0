"""Curves: Figs. 6 to 12 over one parameter.

Where a part does not align there is no duration. The curve has a gap, and a strip below the curves
marks the gap, so that it is not taken for missing data.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from model.events.outcomes import Outcome
from vibralign.plots import style
from vibralign.plots.style import Bools, Floats

SENSITIVE_LABEL = "sensitive: digits uncertain"
_ALONE: Mapping[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 4.0}
_THIN: Mapping[str, Any] = {"markeredgecolor": style.BLACK, "markeredgewidth": 0.7}
_MARK: Mapping[str, Any] = {"color": style.BLACK, "linestyle": "none", "markersize": 3.5}
_RING: Mapping[str, Any] = {**_MARK, "marker": "o", "markersize": 4.5, "markerfacecolor": "none"}
_CROSS: Mapping[str, Any] = {**_MARK, "marker": "x"}
_ARROW: Mapping[str, Any] = {**_MARK, "marker": "$\\uparrow$", "markersize": 7.0, "clip_on": False}
_JUMP = 2.0 * np.pi / 3.0  # a third of a period of the vibration, as a phase
_NEARLY_ALL = 0.92  # of the points: the rest may lie beyond the axis
_EMPTY, _MARGIN, _EDGE = 0.15, 0.05, 0.01  # shares of an axis: see ``_ends_of_axis``


def curves(dataset: xr.Dataset) -> Figure:
    """Draw the duration over the swept parameter, a curve for each value of the family parameter.

    A line ends where the part does not align and where the duration jumps; a single point between
    two ends is a dot. The strip below has a row for each curve: a full bar where the part does not
    align, an open one where it aligns and does not go in.
    """
    family, swept = (dataset[name] for name in dataset["tau_align"].dims)
    durations = dataset["tau_align"].values
    gaps, lost = np.isnan(durations), style.not_inserted(dataset)
    broken, symbol = jumps(dataset), style.symbol_of(family)
    with style.context():
        figure, axes, strip = _curve_axes(len(family), bool((gaps | lost).any()))
        handles = [
            _draw_curve(axes, row, (swept.values, durations[row]), broken[row],
                        f"{symbol} = {value:g}")
            for row, value in enumerate(family.values)
        ]  # fmt: skip
        notes: list[Line2D | Patch] = []
        rows, columns = np.nonzero((dataset["sensitive"].values == 1) & ~gaps)
        if rows.size:
            place = swept.values[columns], durations[rows, columns]
            notes += axes.plot(*place, label=SENSITIVE_LABEL, **_RING, **_THIN)
        if strip is not None:
            failed = dataset["outcome"].values == Outcome.FAILED
            notes += _draw_strip(strip, swept.values, (gaps, lost), failed)
        notes += _set_durations(axes, swept.values, durations)
        axes.set_ylabel(style.axis_label(dataset["tau_align"]))
        low, high, beyond = _ends_of_axis(swept.values, ~gaps.all(axis=0))
        axes.set_xlim(low, high)
        (strip or axes).set_xlabel(style.axis_label(swept) + beyond)
        title, ncols = style.axis_label(family), min(len(handles), 5)
        figure.legend(handles=handles, title=title, loc="outside upper center", ncols=ncols)
        if notes:
            figure.legend(handles=notes, loc="outside lower right", ncols=min(len(notes), 2))
        return figure


def jumps(dataset: xr.Dataset) -> Bools:
    """Return True where the duration jumps between neighbours along the last dimension.

    It jumps where the part falls in one or more strokes of the vibration later, so by about a whole
    number of periods: a jump is a difference of more than a third of a period. In the study's
    figures nearly all differences are far below or above that. The shape is that of ``tau_align``,
    the last dimension shorter by one.
    """
    durations = dataset["tau_align"]
    frequency = dataset["frequency"].broadcast_like(durations).transpose(*durations.dims).values
    return np.abs(np.diff(durations.values)) * frequency[..., 1:] > _JUMP


def _set_durations(axes: Axes, swept: Floats, durations: Floats) -> list[Line2D]:
    """Set the ends of the axis of durations, with arrows to what lies beyond; return notes."""
    bottom, top, longest = _ends_of_durations(durations[~np.isnan(durations)])
    axes.set_ylim(bottom, top)
    if longest <= top:
        return []
    for row, line in enumerate(durations):
        firsts = [first for first, _ in style.runs_of(line > top)]
        if firsts:
            look = {**_ARROW, "color": style.curve(row)["color"], "label": f"_beyond {row}"}
            axes.plot(swept[firsts], [top] * len(firsts), **look)
    return [Line2D([], [], label=f"longer than the axis, up to $τ$ = {longest:.0f}", **_ARROW)]


def _ends_of_axis(swept: Floats, aligned: Bools) -> tuple[float, float, str]:
    """Return the ends of the axis of the swept parameter, and words on what lies beyond them.

    An end where nothing aligns is cut off if it is long. A narrow edge keeps marks whole.
    """
    first, last = style.cell_edges(swept)[[0, -1]]
    low, high = first, last
    if aligned.any():
        least, most = swept[aligned][[0, -1]]
        margin, long = _MARGIN * (most - least), _EMPTY * (last - first)
        low = least - margin if least - first > long else first
        high = most + margin if last - most > long else last
    edge = _EDGE * (high - low)
    cut = (low, high) != (first, last)
    words = f"\n(computed from {swept[0]:g} to {swept[-1]:g})" if cut else ""
    return low - edge, high + edge, words


def _ends_of_durations(durations: Floats) -> tuple[float, float, float]:
    """Return the ends of the axis of durations, and the longest duration.

    The axis reaches the longest duration if nearly all others still fill half of it. Else it
    reaches the longest of those that are not longer than nearly all others by more than a half.
    """
    if not durations.size:
        return 0.0, 1.0, 0.0
    longest, usual = float(durations.max()), float(np.quantile(durations, _NEARLY_ALL))
    shown = durations if longest <= 2.0 * usual else durations[durations <= 1.5 * usual]
    return 0.0, 1.05 * float(shown.max()) or 1.0, longest


def _curve_axes(rows: int, with_strip: bool) -> tuple[Figure, Axes, Axes | None]:
    height, row = 9.5 * style.CENTIMETRE, 0.22 * style.CENTIMETRE
    if not with_strip:
        figure = style.new_figure(height=height)
        return figure, figure.subplots(), None
    figure = style.new_figure(height=height + rows * row)
    figure.set_layout_engine("constrained", h_pad=0.03, hspace=0.0)
    axes, strip = figure.subplots(2, 1, sharex=True, height_ratios=[height - 2.5 * row, rows * row])
    return figure, axes, strip


def _draw_curve(
    axes: Axes, index: int, points: tuple[Floats, Floats], broken: Bools, name: str
) -> Line2D:
    """Draw one curve, which matplotlib breaks at NaN; return its handle for a legend.

    ``broken``, shape (n - 1,), is True between points of the n that no line joins.
    """
    breaks = np.flatnonzero(broken) + 1
    x, y = (np.insert(values, breaks, np.nan) for values in points)
    look = style.curve(index)
    if np.isnan(y).all():
        name += ": none"
        look["markevery"] = None  # matplotlib cannot place marks along no line
    (line,) = axes.plot(x, y, label=name, **look)
    lonely = [first for first, end in style.runs_of(~np.isnan(y)) if end - first == 1]
    if lonely:
        dots = {**_ALONE, "color": look["color"], "label": f"_alone {name}"}
        axes.plot(x[lonely], y[lonely], **dots)
    return line


def _draw_strip(
    strip: Axes, swept: Floats, rows: tuple[Bools, Bools], failed: Bools
) -> list[Line2D | Patch]:
    """Draw a row of bars for each curve: full ones for ``rows[0]``, open ones for ``rows[1]``."""
    edges = style.cell_edges(swept)
    notes: list[Line2D | Patch] = []
    for label, masks, full in zip(
        (style.NOT_ALIGNED, style.NOT_INSERTED), rows, (1, 0), strict=True
    ):
        for row, mask in enumerate(masks):
            low, high = row - 0.36, row + 0.36
            bars = [
                [(edges[i], low), (edges[j], low), (edges[j], high), (edges[i], high)]
                for i, j in style.runs_of(mask)
            ]
            colour = style.curve(row)["color"]
            fill = colour if full else "none"
            look = {"facecolor": fill, "edgecolor": colour, "linewidth": 0.7}
            drawn = PolyCollection(bars, label=f"_{label} {row}", **look)
            strip.add_collection(drawn, autolim=False)
        if masks.any():
            fill = style.GREY if full else "none"
            notes.append(Patch(label=label, facecolor=fill, edgecolor=style.GREY, linewidth=0.7))
    strip.set_ylim(len(failed) - 0.4, -0.6)
    strip.set_yticks([])
    strip.grid(visible=False)
    strip.spines["left"].set_visible(False)
    lines, columns = np.nonzero(failed)
    if lines.size:
        notes += strip.plot(swept[columns], lines, label=style.FAILED_LABEL, **_CROSS)
    return notes
