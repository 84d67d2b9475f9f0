"""Content of the study's explorer: its device, with figures and hard cases as presets."""

import math
from collections.abc import Mapping
from typing import Any

from model.sweeps.axes import Family
from study.config.study import Study
from vibralign.answers.assumptions import assumptions
from vibralign.explorer.content import DEFAULT_AXES, described, page_model
from vibralign.plots.words import figure_title


def study_model(study: Study, interface: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of the study's page."""
    presets = {name: _figure(study, name) for name in study.computed}
    baseline = study.baseline.given()
    for name, case in study.precision.hard.cases.items():
        values = study.baseline.replace(**case.at).given()
        presets[f"case_{name}"] = {"group": "Hard cases", "title": case.title, "values": values}
    return {
        **page_model(
            "vibralign explorer", baseline, None, study.settings.settings, interface,
            assumptions(study.baseline, study.settings.settings),
        ),
        "parameters": described(baseline, None, [*study.operating_point], _axes(study)),
        "presets": {name: DEFAULT_AXES | each for name, each in presets.items()},
        "first": study.named("curves")[0],
    }  # fmt: skip


def _figure(study: Study, name: str) -> dict[str, Any]:
    """Return the preset of a figure: its operating point, mid-range where varied, and its axes."""
    spec, values = study.figures[name], study.parameters(name).given()
    preset: dict[str, Any] = {
        "group": "Figures", "title": f"{figure_title(name)}: {spec.title}", "words": spec.caption,
    }  # fmt: skip
    spans = {}
    for side, axis in zip("xy", reversed(spec.varied), strict=False):
        preset[side], value = axis.parameter, values[axis.parameter]
        if isinstance(axis, Family):
            values[axis.parameter] = axis.values[len(axis.values) // 2]
            continue
        spans[axis.parameter] = [axis.start, axis.stop]
        if value is None or not axis.start <= value <= axis.stop:
            values[axis.parameter] = 0.5 * (axis.start + axis.stop)
    return {**preset, "spans": spans, "values": values}


def _axes(study: Study) -> dict[str, tuple[float, float]]:
    """Return the range of each parameter over all figures that vary it."""
    ranges: dict[str, tuple[float, float]] = {}
    for spec in study.figures.values():
        for axis in reversed(spec.varied):
            low, high = ranges.get(axis.parameter, (math.inf, -math.inf))
            ranges[axis.parameter] = min(low, *axis.values), max(high, *axis.values)
    return ranges
