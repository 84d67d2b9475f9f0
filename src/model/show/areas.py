"""Figs. 13 and 14: areas of stable alignment."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerPatch
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Outline
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

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
)
from model.show.overlays import (
    add_contours,
    add_marks,
    add_outline,
    add_reliable,
    add_vibration,
)
from model.study.vibration import added, success_of

if TYPE_CHECKING:
    import xarray as xr

_SPREAD_FOR_LOG = 8.0  # longest over shortest duration beyond which colours are logarithmic
_COLOURED_SHARE = 0.99  # share of the durations that the colour scale covers

LEFT_LABEL, NOT_IN = "of these, leaves the scene", "does not go in"
PATCH_LABEL = "outcomes alternate: no border"
SLOW_LABEL = "ticked side: rests if pressed slowly"
# In the order of ``vibration.added``.
ADDED_LABELS = (
    "aligns, vibrated or not",
    "aligns only if vibrated",
    "aligns only if not vibrated",
    "does not align, vibrated or not",
)
_ADDED: tuple[Mapping[str, Any], ...] = (
    {"facecolor": style.SKY_BLUE, "edgecolor": style.BLUE, "hatch": "...", "linewidth": 0.0},
    {"facecolor": style.GREEN, "linewidth": 0.0},
    {"facecolor": style.ORANGE, "edgecolor": style.BLACK, "hatch": "\\\\\\\\", "linewidth": 0.0},
    style.NON_ALIGNING,
)


def stability_map(dataset: "xr.Dataset", coarse: "xr.Dataset | None" = None) -> Figure:
    """Draw durations in colour where the part aligns, hatching where it does not.

    Where it aligns and does not go in, by ``insertion`` in the dataset or in ``coarse``, the same
    plane on a coarser grid, there are dots.

    A refined map (study/maps/) is drawn with contours of the duration, the outline of its
    reliable area, and the operating points of other figures.
    """
    y, x = (dataset[name] for name in dataset["tau_align"].dims)
    durations = np.ma.masked_invalid(dataset["tau_align"].values)
    outcome, label = dataset["outcome"].values, NOT_ALIGNED
    if success_of(dataset) is Outcome.INSERTED:
        durations = np.ma.masked_where(outcome != Outcome.INSERTED, durations)
        label = NOT_IN
    gaps = np.ma.getmaskarray(durations)
    edges = cell_edges(x.values), cell_edges(y.values)
    with style.context():
        figure = style.new_figure(height=11.0 * style.CENTIMETRE)
        axes = figure.subplots()
        axes.grid(visible=False)
        hatched = _add_area(axes, *edges, gaps, label, **style.NON_ALIGNING)
        handles: list[Patch | Line2D] = [hatched]
        left = np.isin(outcome, (Outcome.LEFT_SCENE, Outcome.CLIMBED_OUT))
        failed = outcome == Outcome.FAILED
        if left.any():
            shade: dict[str, Any] = {"facecolor": style.BLACK, "alpha": 0.16, "linewidth": 0.0}
            handles.append(_add_area(axes, *edges, left, LEFT_LABEL, **shade))
        if failed.any():
            shade = {"facecolor": style.VERMILLION, "linewidth": 0.0}
            handles.append(_add_area(axes, *edges, failed, FAILED_LABEL, **shade))
        followed = dataset if coarse is None else coarse
        lost = not_inserted(followed)
        if lost.any():
            cells = (
                cell_edges(followed[str(x.name)].values),
                cell_edges(followed[str(y.name)].values),
            )
            _add_area(axes, *cells, lost, NOT_INSERTED, **style.NOT_INSERTED)
            # White dots need a colour behind them in the legend, too.
            seen = {**style.NOT_INSERTED, "facecolor": style.BLUE}
            handles.append(Patch(label=NOT_INSERTED, **seen))
        if not gaps.all():
            _colour_durations(figure, axes, edges, durations, axis_label(dataset["tau_align"]))
        patch = np.zeros(gaps.shape, dtype=np.bool_)
        if "patch" in dataset and dataset["patch"].values.any():
            patch = dataset["patch"].values == 1
            handles.append(_add_area(axes, *edges, patch, PATCH_LABEL, **style.PATCH))
        axes.add_collection(
            LineCollection(
                list(_borders(*edges, gaps, patch)),
                colors=style.BLACK,
                linewidths=0.7,
                label="_border",
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
            handles += [*add_reliable(axes, dataset), *add_vibration(axes, dataset)]
            handles += add_marks(axes, dataset)
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=len(handles) if len(handles) < 4 else 2,
            handler_map={PathPatch: HandlerPatch()},
            handleheight=1.4,
        )
        return figure


def vibration_map(dataset: "xr.Dataset") -> Figure:
    """Draw where the part aligns only if vibrated, only if not, in both ways, and in neither.

    A line, ticked inwards, holds the parts that rest on the edge if they are pressed slowly.
    """
    y, x = (dataset[name] for name in dataset["outcome"].dims)
    edges, found = (cell_edges(x.values), cell_edges(y.values)), added(dataset)
    with style.context():
        figure = style.new_figure(height=11.0 * style.CENTIMETRE)
        axes = figure.subplots()
        axes.grid(visible=False)
        handles: list[Patch | Line2D] = [
            _add_area(axes, *edges, found == kind, label, **look)
            for kind, (label, look) in enumerate(zip(ADDED_LABELS, _ADDED, strict=True))
        ]
        rests = np.isfinite(dataset["slow_tilt"].values)
        handles += add_outline(axes, dataset, rests, SLOW_LABEL, style.BLACK, "-")
        axes.set_xlim(edges[0][0], edges[0][-1])
        axes.set_ylim(edges[1][0], edges[1][-1])
        axes.set_xlabel(axis_label(x))
        axes.set_ylabel(axis_label(y))
        axes.spines[["top", "right"]].set_visible(True)
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=2,
            handler_map={PathPatch: HandlerPatch()},
            handleheight=1.4,
        )
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
    """Draw the union of the True ``cells``, shape (y, x), between the edges x and y, as a patch."""
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


def _borders(
    x: Floats, y: Floats, cells: Bools, without: Bools
) -> Iterator[list[tuple[float, float]]]:
    """Yield the straight lines between cells that differ, except beside those ``without`` lines."""
    beside = (cells[:, 1:] != cells[:, :-1]) & ~(without[:, 1:] | without[:, :-1])
    above = (cells[1:] != cells[:-1]) & ~(without[1:] | without[:-1])
    for column, differ in enumerate(beside.T, start=1):
        for i, j in runs_of(differ):
            yield [(x[column], y[i]), (x[column], y[j])]
    for row, differ in enumerate(above, start=1):
        for i, j in runs_of(differ):
            yield [(x[i], y[row]), (x[j], y[row])]
