"""Draw figures of the study on bases of other stiffness and damping."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from model.show import style
from model.show.axes import axis_label, cell_edges
from model.show.words import math
from model.study.contact_stiffness import RATIO

if TYPE_CHECKING:
    import xarray as xr


_TITLES = ("stiffness of the base, damping ratio kept", "stiffness, and damping over critical $ζ$")


def draw_bases(datasets: Mapping[str, "xr.Dataset"]) -> Figure:
    """Draw a row for each figure: the stiffness varies on the left, the damping on the right."""
    with style.context():
        figure = style.new_figure(height=(3.0 + 6.3 * len(datasets)) * style.CENTIMETRE)
        panels = figure.subplots(len(datasets), 2, squeeze=False, sharey="row")
        for row, (name, dataset) in zip(panels, datasets.items(), strict=True):
            chosen = _by_stiffness(dataset), _by_damping(dataset)
            for axes, places in zip(row, chosen, strict=True):
                _draw(axes, dataset, places)
            row[0].set_title(f"Fig. {int(name[3:])}{_member(dataset)}", loc="left")
            row[1].tick_params(labelleft=True)
        for places, corner, title in zip(chosen, ("left", "right"), _TITLES, strict=True):
            figure.legend(
                handles=[_handle(dataset, place, corner == "right") for place in places],
                loc=cast("Any", f"outside lower {corner}"),
                title=title,
                ncols=2,
            )
        return figure


def _by_stiffness(dataset: "xr.Dataset") -> list[int]:
    """Indices of the bases with the device's damping ratio, softest first."""
    stiffness, ratio = dataset["contact_stiffness"].values, dataset[RATIO].values
    places = np.flatnonzero(ratio == ratio[0])
    return [int(i) for i in places[np.argsort(stiffness[places], kind="stable")]]


def _by_damping(dataset: "xr.Dataset") -> list[int]:
    """Indices of the bases whose stiffness is tried with several dampings."""
    stiffness, ratio = dataset["contact_stiffness"].values, dataset[RATIO].values
    tried = np.unique(stiffness[ratio != ratio[0]])
    places = np.flatnonzero(np.isin(stiffness, tried))
    return [int(i) for i in places[np.lexsort((ratio[places], stiffness[places]))]]


def _middle(dataset: "xr.Dataset") -> int:
    return (dataset["tau_align"].shape[1] - 1) // 2


def _member(dataset: "xr.Dataset") -> str:
    """Label of the curve of the family that is drawn, or of the border of a map."""
    if dataset.attrs["kind"] == "map":
        return ", border of the aligning area"
    family = dataset[str(dataset["tau_align"].dims[1])]
    symbol = math(str(family.attrs.get("symbol", family.name)))
    return f", {symbol} = {family.values[_middle(dataset)]:g}"


def _draw(axes: Axes, dataset: "xr.Dataset", places: Sequence[int]) -> None:
    _, first, second = (str(name) for name in dataset["tau_align"].dims)
    x = dataset[second].values
    for place in places:
        look = _look(dataset, place, x.size)
        if dataset.attrs["kind"] == "map":
            aligned = (dataset["outcome"].values[place] == 0).astype(float)
            axes.contour(
                x, dataset[first].values, aligned, [0.5], colors=[look["color"]],
                linestyles=[look["linestyle"]],
            )  # fmt: skip
        else:
            axes.plot(x, dataset["tau_align"].values[place, _middle(dataset)], **look)
    edges = cell_edges(x)
    axes.set_xlim(edges[0], edges[-1])
    axes.set_xlabel(axis_label(dataset[second]))
    is_map = dataset.attrs["kind"] == "map"
    axes.set_ylabel(axis_label(dataset[first]) if is_map else "alignment duration $τ$")
    if not is_map:
        axes.set_ylim(bottom=0.0)


def _look(dataset: "xr.Dataset", place: int, points: int) -> dict[str, Any]:
    """Style by the stiffness if the damping ratio is the device's, else by the damping ratio."""
    stiffness, ratio = dataset["contact_stiffness"].values, dataset[RATIO].values
    if ratio[place] == ratio[0]:
        levels = np.unique(stiffness)
        look = style.curve(int(np.searchsorted(levels, stiffness[place])), points, markers=6)
        return {**look, "markersize": 3.0}
    levels = np.unique(ratio[ratio != ratio[0]])
    look = style.curve(int(np.searchsorted(levels, ratio[place])), points, markers=6)
    line = ":" if stiffness[place] == stiffness[0] else (0, (3, 1, 1, 1))
    return {**look, "linestyle": line, "marker": "x", "markersize": 3.0}


def _handle(dataset: "xr.Dataset", place: int, with_ratio: bool) -> Line2D:
    stiffness, ratio = (float(dataset[each].values[place]) for each in ("contact_stiffness", RATIO))
    shown = f"{stiffness:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
    words = f"$k_a$ = {shown}" + (f", $ζ$ = {ratio:.2g}" if with_ratio else "")
    look = _look(dataset, place, 1)
    look.pop("markevery")
    return Line2D([], [], label=words, **look)
