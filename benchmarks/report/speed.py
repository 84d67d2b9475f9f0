"""Section on speed against error: cost of each method."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from markupsafe import Markup

from benchmarks.methods import METHODS
from benchmarks.plans import PICTURES
from benchmarks.report.advice import COARSE, FINE, advice, needs
from benchmarks.report.work_precision_plots import CAPTIONS
from benchmarks.work_precision import Setting, read_settings
from model.show.report.section import Results, Section, Table, link, settings_of
from model.show.words import figure_title
from model.study.config.study import Study


def section(results: Results) -> Section:
    """Return the section on speed against error."""
    study = results.study
    settings = read_settings(results.file("benchmarks/precision.csv"))
    titles = {name: case.title for name, case in study.precision.cases.items()}
    lead, *sentences = advice(settings, titles)
    content = {
        "sentences": sentences,
        "cases": _cases(study),
        "pictures": [results.picture(place, CAPTIONS[name]) for name, place in PICTURES.items()],
        "tables": [(target, _needed(settings, target, titles)) for target in (COARSE, FINE)],
    }
    template = Path(__file__).with_suffix(".html.j2")
    return Section("speed", "Speed against error", template, content, lead)


def _cases(study: Study) -> Table:
    return Table(
        ("case", "as in", "but with", "why"),
        [
            (
                case.title,
                link(figure_title(case.figure), f"#{case.figure}"),
                settings_of(case.at),
                case.reason,
            )
            for case in study.precision.cases.values()
        ],
    )


def _needed(settings: Sequence[Setting], target: float, titles: Mapping[str, str]) -> Table:
    need = needs(settings, target)
    return Table(
        ("method", *(f">{title}" for title in titles.values())),
        [
            (method.name, *(_cell(need.get((name, case))) for case in titles))
            for name, method in METHODS.items()
        ],
    )


def _cell(need: Setting | None) -> str:
    if need is None:
        return "–"
    each = 1e3 * need.microseconds / need.events
    return Markup("{:,}<br>{:,.0f} µs<br>{:,.0f} ns").format(
        need.rhs_evaluations, need.microseconds, each
    )
