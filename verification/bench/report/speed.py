"""Section on error against cost: what each method needs on each case."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from markupsafe import Markup

from model.engine.series_layout import ORDER
from study.config.study import Study
from study.report.section import Results, Section, Table, link, settings_of, subscripts
from verification.bench.methods import METHODS
from verification.bench.plans import PICTURE
from verification.bench.report.advice import COARSE, FINE, advice, ladders, nearest, needs
from verification.bench.report.checks import CHECKS, HEAD, SPEED_HEAD, SPEEDS, SPEEDS_BY
from verification.bench.report.work_precision_plots import CAPTION
from verification.bench.work_precision import Setting, read_settings
from vibralign.plots.words import figure_title, number, power


def section(results: Results) -> Section:
    """Return the section on error against cost."""
    precision = results.study.precision
    settings = read_settings(results.file("benchmarks/precision.csv"))
    lead, *sentences = advice(settings, [*precision.cases])
    content = {
        "sentences": [*sentences, _by_hand(settings)],
        "checked": _checked(settings, results.study),
        "cases": _cases(results.study),
        "picture_of_times": results.picture(PICTURE, CAPTION),
        "tables": [
            (target, _needed(settings, target, precision.titles)) for target in (COARSE, FINE)
        ],
        "usual": precision.ladder,
        "hard": precision.hard,
        "order": ORDER,
        "checks": Table(HEAD, CHECKS),
        "speeds": Table(SPEED_HEAD, SPEEDS),
        "speeds_by": SPEEDS_BY,
    }
    template = Path(__file__).with_suffix(".html.j2")
    return Section("speed", "Error against cost", template, content, lead)


def _by_hand(settings: Sequence[Setting]) -> str:
    """Return in how many cases fixed steps, as one would write them by hand, are the faster."""
    words = []
    for target in (COARSE, FINE):
        times: dict[str, dict[bool, float]] = {}  # by case, and by whether the steps are fixed
        for (name, case), need in needs(settings, target).items():
            least, fixed = times.setdefault(case, {}), METHODS[name].fixed
            least[fixed] = min(least.get(fixed, math.inf), need.microseconds)
        faster = [each.get(True, math.inf) < each.get(False, math.inf) for each in times.values()]
        words.append(f"at {power(target)} in {sum(faster)} of {len(faster)}")
    return (
        "Fixed steps, as one would write them by hand, take less time than this package "
        f"{' and '.join(words)} of the cases in which either keeps the error."
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


def _needed(settings: Sequence[Setting], target: float, titles: Mapping[str, str]) -> Table:
    """Return a row for each case and a column for each method: its cost, or how near it comes."""
    runs, need = ladders(settings), needs(settings, target)
    first = {each.case: each for each in reversed(settings)}
    return Table(
        (
            "case",
            "outcome",
            ">truth known to",
            ">events",
            *(f">{method.name}" for method in METHODS.values()),
        ),
        [
            (
                subscripts(title),
                first[case].outcome.replace("_", " "),
                power(first[case].uncertainty),
                f"{first[case].events:,}",
                *(
                    _cell(runs.get((name, case)), need.get((name, case)), first[case].uncertainty)
                    for name in METHODS
                ),
            )
            for case, title in titles.items()
            if case in first
        ],
    )


def _cell(ladder: Sequence[Setting] | None, need: Setting | None, uncertainty: float) -> str:
    """Return time and evaluations of a run, pale if its error is below the truth's own."""
    if need is not None:
        look = Markup(' class="soft"') if need.error < uncertainty else ""
        words = Markup("<span{}>{:,.0f} µs<br>{:,}</span>")
        return words.format(look, need.microseconds, need.rhs_evaluations)
    if ladder is None:
        return "–"
    best = nearest(ladder)
    if math.isnan(best.error):
        return best.verdict.name.lower().replace("_", " ")
    return Markup("<em>error {}</em>").format(power(best.error))
