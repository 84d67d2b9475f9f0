"""Section on speed against error: cost of each method, and points that fixed steps get wrong."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from markupsafe import Markup

from benchmarks.fixed_steps import wrong_counts
from benchmarks.methods import METHODS
from benchmarks.plans import PICTURES
from benchmarks.report.advice import COARSE, FINE, advice, needs
from benchmarks.report.work_precision_plots import CAPTIONS
from benchmarks.work_precision import TimedSetting, read_timings
from model.show.report.section import Results, Section, Table, link, settings_of
from model.show.words import figure_title, number
from model.study.config.study import Study

if TYPE_CHECKING:
    import xarray as xr

_SCHEME_WORDS = {"rk4": "RK4", "semi_implicit_euler": "semi-implicit Euler"}


def section(results: Results) -> Section:
    """Return the section on speed against error."""
    study = results.study
    settings = read_timings(results.file("benchmarks/precision.csv"))
    wrong = {
        name: results.dataset(f"data/fixed_steps/{name}.nc")
        for name in study.precision.fixed_steps.figures
    }
    titles = {name: case.title for name, case in study.precision.cases.items()}
    lead, *sentences = advice(settings, wrong, titles)
    content = {
        "sentences": sentences,
        "cases": _cases(study),
        "pictures": [results.picture(place, CAPTIONS[name]) for name, place in PICTURES.items()],
        "tables": [(target, _needed(settings, target, titles)) for target in (COARSE, FINE)],
        "wrong": _wrong(wrong),
        "tau_tolerance": study.precision.fixed_steps.tau_tolerance,
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


def _needed(settings: Sequence[TimedSetting], target: float, titles: Mapping[str, str]) -> Table:
    need = needs(settings, target)
    return Table(
        ("method", *(f">{title}" for title in titles.values())),
        [
            (method.name, *(_cell(need.get((name, case))) for case in titles))
            for name, method in METHODS.items()
        ],
    )


def _cell(need: TimedSetting | None) -> str:
    if need is None:
        return "–"
    each = 1e3 * need.microseconds / need.events
    return Markup("{:,}<br>{:,.0f} µs<br>{:,.0f} ns").format(
        need.rhs_evaluations, need.microseconds, each
    )


def _wrong(datasets: "Mapping[str, xr.Dataset]") -> Table:
    columns = ("figure", "method", ">step", ">points", ">wrong outcome", ">wrong duration",
               ">of these sensitive")  # fmt: skip
    return Table(
        columns,
        [
            (
                figure_title(figure),
                _SCHEME_WORDS[scheme],
                number(step),
                *(counts[each] for each in ("points", "wrong_outcome", "wrong_time", "sensitive")),
            )
            for figure, dataset in datasets.items()
            for (scheme, step), counts in wrong_counts(dataset).items()
        ],
    )
