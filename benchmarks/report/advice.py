"""Cost of methods at a required error, and advice on the choice of a method."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from benchmarks.fixed_steps import wrong_counts
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from benchmarks.report.work_precision_plots import TYPICAL_SCHEME
from benchmarks.work_precision import TimedSetting
from model.show.words import percent, power, short

if TYPE_CHECKING:
    import xarray as xr

FINE, COARSE = 1e-8, 1e-5  # the errors at which methods are compared


@dataclass(frozen=True)
class Need:
    """The cheapest setting of a method on a case that keeps a required error."""

    rhs_evaluations: int
    microseconds: float
    resolution: float
    events: int


def needs(settings: Sequence[TimedSetting], target: float) -> dict[tuple[str, str], Need]:
    """Return by (method, case) the cost of a true error of at most ``target``.

    A setting counts only if all finer ones keep the target too: an error that passes through zero
    is luck. A method that does not reach the target on a case has no entry.
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


def advice(
    settings: Sequence[TimedSetting], wrong: Mapping[str, "xr.Dataset"], titles: Mapping[str, str]
) -> tuple[str, str, str]:
    """Return three sentences of advice on the choice of a method, from the measurements.

    Args:
        settings: settings of all methods on all cases.
        wrong: datasets with fixed steps, by figure.
        titles: titles of the cases, by name.
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
    """Return the method that keeps the error in all cases in the least time (geometric mean)."""
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
