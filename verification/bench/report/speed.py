"""Section on error against cost: what each case needs."""

import math
from collections.abc import Mapping, Sequence
from itertools import takewhile
from pathlib import Path

from markupsafe import Markup

from model.engine.series_layout import ORDER
from study.config.study import Study
from study.report.section import Results, Section, Table, link, settings_of, subscripts
from verification.bench.problems import Verdict
from verification.bench.report.checks import CHECKS, HEAD, SPEED_HEAD, SPEEDS, SPEEDS_BY
from verification.bench.work_precision import Setting, read_settings
from vibralign.plots.words import figure_title, number, power

COARSE, FINE = 1e-5, 1e-8  # the errors of which the report tells the cost


def section(results: Results) -> Section:
    """Return the section on error against cost."""
    precision = results.study.precision
    settings = read_settings(results.file("benchmarks/precision.csv"))
    content = {
        "checked": _checked(settings, results.study),
        "cases": _cases(results.study),
        "needed": _needed(settings, precision.titles),
        "usual": precision.ladder,
        "hard": precision.hard,
        "order": ORDER,
        "checks": Table(HEAD, CHECKS),
        "speeds": Table(SPEED_HEAD, SPEEDS),
        "speeds_by": SPEEDS_BY,
    }
    template = Path(__file__).with_suffix(".html.j2")
    lead = cost_of(settings, [*precision.cases])
    return Section("speed", "Error against cost", template, content, lead)


def ladders(settings: Sequence[Setting]) -> dict[str, list[Setting]]:
    """Return by case its settings from coarse to fine."""
    found: dict[str, list[Setting]] = {}
    for setting in settings:
        found.setdefault(setting.case, []).append(setting)
    return found


def needs(settings: Sequence[Setting], target: float) -> dict[str, Setting]:
    """Return by case the cheapest setting with a true error of at most ``target``.

    A setting counts only if all finer ones keep the target too: an error that passes through zero
    is luck. A case in which the target is not reached has no entry.
    """
    found: dict[str, Setting] = {}
    for case, ladder in ladders(settings).items():
        finished = [each for each in ladder if each.verdict != Verdict.TOO_MANY_EVALUATIONS]
        # An error is NaN where the outcome is wrong, or where only the outcome can be compared.
        kept = list(takewhile(lambda setting: setting.error <= target, reversed(finished)))
        if kept:
            found[case] = min(kept, key=lambda setting: setting.rhs_evaluations)
    return found


def nearest(ladder: Sequence[Setting]) -> Setting:
    """Return the setting with the smallest known error; without one, the coarsest."""
    return min(ladder, key=lambda each: math.inf if math.isnan(each.error) else each.error)


def cost_of(settings: Sequence[Setting], cases: Sequence[str]) -> str:
    """Return in words what it takes to keep ``FINE`` at an operating point of each motion."""
    need = needs(settings, FINE)
    times = sorted(need[case].microseconds for case in cases if case in need)
    if len(times) < len(cases):
        return f"The true error stays below {power(FINE)} in {len(times)} of {len(cases)} motions."
    return (
        f"A trajectory takes {times[0]:,.0f} to {times[-1]:,.0f} µs of one core to keep its true "
        f"error below {power(FINE)}, in every kind of motion."
    )


def _checked(settings: Sequence[Setting], study: Study) -> str:
    """Return how far the independent solutions are from those of the package."""
    independent = {*study.precision.cases, *study.precision.hard.independent}
    first = {each.case: each for each in reversed(settings) if each.case in independent}
    alike = [each for each in first.values() if math.isfinite(each.uncertainty)]
    apart = {
        aligned: max(
            (each.uncertainty for each in alike if (each.outcome == "aligned") == aligned),
            default=math.nan,
        )
        for aligned in (True, False)
    }
    return (
        f"In {len(alike)} of {len(first)} cases both end alike; there the alignment durations "
        f"differ by at most {power(apart[True])}, and the states at the end of runs that do not "
        f"align by at most {power(apart[False])}."
    )


def _cases(study: Study) -> Table:
    usual = [
        (
            case.title,
            link(figure_title(case.figure), f"#{case.figure}"),
            settings_of(case.at),
            number(case.until or study.settings.horizon),
            case.reason,
        )
        for case in study.precision.cases.values()
    ]
    hard = [
        (subscripts(case.title), "device", settings_of(case.at), number(case.until), "hard")
        for case in study.precision.hard.all_cases.values()
    ]
    return Table(("case", "as in", "but with", ">until τ", "why"), [*usual, *hard])


def _needed(settings: Sequence[Setting], titles: Mapping[str, str]) -> Table:
    """Return a row for each case, with its cost at either error, or how near it comes."""
    runs, need = ladders(settings), [needs(settings, target) for target in (COARSE, FINE)]
    costs = (f">error below {power(target)}" for target in (COARSE, FINE))
    return Table(
        ("case", "outcome", ">truth known to", ">events", *costs),
        [
            (
                subscripts(title),
                runs[case][0].outcome.replace("_", " "),
                power(runs[case][0].uncertainty),
                f"{runs[case][0].events:,}",
                *(_cell(runs[case], each.get(case)) for each in need),
            )
            for case, title in titles.items()
            if case in runs
        ],
    )


def _cell(ladder: Sequence[Setting], need: Setting | None) -> str:
    """Return time and evaluations of a run, pale if its error is below the truth's own."""
    if need is not None:
        look = Markup(' class="soft"') if need.error < need.uncertainty else ""
        words = Markup("<span{}>{:,.0f} µs<br>{:,}</span>")
        return words.format(look, need.microseconds, need.rhs_evaluations)
    best = nearest(ladder)
    if math.isnan(best.error):
        return best.verdict.name.lower().replace("_", " ")
    return Markup("<em>error {}</em>").format(power(best.error))
