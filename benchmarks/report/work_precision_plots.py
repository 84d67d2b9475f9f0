"""Speed against error: pictures, tables, and advice from them."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import compress
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from benchmarks.fixed_steps import Wrong, wrong_counts
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from benchmarks.work_precision import Setting, TimedSetting, names_of
from model.show import style
from model.show.style import axis_label, cell_edges
from model.show.words import percent, power, short

if TYPE_CHECKING:
    import xarray as xr

WRONG_OUTCOME_LABEL = "wrong outcome"
WRONG_TIME_LABEL = "wrong time"
TYPICAL_SCHEME = "rk4"  # what a study of 2007 would have used

# Blue is located; warm colours are fixed steps; the rest is scipy.
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


def settings_of(dataset: "xr.Dataset") -> list[Setting]:
    """Return the settings that a dataset of the comparison holds, in order."""
    cases, methods = names_of(dataset["case"]), names_of(dataset["method"])
    columns = {
        name: dataset[name].values for name in ("resolution", "error", "rhs_evaluations", "verdict")
    }
    return [
        Setting(
            case=cases[place[0]],
            method=methods[place[1]],
            resolution=float(columns["resolution"][place]),
            error=float(columns["error"][place]),
            rhs_evaluations=int(columns["rhs_evaluations"][place]),
            verdict=Verdict(int(columns["verdict"][place])),
        )
        for place in np.ndindex(columns["verdict"].shape)
        if columns["verdict"][place] != Verdict.NOT_TRIED
    ]


def evaluations_over_error(dataset: "xr.Dataset", titles: Mapping[str, str]) -> Figure:
    """Draw right-hand-side evaluations over true error, a panel for each case."""
    label = "evaluations of the equations of motion"
    settings = settings_of(dataset)
    return _work_over_error(
        settings, [setting.rhs_evaluations for setting in settings], titles, label
    )


def time_over_error(settings: Sequence[TimedSetting], titles: Mapping[str, str]) -> Figure:
    """Draw the CPU time of a trajectory over true error, a panel for each case."""
    label = "CPU time of a trajectory (µs)"
    return _work_over_error(settings, [setting.microseconds for setting in settings], titles, label)


def _work_over_error(
    settings: Sequence[Setting], work: Sequence[float], titles: Mapping[str, str], label: str
) -> Figure:
    with style.context():
        rows = math.ceil(len(titles) / 2)
        figure = style.new_figure(height=(3.0 + 6.5 * rows) * style.CENTIMETRE)
        panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
        for place, (case, title) in enumerate(titles.items()):
            axes = panels.flat[place]
            axes.set_title(f"$\\bf{{{ascii_lowercase[place]}}}$  {title}", loc="left")
            chosen = [setting.case == case for setting in settings]
            _draw_case(axes, list(compress(settings, chosen)), list(compress(work, chosen)))
        for axes in panels.flat[len(titles) :]:
            axes.set_visible(False)
        corner = panels[0, 0]
        corner.set_xscale("log")
        corner.set_yscale("log")
        corner.invert_xaxis()
        figure.supxlabel("true error (more accurate to the right)", fontsize=9.0)
        figure.supylabel(label, fontsize=9.0)
        figure.legend(handles=_handles(settings), loc="outside upper center", ncols=2)
        return figure


def _draw_case(axes: Axes, settings: Sequence[Setting], work: Sequence[float]) -> None:
    """Draw a line for each method; a setting with the wrong outcome has no error and no point."""
    for method, look in LOOKS.items():
        drawn = [
            setting.method == method and setting.verdict == Verdict.RIGHT_OUTCOME
            for setting in settings
        ]
        errors = [setting.error for setting in compress(settings, drawn)]
        axes.plot(errors, list(compress(work, drawn)), label=method, **look)


def _handles(settings: Iterable[Setting]) -> list[Line2D]:
    met = {setting.method for setting in settings}
    return [
        Line2D([], [], label=METHODS[method].name, **look)
        for method, look in LOOKS.items()
        if method in met
    ]


# --- Points that fixed steps get wrong ----------------------------------------------------------


def wrong_points(datasets: Sequence["xr.Dataset"]) -> Figure:
    """Draw the points of each figure that come out wrong with RK4: a row for each step."""
    steps = datasets[0]["step"].values
    with style.context():
        figure = style.new_figure(height=(1.5 + 6.5 * len(steps)) * style.CENTIMETRE)
        panels = figure.subplots(len(steps), len(datasets), squeeze=False, sharex="col")
        for column, dataset in enumerate(datasets):
            number = int(str(dataset.attrs["figure"]).removeprefix("fig"))
            draw = _wrong_on_map if dataset.attrs["figure_kind"] == "map" else _wrong_on_curves
            row_of = names_of(dataset["scheme"]).index(TYPICAL_SCHEME)
            for row, step in enumerate(steps):
                axes = panels[row, column]
                part = dataset.isel(scheme=row_of, step=row)
                draw(axes, part)
                share = float(np.mean(part["wrong"].values != Wrong.NOT_WRONG))
                axes.set_title(f"Fig. {number}, $h$ = {step:g}: {percent(share)} wrong")
            panels[-1, column].set_xlabel(axis_label(dataset[_dims(dataset)[1]]))
        figure.legend(
            handles=_wrong_handles(datasets[0].attrs["tau_tolerance"]),
            loc="outside lower center",
            ncols=2,
        )
        return figure


_TIME_LOOK: Mapping[str, Any] = {
    "linestyle": "none", "marker": "o", "markersize": 3.0, "color": style.VERMILLION,
    "markeredgewidth": 0.0,
}  # fmt: skip
_OUTCOME_LOOK: Mapping[str, Any] = {
    "linestyle": "none", "marker": "x", "markersize": 4.0, "color": style.BLACK,
    "markeredgewidth": 0.9,
}  # fmt: skip
_LOCATED_LOOK: Mapping[str, Any] = {"color": style.GREY, "linewidth": 0.8}
_NOT_ALIGNED_SHADE = "#E4E4E4"


def _dims(dataset: "xr.Dataset") -> tuple[str, str]:
    y, x = (str(name) for name in dataset["tau_located"].dims)
    return y, x


def _wrong_on_curves(axes: Axes, part: "xr.Dataset") -> None:
    """Draw the curves with event location in grey, and wrong times and outcomes as marks."""
    _, x = _dims(part)
    swept, located, tau = part[x].values, part["tau_located"].values, part["tau_align"].values
    axes.plot(swept, located.T, label="_located", **_LOCATED_LOOK)
    row, column = np.nonzero(part["wrong"].values == Wrong.WRONG_TIME)
    axes.plot(swept[column], tau[row, column], label=WRONG_TIME_LABEL, **_TIME_LOOK)
    row, column = np.nonzero(part["wrong"].values == Wrong.WRONG_OUTCOME)
    either = np.where(np.isnan(located), tau, located)[row, column]
    axes.plot(swept[column], either, label=WRONG_OUTCOME_LABEL, **_OUTCOME_LOOK)
    axes.set_ylim(0.0, 1.15 * float(np.nanmax(located)) if not np.isnan(located).all() else 1.0)
    axes.set_ylabel("alignment duration $τ$")


def _wrong_on_map(axes: Axes, part: "xr.Dataset") -> None:
    """Draw the area that does not align in grey, wrong points as marks."""
    y, x = _dims(part)
    gaps = np.isnan(part["tau_located"].values)
    area = np.ma.masked_equal(gaps.astype(float), 0.0)
    axes.grid(visible=False)
    axes.pcolormesh(
        cell_edges(part[x].values), cell_edges(part[y].values), area,
        cmap=ListedColormap([_NOT_ALIGNED_SHADE]), rasterized=True,
    )  # fmt: skip
    wrong = part["wrong"].values
    for kind, label, look in (
        (Wrong.WRONG_TIME, WRONG_TIME_LABEL, _TIME_LOOK),
        (Wrong.WRONG_OUTCOME, WRONG_OUTCOME_LABEL, _OUTCOME_LOOK),
    ):
        row, column = np.nonzero(wrong == kind)
        axes.plot(part[x].values[column], part[y].values[row], label=label, **look)
    axes.set_ylabel(axis_label(part[y]))


def _wrong_handles(tau_tolerance: float) -> list[Line2D | Patch]:
    return [
        Line2D([], [], label=f"$τ$ off by more than {tau_tolerance:g}", **_TIME_LOOK),
        Line2D([], [], label=WRONG_OUTCOME_LABEL, **_OUTCOME_LOOK),
        Line2D([], [], label="right, all events located", **_LOCATED_LOOK),
        Patch(facecolor=_NOT_ALIGNED_SHADE, label="does not align"),
    ]


# --- What it needs to reach an error ------------------------------------------------------------


@dataclass(frozen=True)
class Need:
    """The cheapest setting from which on a method keeps within an error, on one case."""

    rhs_evaluations: int
    microseconds: float
    resolution: float
    events: int


def needs(settings: Sequence[TimedSetting], target: float) -> dict[tuple[str, str], Need]:
    """Return, by (method, case), the cost of keeping the true error at ``target`` or below.

    A setting counts only if all finer ones keep within the target too: an error that passes through
    zero is luck. Where a method does not get there, it has no entry.
    """
    found: dict[tuple[str, str], Need] = {}
    for method in METHODS:
        for case in dict.fromkeys(setting.case for setting in settings):
            ladder = [
                setting
                for setting in settings
                if (setting.method, setting.case) == (method, case)
                and setting.verdict != Verdict.TOO_MANY_EVALUATIONS
            ]
            kept: list[TimedSetting] = []
            for setting in reversed(ladder):
                if not setting.error <= target:  # NaN where the outcome is wrong
                    break
                kept.append(setting)
            if kept:
                least = min(kept, key=lambda setting: setting.rhs_evaluations)
                found[method, case] = Need(
                    least.rhs_evaluations, least.microseconds, least.resolution, least.events
                )
    return found


# --- Advice -------------------------------------------------------------------------------------

FINE, COARSE = 1e-8, 1e-5  # the errors at which methods are compared


def advice(
    settings: Sequence[TimedSetting], wrong: Mapping[str, "xr.Dataset"], titles: Mapping[str, str]
) -> tuple[str, str, str]:
    """Return three sentences of advice on the choice of a method, from the measurements.

    Args:
        settings: every method on every case.
        wrong: by figure, its dataset with fixed steps.
        titles: of the cases.
    """
    fine, coarse = needs(settings, FINE), needs(settings, COARSE)
    cases = list(titles)
    best_fine, best_coarse = _fastest(fine, cases), _fastest(coarse, cases)
    without = [name for name, method in METHODS.items() if not method.located]
    reached = [titles[case] for case in cases if any((name, case) in fine for name in without)]
    if best_fine is None:
        numbers = f"No method keeps the true error below {power(FINE)} in every case"
    else:
        numbers = (
            f"For numbers that are compared, fitted or differentiated, choose "
            f"{METHODS[best_fine].name}: it keeps the true error below {power(FINE)} in every "
            f"case, at {_range(fine, best_fine, cases)} µs a trajectory, "
        )
        if reached:
            numbers += (
                f"where methods without event location get there in {len(reached)} of "
                f"{len(cases)} cases ({', '.join(reached)})"
            )
        else:
            numbers += "where no method without event location gets there in any case"
    if best_coarse is None:
        scans = f"No method keeps the true error below {power(COARSE)} in every case"
    else:
        same = "the same" if best_coarse == best_fine else METHODS[best_coarse].name
        scans = (
            f"For scans and maps, where {power(COARSE)} will do, choose {same} at a looser "
            f"tolerance, {_range(coarse, best_coarse, cases)} µs a trajectory; "
            f"{_against_scipy(coarse, best_coarse, cases)}"
        )
    return f"{numbers}.", f"{scans}.", f"{_against_fixed_steps(wrong)}."


def _fastest(need: Mapping[tuple[str, str], Need], cases: Sequence[str]) -> str | None:
    """Return the method that keeps the error in every case in the least time (geometric mean)."""
    costs = {
        method: math.prod(need[method, case].microseconds for case in cases)
        for method in METHODS
        if all((method, case) in need for case in cases)
    }
    return min(costs, key=lambda method: costs[method]) if costs else None


def _range(need: Mapping[tuple[str, str], Need], method: str, cases: Sequence[str]) -> str:
    costs = [need[method, case].microseconds for case in cases]
    return " to ".join(dict.fromkeys(f"{cost:,.0f}" for cost in (min(costs), max(costs))))


def _against_scipy(need: Mapping[tuple[str, str], Need], best: str, cases: Sequence[str]) -> str:
    solvers = [name for name, method in METHODS.items() if method.package == "scipy"]
    ratios = []
    for case in cases:
        costs = [need[name, case].microseconds for name in solvers if (name, case) in need]
        if costs:
            ratios.append(min(costs) / need[best, case].microseconds)
    if not ratios:
        return "scipy's solvers get there in no case"
    times = " to ".join(dict.fromkeys(short(ratio) for ratio in (min(ratios), max(ratios))))
    return (
        f"the fastest of scipy's solvers takes {times} times as long, and gets there in "
        f"{len(ratios)} of {len(cases)} cases"
    )


def _against_fixed_steps(wrong: Mapping[str, "xr.Dataset"]) -> str:
    counts = {figure: wrong_counts(dataset) for figure, dataset in wrong.items()}
    steps = dict.fromkeys(step for each in counts.values() for _, step in each)
    parts = []
    for step in steps:
        shares = []
        for figure, each in counts.items():
            count = each[TYPICAL_SCHEME, step]
            share = (count["wrong_outcome"] + count["wrong_time"]) / count["points"]
            shares.append(f"{percent(share)} of Fig. {int(figure.removeprefix('fig'))}")
        parts.append(f"{' and '.join(shares)} with h = {step:g}")
    return (
        "Choose fixed steps without event location for a first look only: of the points, RK4 "
        f"gets wrong {', '.join(parts)}"
    )
