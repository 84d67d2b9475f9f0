"""Section on hard cases: outcome and error of every method on every case."""

from collections.abc import Sequence
from pathlib import Path

from benchmarks.hard_cases import HARD_METHODS, Judged, Mark, read_judged
from benchmarks.methods import METHODS
from benchmarks.plans import HARD_PICTURES
from benchmarks.report.hard_cases_plots import CAPTIONS
from model.show.report.section import Results, Section, settings_of, subscripts


def section(results: Results) -> Section:
    """Return the section on hard cases."""
    spec = results.study.hard_cases
    cases = spec.all_cases
    judged = read_judged(results.file("benchmarks/hard_cases.csv"))
    lead, *sentences = [_counted(name, judged) for name in METHODS]
    budgets = {"shared": spec.every_method.max_evaluations, "others": spec.max_evaluations}
    content = {
        "spec": spec,
        "sentences": sentences,
        "pictures": [
            results.picture(place, CAPTIONS[name].format(**budgets))
            for name, place in HARD_PICTURES.items()
        ],
        "rows": [
            {
                "title": subscripts(case.title),
                "values": settings_of(case.at),
                "until": case.until,
                "judged": [each for each in judged if each.case == name],
            }
            for name, case in cases.items()
        ],
        "longer": [
            f"{case.title}, {case.max_evaluations:,}"
            for case in cases.values()
            if case.max_evaluations
        ],
        "labels": {name: method.name for name, method in HARD_METHODS.items()},
    }
    lead = f"Of {len(cases)} scenes that are hard to integrate, {lead}"
    return Section("hard", "Hard cases", Path(__file__).with_suffix(".html.j2"), content, lead)


def _counted(method: str, judged: Sequence[Judged]) -> str:
    marks = [each.mark for each in judged if each.method == method]
    counts = ", ".join(f"{marks.count(mark)} {mark.value}" for mark in Mark if mark in marks)
    return f"{METHODS[method].name}: {counts}, of {len(marks)}."
