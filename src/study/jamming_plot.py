"""Figure of jamming: outcomes of parts that fall in, over tilt at entry, friction and loads."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from model.events.outcomes import Outcome
from study.jamming import depth_of_two_points, entered, in_jamming_diagram, tilt_at_depth
from vibralign.plots import style
from vibralign.plots.style import Floats, axis_label

CAPTION = (
    "Every part that falls into the slot, by its tilt at entry and its friction, a panel for each "
    "clearance. Above the line friction alone can hold a part between edge and wall: wedging, from "
    "the geometry of two-point contact. A part to the right of the dashed line touches two points "
    "before it is deep enough to count as inserted, unless it turns upright on the way. "
    "Below, the same parts by the loads of press and springs at their tip, each over its limit: "
    "outside the square, the parallelogram of the jamming diagram, these loads cannot drive a part "
    "on at two points. Both limits hold for a part at rest at its tilt at entry. Beyond them a "
    "part may still go in: vibration takes the load off its contacts, and it may turn upright."
)
WEDGED, TWO_POINTS = "wedging limit $μ = h/d$", "two-point contact at the depth asked for"
DIAGRAM = "jamming diagram"
_LOOKS: Mapping[Outcome, Mapping[str, Any]] = {
    Outcome.INSERTED: {"color": style.SKY_BLUE, "marker": "o", "label": "inserted"},
    Outcome.JAMMED: {"color": style.VERMILLION, "marker": "X", "label": "jammed"},
    Outcome.CLIMBED_OUT: {"color": style.PURPLE, "marker": "^", "label": "climbed out"},
}
_OTHER: Mapping[str, Any] = {"color": style.BLACK, "marker": "+", "label": "another end"}
_SQUARE = (-1.0, 1.0, 1.0, -1.0, -1.0), (-1.0, -1.0, 1.0, 1.0, -1.0)
_LEAST = 1e-3  # rad, at which the lines begin


def draw_jamming(dataset: xr.Dataset) -> Figure:
    """Draw two panels for each clearance: outcomes as marks, limits in closed form as lines."""
    with style.context():
        figure = style.new_figure(height=15.0 * style.CENTIMETRE)
        clearances, friction = dataset["clearance"].values, dataset["friction"]
        panels, diagrams = figure.subplots(
            2, clearances.size, squeeze=False, sharex="row", sharey="row"
        )
        entries = dataset["tilt_at_alignment"].values[entered(dataset)]
        tilt = np.linspace(_LEAST, 1.08 * float(entries.max()) if entries.size else 0.5, 200)
        depth = dataset["insertion_depth"].values.max() / (2.0 * float(dataset["half_width"]))
        sideways, turning = in_jamming_diagram(dataset)
        for k, clearance in enumerate(clearances):
            parts, above, below = dataset.sel(clearance=clearance), panels[k], diagrams[k]
            above.set_title(f"δ = {clearance:g}", loc="left")
            entry = parts["tilt_at_alignment"].values
            _draw_ends(above, parts, entry, np.broadcast_to(friction.values, entry.shape))
            above.plot(tilt, depth_of_two_points(tilt, clearance), color=style.BLACK, label=WEDGED)
            at = tilt_at_depth(depth, clearance)
            above.axvline(at, color=style.BLACK, linestyle="--", linewidth=0.9, label=TWO_POINTS)
            above.set_xlabel("tilt at entry (rad)")
            _draw_ends(below, parts, sideways[k], turning[k])
            below.plot(*_SQUARE, color=style.BLACK, linewidth=1.4, label=DIAGRAM)
            below.set_xlabel("load across, $μ F_x / F_z$")
        panels[0].set_xlim(0.0, tilt[-1])
        panels[0].set_ylim(0.0, 1.08 * float(friction.max()))
        panels[0].set_ylabel(axis_label(friction))
        diagrams[0].set_ylabel("turning load, $[M / (r F_z) + μ (1 + λ) F_x / F_z] / λ$")
        drawn = {str(line.get_label()): line for axes in figure.axes for line in axes.lines}
        looks = *_LOOKS.values(), _OTHER
        named = *(look["label"] for look in looks), WEDGED, TWO_POINTS, DIAGRAM
        handles = [drawn[label] for label in named if label in drawn]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        return figure


def _draw_ends(axes: Axes, parts: xr.Dataset, x: Floats, y: Floats) -> None:
    """Mark the outcome of every part that falls in."""
    outcome, others = parts["outcome"].values, entered(parts)
    for end, look in (*_LOOKS.items(), (None, _OTHER)):
        chosen = others & (outcome == end) if end is not None else others
        others = others & ~chosen
        if chosen.any():
            axes.plot(x[chosen], y[chosen], linestyle="none", markersize=3.5, **look)
