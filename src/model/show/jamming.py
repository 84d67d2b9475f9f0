"""Picture of jamming: how parts end that fall into the slot, over tilt at entry and friction."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from model.events.outcomes import Outcome
from model.show import style
from model.show.axes import axis_label
from model.study.jamming import depth_of_two_points, entered, tilt_at_depth

if TYPE_CHECKING:
    import xarray as xr

CAPTION = (
    "Every part that falls into the slot, by its tilt at entry and its friction, a panel for each "
    "clearance. Above the line friction alone can hold a part between edge and wall: wedging, from "
    "the geometry of two-point contact. A part to the right of the dashed line touches two points "
    "before it is deep enough to count as inserted, unless it turns upright on the way."
)
WEDGED, TWO_POINTS = "wedging limit $μ = h/d$", "two-point contact at the depth asked for"
_LOOKS: Mapping[Outcome, Mapping[str, Any]] = {
    Outcome.INSERTED: {"color": style.SKY_BLUE, "marker": "o", "label": "inserted"},
    Outcome.JAMMED: {"color": style.VERMILLION, "marker": "X", "label": "jammed"},
    Outcome.CLIMBED_OUT: {"color": style.PURPLE, "marker": "^", "label": "climbed out"},
}
_OTHER: Mapping[str, Any] = {"color": style.GREY, "marker": "+", "label": "another end"}
_LEAST = 1e-3  # rad, where the lines begin


def draw_jamming(dataset: "xr.Dataset") -> Figure:
    """Draw a panel for each clearance: outcomes as marks, closed forms as lines."""
    with style.context():
        figure = style.new_figure(height=9.0 * style.CENTIMETRE)
        clearances = dataset["clearance"].values
        panels = figure.subplots(1, clearances.size, squeeze=False, sharex=True, sharey=True)[0]
        for axes, clearance in zip(panels, clearances, strict=True):
            axes.set_title(f"δ = {clearance:g}", loc="left")
            _draw_ends(axes, dataset.sel(clearance=clearance))
        tilt = np.linspace(_LEAST, _widest(dataset), 200)
        depth = dataset["insertion_depth"].values.max() / (2.0 * float(dataset["half_width"]))
        for axes, clearance in zip(panels, clearances, strict=True):
            limit = depth_of_two_points(tilt, clearance)
            axes.plot(tilt, limit, color=style.BLACK, label=WEDGED)
            at = tilt_at_depth(depth, clearance)
            axes.axvline(at, color=style.BLACK, linestyle="--", linewidth=0.9, label=TWO_POINTS)
            axes.set_xlabel("tilt at entry (rad)")
        friction = dataset["friction"]
        panels[0].set_xlim(0.0, tilt[-1])
        panels[0].set_ylim(0.0, 1.08 * float(friction.max()))
        panels[0].set_ylabel(axis_label(friction))
        found = {str(each.get_label()): each for axes in panels for each in axes.lines}
        named = (*(look["label"] for look in (*_LOOKS.values(), _OTHER)), WEDGED, TWO_POINTS)
        handles = [found[label] for label in named if label in found]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        return figure


def _draw_ends(axes: Axes, part: "xr.Dataset") -> None:
    tilt, outcome = part["tilt_at_alignment"].values, part["outcome"].values
    friction = np.broadcast_to(part["friction"].values, tilt.shape)
    rest = entered(part)
    for end, look in (*_LOOKS.items(), (None, _OTHER)):
        chosen = rest & (outcome == end) if end is not None else rest
        rest = rest & ~chosen
        if chosen.any():
            axes.plot(tilt[chosen], friction[chosen], linestyle="none", markersize=3.5, **look)


def _widest(dataset: "xr.Dataset") -> float:
    tilt = dataset["tilt_at_alignment"].values[entered(dataset)]
    return 1.08 * float(tilt.max()) if tilt.size else 0.5
