"""Figs. 6 to 12: alignment duration over one parameter.

Where a part does not align, a duration does not exist: no line crosses such a gap, and a strip
below the curves says that nothing is missing there.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from model.events.outcomes import Outcome
from model.show import style
from model.show.axes import (
    FAILED_LABEL,
    NOT_ALIGNED,
    NOT_INSERTED,
    Bools,
    Floats,
    axis_label,
    cell_edges,
    not_inserted,
    runs_of,
    symbol_of,
)

if TYPE_CHECKING:
    import xarray as xr

SENSITIVE_LABEL = "sensitive: digits uncertain"


def curves(dataset: "xr.Dataset") -> Figure:
    """Draw the duration over the swept parameter, a curve for each value of the family's.

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
        marked = {
            SENSITIVE_LABEL: dataset["sensitive"].values == 1,
            NOT_INSERTED: not_inserted(dataset),
        }
        notes = []
        for label, points in marked.items():
            notes += _mark(axes, swept.values, durations, points, label)
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
    """Draw one curve, which matplotlib breaks at NaN; return its handle for a legend."""
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


_MARKS: dict[str, dict[str, Any]] = {
    SENSITIVE_LABEL: {"marker": "o", "markersize": 4.5, "markerfacecolor": "none"},
    NOT_INSERTED: {"marker": "x", "markersize": 3.5},
}


def _mark(axes: Axes, swept: Floats, durations: Floats, points: Bools, label: str) -> list[Line2D]:
    row, column = np.nonzero(points & ~np.isnan(durations))
    if not row.size:
        return []
    look: dict[str, Any] = {
        "linestyle": "none",
        "markeredgecolor": style.BLACK,
        "markeredgewidth": 0.7,
    }
    x, y = swept[column], durations[row, column]
    return axes.plot(x, y, label=label, **look, **_MARKS[label])


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
