"""Drawings of datasets: Figs. 5 to 14 and the maps by their ``kind``, and further ones by name."""

from collections.abc import Callable, Mapping

import xarray as xr
from matplotlib.figure import Figure

from study.jamming_plot import draw_jamming
from vibralign.plots.curves import curves
from vibralign.plots.history import history
from vibralign.plots.maps import stability_map, vibration_map

_DRAW: Mapping[str, Callable[..., Figure]] = {
    "history": history, "curves": curves, "map": stability_map,
}  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the figure of a dataset of the study, by its attribute ``kind``."""
    kind = str(dataset.attrs.get("kind"))
    if kind not in _DRAW:
        raise ValueError(f"kind = {kind!r}: must be one of {', '.join(_DRAW)}")
    return _DRAW[kind](dataset)


DRAWINGS: Mapping[str, Callable[..., Figure]] = {
    "figure": draw, "vibration": vibration_map, "jamming": draw_jamming,
}  # fmt: skip
