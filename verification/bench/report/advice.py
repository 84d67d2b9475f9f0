"""Cost of methods at a required error, and advice on the choice of a method."""

import math
from collections.abc import Collection, Sequence
from itertools import takewhile

from verification.bench.methods import METHODS
from verification.bench.problems import Verdict
from verification.bench.work_precision import Setting
from vibralign.plots.words import power, short

FINE, COARSE = 1e-8, 1e-5  # the errors at which methods are compared


def ladders(settings: Sequence[Setting]) -> dict[tuple[str, str], list[Setting]]:
    """Return by (method, case) its settings from coarse to fine."""
    found: dict[tuple[str, str], list[Setting]] = {}
    for setting in settings:
        found.setdefault((setting.method, setting.case), []).append(setting)
    return found


def needs(settings: Sequence[Setting], target: float) -> dict[tuple[str, str], Setting]:
    """Return by (method, case) the cheapest setting with a true error of at most ``target``.

    A setting counts only if all finer ones keep the target too: an error that passes through zero
    is luck. A method that does not reach the target on a case has no entry.
    """
    found: dict[tuple[str, str], Setting] = {}
    for key, ladder in ladders(settings).items():
        finished = [each for each in ladder if each.verdict != Verdict.TOO_MANY_EVALUATIONS]
        # An error is NaN where the outcome is wrong, or where only the outcome can be compared.
        kept = list(takewhile(lambda setting: setting.error <= target, reversed(finished)))
        if kept:
            found[key] = min(kept, key=lambda setting: setting.rhs_evaluations)
    return found


def nearest(ladder: Sequence[Setting]) -> Setting:
    """Return the setting with the smallest known error; without one, the coarsest."""
    return min(ladder, key=lambda each: math.inf if math.isnan(each.error) else each.error)


def advice(settings: Sequence[Setting], cases: Collection[str]) -> tuple[str, str]:
    """Return two sentences of advice on the choice of a method, from the measurements.

    Args:
        settings: settings of all methods.
        cases: names of the cases that count, an operating point of each kind of motion.
    """
    return (
        _choice("numbers that are compared, fitted or differentiated", settings, FINE, cases),
        _choice("scans and maps", settings, COARSE, cases),
    )


def _choice(
    purpose: str, settings: Sequence[Setting], target: float, cases: Collection[str]
) -> str:
    """Return which method to choose for a purpose that asks for an error, and what others need.

    It is the method that keeps the error in all cases in the least time (geometric mean). The times
    of fixed steps are those of the best of them in each case in which any keeps the error.
    """
    need, error = needs(settings, target), power(target)
    costs = {
        method: [need[method, case].microseconds for case in cases]
        for method in METHODS
        if all((method, case) in need for case in cases)
    }
    if not costs:
        return f"No method keeps the true error below {error} in every kind of motion."
    best = min(costs, key=lambda method: math.prod(costs[method]))
    times = _range([f"{cost:,.0f}" for cost in sorted(costs[best])])
    fixed = [name for name, method in METHODS.items() if method.fixed and name != best]
    ratios = []
    for case, own in zip(cases, costs[best], strict=True):
        others = [need[name, case].microseconds for name in fixed if (name, case) in need]
        ratios += [min(others) / own] if others else []
    ratio = _range([short(each) for each in sorted(ratios)]) if ratios else ""
    longer = f"take {ratio} times as long in {len(ratios)}" if ratios else "keep it in none"
    return (
        f"For {purpose} choose {METHODS[best].name}: it keeps the true error below {error} in "
        f"every case, at {times} µs a trajectory; fixed steps {longer} of {len(cases)} cases."
    )


def _range(rising: Sequence[str]) -> str:
    """Return the first and the last of some words, or one if they are the same."""
    return " to ".join(dict.fromkeys((rising[0], rising[-1])))
