"""The picture of the runs made for the claims alone."""

from collections.abc import Mapping
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from model.show import style
from model.show.axes import axis_label, cell_edges
from model.show.words import math

if TYPE_CHECKING:
    import xarray as xr

# The quantity that claims read of a run, where that is not the duration.
_SHOWN: Mapping[str, tuple[str, str]] = {
    "centred": ("excursion", "largest displacement in $x$"),
    "pressed": ("tilt_end", "tilt at the end (rad)"),
    "displaced": ("way", "share of the distance to the slot"),
}
_CROSS: Mapping[str, Any] = {
    "color": style.BLACK, "linestyle": "none", "marker": "x", "markersize": 3.5,
}  # fmt: skip
_LOWEST = -1.5  # a part that turns over goes back many times the way to the slot
_DURATION = ("tau_align", "alignment duration $τ$")


def draw_runs(datasets: Mapping[str, "xr.Dataset"]) -> Figure:
    """Draw a panel for each run, in the order given."""
    rows = -(-len(datasets) // 2)
    with style.context():
        figure = style.new_figure(height=7.2 * rows * style.CENTIMETRE)
        panels = figure.subplots(rows, 2, squeeze=False)
        for place, (name, dataset) in enumerate(datasets.items()):
            axes = panels.flat[place]
            title = str(dataset.attrs["title"])
            axes.set_title(f"$\\bf{{{ascii_lowercase[place]}}}$  {title}", loc="left")
            _draw_run(axes, dataset, *_SHOWN.get(name, _DURATION))
        for axes in panels.flat[len(datasets) :]:
            axes.set_visible(False)
        return figure


def _draw_run(axes: Axes, dataset: "xr.Dataset", variable: str, label: str) -> None:
    family, swept = (dataset[str(name)] for name in dataset["tau_align"].dims)
    symbol = math(str(family.attrs.get("symbol", family.name)))
    for row, value in enumerate(family.values):
        values = dataset[variable].values[row]
        look = style.curve(row, values.size, markers=5)
        axes.plot(swept.values, values, label=f"{symbol} = {value:g}", **look)
        aligned = np.isfinite(dataset["tau_align"].values[row])
        if variable != _DURATION[0] and aligned.any():
            axes.plot(swept.values[aligned], values[aligned], **_CROSS)
    edges = cell_edges(swept.values)
    axes.set_xlim(edges[0], edges[-1])
    low = axes.get_ylim()[0]
    axes.set_ylim(bottom=max(_LOWEST, min(0.0, low)))
    axes.set_xlabel(axis_label(swept))
    axes.set_ylabel(label)
    axes.legend(loc="best")
