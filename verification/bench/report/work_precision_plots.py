"""Picture of speed against error."""

import math
from collections.abc import Mapping, Sequence
from string import ascii_lowercase
from typing import Any

from matplotlib.figure import Figure

from verification.bench.methods import METHODS
from verification.bench.problems import Verdict
from verification.bench.work_precision import Setting
from vibralign.plots import style

LOOKS: Mapping[str, Mapping[str, Any]] = {
    "taylor_located": {"color": style.BLUE, "marker": "o", "linewidth": 2.2},
    "rk4_fixed": {"color": style.ORANGE, "marker": "^"},
    "semi_implicit_euler_fixed": {"color": style.PURPLE, "marker": "v"},
}
CAPTION = (
    "CPU time of one trajectory over the true error, as measured in this build on this machine: "
    "neighbouring parameter sets on one core, median of repeats. A method that does not locate "
    "events needs ever more time for each digit as soon as the part sticks or lifts off. Shaded: "
    "below what the true solution itself is known to."
)


def time_over_error(settings: Sequence[Setting], titles: Mapping[str, str]) -> Figure:
    """Draw the CPU time of a trajectory over true error, a panel for each case.

    Each method is a line; settings with a wrong outcome have no point.
    """
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
                times = [each.microseconds for each in drawn]
                axes.plot([each.error for each in drawn], times, label=METHODS[method].name, **look)
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
        figure.supylabel("CPU time of a trajectory (µs)", fontsize=9.0)
        lines = corner.get_lines()
        figure.legend(handles=lines, loc="outside upper center", ncols=len(lines))
        return figure
