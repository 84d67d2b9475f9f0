"""Pictures of speed against error."""

import math
from collections.abc import Collection, Mapping, Sequence
from string import ascii_lowercase
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from verification.bench.methods import METHODS
from verification.bench.problems import Verdict
from verification.bench.work_precision import Setting
from vibralign.plots import style

# Thick: with event location; orange and purple: fixed steps; the others: scipy.
LOOKS: Mapping[str, Mapping[str, Any]] = {
    "taylor_located": {"color": style.BLUE, "marker": "o", "linestyle": "-", "linewidth": 2.2},
    "rk4_fixed": {"color": style.ORANGE, "marker": "^", "linestyle": "-"},
    "semi_implicit_euler_fixed": {"color": style.PURPLE, "marker": "v", "linestyle": "-"},
    "scipy_rk45": {"color": style.SKY_BLUE, "marker": "P", "linestyle": ":"},
    "scipy_dop853": {"color": style.GREEN, "marker": "X", "linestyle": ":"},
    "scipy_lsoda": {"color": style.GREY, "marker": "<", "linestyle": ":"},
    "scipy_radau": {"color": style.BLACK, "marker": "*", "linestyle": ":"},
}


CAPTIONS: Mapping[str, str] = {
    "evaluations": "Evaluations of the equations of motion over the true error. A method that does "
    "not locate events needs ever more of them for each digit as soon as the part sticks or "
    "lifts off. Shaded: below what the true solution itself is known to.",
    "times": "CPU time of one trajectory over the true error, as measured in this build on this "
    "machine: neighbouring parameter sets on one core, median of repeats. "
    "Scipy's methods (dotted) take steps in Python, with a compiled right-hand side. Shaded: below "
    "what the true solution itself is known to.",
}


def evaluations_over_error(settings: Sequence[Setting], titles: Mapping[str, str]) -> Figure:
    """Draw right-hand-side evaluations over true error, a panel for each case."""
    return _work_over_error(
        settings, "rhs_evaluations", titles, "evaluations of the equations of motion"
    )


def time_over_error(settings: Sequence[Setting], titles: Mapping[str, str]) -> Figure:
    """Draw the CPU time of a trajectory over true error, a panel for each case."""
    return _work_over_error(settings, "microseconds", titles, "CPU time of a trajectory (µs)")


def _work_over_error(
    settings: Sequence[Setting], work: str, titles: Mapping[str, str], label: str
) -> Figure:
    """Draw a line for each method; settings with a wrong outcome have no point."""
    right = [setting for setting in settings if setting.verdict == Verdict.RIGHT_OUTCOME]
    with style.context():
        rows = math.ceil(len(titles) / 2)
        figure = style.new_figure(height=(3.0 + 6.5 * rows) * style.CENTIMETRE)
        panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
        for place, (case, title) in enumerate(titles.items()):
            axes = panels.flat[place]
            axes.set_title(f"$\\bf{{{ascii_lowercase[place]}}}$  {title}", loc="left")
            for method, look in LOOKS.items():
                drawn = [each for each in right if (each.case, each.method) == (case, method)]
                costs = [getattr(each, work) for each in drawn]
                axes.plot([each.error for each in drawn], costs, label=method, **look)
        for axes in panels.flat[len(titles) :]:
            axes.set_visible(False)
        corner = panels[0, 0]
        corner.set_xscale("log")
        corner.set_yscale("log")
        corner.set_xlim(*reversed(corner.get_xlim()))
        truths = {each.case: each.uncertainty for each in settings}
        for case, axes in zip(titles, panels.flat, strict=False):
            least = corner.get_xlim()[1]
            axes.axvspan(least, max(least, truths.get(case, least)), color=style.GREY, alpha=0.2)
        figure.supxlabel("true error (more accurate to the right)", fontsize=9.0)
        figure.supylabel(label, fontsize=9.0)
        met = {setting.method for setting in settings}
        figure.legend(handles=_handles(met), loc="outside upper center", ncols=2)
        return figure


def _handles(methods: Collection[str]) -> list[Line2D]:
    """Return the entries of a legend of methods, in the order of ``LOOKS``."""
    return [
        Line2D([], [], label=METHODS[method].name, **look)
        for method, look in LOOKS.items()
        if method in methods
    ]
