"""Fig. 5: one trajectory over time."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from model.engines.results import TRACK_VARIABLES
from model.events.outcomes import Outcome
from model.physics.quantities import ANGLE, LENGTH
from model.physics.units import Units
from model.show import style
from model.show.axes import Floats

if TYPE_CHECKING:  # a trajectory is drawn where xarray is not installed
    import xarray as xr

    from model.runs.simulate import Trajectory

# Of each panel: the variable of the course, the name of its curve, and the label of its axis.
_PANELS = {
    "x": ("x", "mass centre $x$"),
    "y": ("y", "mass centre $y$"),
    "tilt": ("φ", "tilt $φ$ (rad)"),
    "contact_force": ("n", "contact force $n$"),
}


def history(dataset: "xr.Dataset") -> Figure:
    """Draw x, y, tilt and contact force over time, with the moment of alignment."""
    course = {name: dataset[name].values for name in (*_PANELS, "side_force")}
    outcome, tau_align = Outcome(int(dataset["outcome"])), float(dataset["tau_align"])
    return _draw(dataset["time"].values, course, outcome, tau_align)


def trajectory(run: "Trajectory", units: Units | None = None) -> Figure:
    """Draw the figure of ``history`` for a run that was not stored; in SI units with ``units``."""
    if units is None:
        return _draw(run.time, run.track_variables, run.outcome, run.tau_align)
    scales = {name: units.of(TRACK_VARIABLES[name].quantity) for name in run.track_variables}
    lengths = {name: 1e3 for name in scales if TRACK_VARIABLES[name].quantity is LENGTH}
    course = {
        n: values * scales[n] * lengths.get(n, 1.0) for n, values in run.track_variables.items()
    }
    suffixes = {
        name: "" if each is ANGLE else " (mm)" if each is LENGTH else f" ({each.unit})"
        for name, each in ((name, TRACK_VARIABLES[name].quantity) for name in _PANELS)
    }
    time, align = run.time * units.time, run.tau_align * units.time
    return _draw(time, course, run.outcome, align, suffixes)


def _draw(
    time: Floats,
    course: Mapping[str, Floats],
    outcome: Outcome,
    tau_align: float,
    suffixes: Mapping[str, str] | None = None,
) -> Figure:
    with style.context():
        figure = style.new_figure(height=15.0 * style.CENTIMETRE)
        panels = figure.subplots(4, 1, sharex=True, height_ratios=[1, 1, 1, 1.35])
        for letter, axes, (name, (curve, label)) in zip(
            "abcd", panels, _PANELS.items(), strict=True
        ):
            axes.plot(time, course[name], color=style.BLUE, label=curve)
            axes.set_ylabel(label + (suffixes or {}).get(name, ""))
            axes.set_title(letter, loc="left", fontweight="bold", pad=3.0)
            axes.margins(x=0.01)
        figure.align_ylabels(panels)
        panels[-1].set_xlabel("time (s)" if suffixes else "time $τ$")
        _add_side_force(panels[-1], time, course["side_force"])
        if np.isfinite(tau_align):
            when = f"{tau_align:.4g} s" if suffixes else f"$τ$ = {tau_align:.4g}"
            _mark_alignment(panels, time, course["contact_force"], tau_align, when)
        else:
            ending = outcome.name.lower().replace("_", " ")
            panels[0].set_title(f"does not align ({ending})", loc="right", pad=3.0)
        return figure


def _add_side_force(axes: Axes, time: Floats, side_force: Floats) -> None:
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.3 * (high - low))  # headroom for the words
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
    panels[-1].annotate(
        words,
        xy=(tau_align, before),
        xytext=(0.94, 0.9),
        textcoords="axes fraction",
        ha="right",
        va="center",
        arrowprops={"arrowstyle": "->", "color": style.BLACK, "linewidth": 0.8},
    )


def force_before(time: Floats, force: Floats, moment: float) -> float:
    """Return the force just before ``moment``; where it jumps, the value before the jump."""
    return float(force[max(int(np.searchsorted(time, moment - 1e-9 * (1.0 + moment))), 0)])
