"""Pictures of speed against error, and of the points that fixed steps get wrong."""

import math
from collections.abc import Collection, Mapping, Sequence
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from benchmarks.fixed_steps import Wrong
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from benchmarks.work_precision import Setting, TimedSetting, names_of, settings_in
from model.show import style
from model.show.style import axis_label, cell_edges
from model.show.words import percent

if TYPE_CHECKING:
    import xarray as xr

LABELS: Mapping[Wrong, str] = {
    Wrong.WRONG_TIME: "wrong time",
    Wrong.WRONG_OUTCOME: "wrong outcome",
}
TYPICAL_SCHEME = "rk4"  # the usual method of a study of 2007

# Blue: with event location; orange and purple: fixed steps; the others: scipy.
LOOKS: Mapping[str, Mapping[str, Any]] = {
    "dop853_located": {"color": style.BLUE, "marker": "o", "linestyle": "-", "linewidth": 2.2},
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
    "lifts off.",
    "times": "CPU time of one trajectory over the true error, as measured in this build on this "
    "machine: neighbouring parameter sets on one core, median of repeats.",
    "wrong_points": "Fixed steps on two figures: points at which RK4 without event "
    "location ends otherwise, or aligns at another time, than with all events located.",
}


# --- Work over error ----------------------------------------------------------------------------


def evaluations_over_error(dataset: "xr.Dataset", titles: Mapping[str, str]) -> Figure:
    """Draw right-hand-side evaluations over true error, a panel for each case."""
    label = "evaluations of the equations of motion"
    return _work_over_error(settings_in(dataset), "rhs_evaluations", titles, label)


def time_over_error(settings: Sequence[TimedSetting], titles: Mapping[str, str]) -> Figure:
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
        corner.invert_xaxis()
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


# --- Points that fixed steps get wrong ----------------------------------------------------------


def wrong_points(datasets: Sequence["xr.Dataset"]) -> Figure:
    """Draw the points of each figure that RK4 gets wrong, a row for each step."""
    steps = datasets[0]["step"].values
    with style.context():
        figure = style.new_figure(height=(1.5 + 6.5 * len(steps)) * style.CENTIMETRE)
        panels = figure.subplots(len(steps), len(datasets), squeeze=False, sharex="col")
        for column, dataset in enumerate(datasets):
            number = int(str(dataset.attrs["figure"]).removeprefix("fig"))
            is_map = dataset.attrs["figure_kind"] == "map"
            row_of = names_of(dataset["scheme"]).index(TYPICAL_SCHEME)
            for row, step in enumerate(steps):
                axes = panels[row, column]
                part = dataset.isel(scheme=row_of, step=row)
                _draw_wrong_points(axes, part, is_map=is_map)
                share = float(np.mean(part["wrong"].values != Wrong.NOT_WRONG))
                axes.set_title(f"Fig. {number}, $h$ = {step:g}: {percent(share)} wrong")
            panels[-1, column].set_xlabel(axis_label(dataset[dataset["tau_located"].dims[1]]))
        figure.legend(
            handles=_wrong_handles(datasets[0].attrs["tau_tolerance"]),
            loc="outside lower center",
            ncols=2,
        )
        return figure


_MARKS: Mapping[Wrong, Mapping[str, Any]] = {
    Wrong.WRONG_TIME: {
        "linestyle": "none", "marker": "o", "markersize": 3.0, "color": style.VERMILLION,
        "markeredgewidth": 0.0,
    },
    Wrong.WRONG_OUTCOME: {
        "linestyle": "none", "marker": "x", "markersize": 4.0, "color": style.BLACK,
        "markeredgewidth": 0.9,
    },
}  # fmt: skip
_LOCATED_LOOK: Mapping[str, Any] = {"color": style.GREY, "linewidth": 0.8}
_NOT_ALIGNED_SHADE = "#E4E4E4"


def _draw_wrong_points(axes: Axes, part: "xr.Dataset", *, is_map: bool) -> None:
    """Draw the true curves, or the area without alignment, in grey, and the wrong points on it."""
    y, x = (str(name) for name in part["tau_located"].dims)
    swept, located, tau = part[x].values, part["tau_located"].values, part["tau_align"].values
    gaps = np.isnan(located)
    if is_map:
        heights = np.broadcast_to(part[y].values[:, np.newaxis], tau.shape)
        area = np.ma.masked_equal(gaps.astype(float), 0.0)
        axes.grid(visible=False)
        axes.pcolormesh(
            cell_edges(swept), cell_edges(part[y].values), area,
            cmap=ListedColormap([_NOT_ALIGNED_SHADE]), rasterized=True,
        )  # fmt: skip
        axes.set_ylabel(axis_label(part[y]))
    else:
        heights = np.where(np.isnan(tau), located, tau)  # the time with RK4, or else the true one
        axes.plot(swept, located.T, label="_located", **_LOCATED_LOOK)
        axes.set_ylim(0.0, 1.0 if gaps.all() else 1.15 * float(np.nanmax(located)))
        axes.set_ylabel("alignment duration $τ$")
    for kind, look in _MARKS.items():
        row, column = np.nonzero(part["wrong"].values == kind)
        axes.plot(swept[column], heights[row, column], label=LABELS[kind], **look)


def _wrong_handles(tau_tolerance: float) -> list[Line2D | Patch]:
    return [
        Line2D([], [], label=f"$τ$ off by more than {tau_tolerance:g}", **_MARKS[Wrong.WRONG_TIME]),
        Line2D([], [], label=LABELS[Wrong.WRONG_OUTCOME], **_MARKS[Wrong.WRONG_OUTCOME]),
        Line2D([], [], label="right, all events located", **_LOCATED_LOOK),
        Patch(facecolor=_NOT_ALIGNED_SHADE, label="does not align"),
    ]
