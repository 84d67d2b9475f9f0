"""Fig. 5: one trajectory over time."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from model.engine.results import TRACK_VARIABLES
from model.events.outcomes import Outcome
from model.physics.quantities import ANGLE, LENGTH
from model.physics.units import Units
from vibralign.plots import style
from vibralign.plots.style import Floats

if TYPE_CHECKING:  # a trajectory is drawn where xarray is not installed
    import xarray as xr

    from model.runs.simulate import Trajectory

# Labels of the panels, by track variable.
_PANELS = {
    "x": "mass centre $x$",
    "y": "mass centre $y$",
    "tilt": "tilt $φ$ (rad)",
    "contact_force": "contact force $n$",
}
_UNITS = {LENGTH: (" (mm)", 1e3), ANGLE: ("", 1.0)}  # where not the quantity's SI unit


def history(dataset: "xr.Dataset") -> Figure:
    """Draw x, y, tilt and contact force over time, with the moment of alignment."""
    tracks = {name: dataset[name].values for name in (*_PANELS, "side_force")}
    outcome, tau_align = Outcome(int(dataset["outcome"])), float(dataset["tau_align"])
    return _draw(dataset["time"].values, tracks, outcome, tau_align)


def trajectory(run: "Trajectory", units: Units | None = None) -> Figure:
    """Draw a run that was not stored, as ``history`` does; in SI units if it has ``units``."""
    if units is None:
        return _draw(run.time, run.track_variables, run.outcome, run.tau_align)
    tracks, suffixes = {}, {}
    for name in (*_PANELS, "side_force"):
        quantity = TRACK_VARIABLES[name].quantity
        suffixes[name], size = _UNITS.get(quantity, (f" ({quantity.unit})", 1.0))
        tracks[name] = run.track_variables[name] * units.of(quantity) * size
    return _draw(run.time * units.time, tracks, run.outcome, run.tau_align * units.time, suffixes)


def _draw(
    time: Floats,
    tracks: Mapping[str, Floats],
    outcome: Outcome,
    tau_align: float,
    suffixes: Mapping[str, str] | None = None,
) -> Figure:
    with style.context():
        figure = style.new_figure(height=15.0 * style.CENTIMETRE)
        panels = figure.subplots(4, 1, sharex=True, height_ratios=[1, 1, 1, 1.35])
        for letter, axes, (name, label) in zip("abcd", panels, _PANELS.items(), strict=True):
            axes.plot(time, tracks[name], color=style.BLUE)
            axes.set_ylabel(label + (suffixes or {}).get(name, ""))
            axes.set_title(letter, loc="left", fontweight="bold", pad=3.0)
            axes.margins(x=0.01)
        figure.align_ylabels(panels)
        panels[-1].set_xlabel("time (s)" if suffixes else "time $τ$")
        _add_side_force(panels[-1], time, tracks["side_force"])
        if np.isfinite(tau_align):
            when = f"{tau_align:.4g} s" if suffixes else f"$τ$ = {tau_align:.4g}"
            _mark_alignment(panels, time, tracks["contact_force"], tau_align, when)
        else:
            ending = outcome.name.lower().replace("_", " ")
            panels[0].set_title(f"does not align ({ending})", loc="right", pad=3.0)
        return figure


def _add_side_force(axes: Axes, time: Floats, side_force: Floats) -> None:
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.3 * (high - low))  # room for the legend
    if np.any(side_force > 0.0):
        axes.plot(time, side_force, color=style.VERMILLION, linestyle="--", label="side")
        axes.legend(axes.lines, ["under the part", "on its side face"], loc="upper left", ncols=2)


def _mark_alignment(
    panels: NDArray[np.object_], time: Floats, force: Floats, tau_align: float, when: str
) -> None:
    for axes in panels:
        axes.axvline(tau_align, color=style.GREY, linewidth=0.8, linestyle=":", label="alignment")
    before = force_before(time, force, tau_align)
    words = f"aligned in flight at {when}" if before == 0.0 else f"$n$ drops to 0 at {when}"
    arrow = {"arrowstyle": "->", "color": style.BLACK, "linewidth": 0.8}
    look: Any = {"ha": "right", "va": "center", "arrowprops": arrow}
    place, above = (tau_align, before), (0.94, 0.9)
    panels[-1].annotate(words, place, above, textcoords="axes fraction", **look)


def force_before(time: Floats, force: Floats, moment: float) -> float:
    """Return the force just before ``moment``; where it jumps, the value before the jump."""
    return float(force[np.searchsorted(time, moment - 1e-9 * (1.0 + moment))])
