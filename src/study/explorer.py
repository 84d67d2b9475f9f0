"""Content of the study's explorer: its device, figures and hard cases as presets, stored maps."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.sweeps.axes import Axis, Family
from study.config.figures import Curves, Map
from study.config.study import Study
from vibralign.answers.assumptions import assumptions
from vibralign.explorer.content import DEFAULT_AXES, described, page_model
from vibralign.explorer.page import packed
from vibralign.plots.words import figure_title

_LEVELS = 254  # number of levels of a stored duration


def study_model(
    study: Study, interface: Mapping[str, Any], maps: Sequence[Path] = ()
) -> dict[str, Any]:
    """Return the content of the study's page.

    ``maps`` are the datasets of the figures that are maps, in order.
    """
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
        "maps": {
            name: _stored_map(study, name, of)
            for name, of in zip(study.named("map"), maps, strict=False)
        },
    }  # fmt: skip


def _figure(study: Study, name: str) -> dict[str, Any]:
    """Return the preset of a figure: its operating point, mid-range where varied, and its axes."""
    spec, values = study.figures[name], study.parameters(name).given()
    preset: dict[str, Any] = {
        "group": "Figures", "title": f"{figure_title(name)}: {spec.title}", "words": spec.caption,
    }  # fmt: skip
    spans = {}
    for side, axis in zip("xy", _varied(spec), strict=False):
        preset[side], value = axis.parameter, values[axis.parameter]
        if isinstance(axis, Family):
            values[axis.parameter] = axis.values[len(axis.values) // 2]
            continue
        spans[axis.parameter] = [axis.start, axis.stop]
        if value is None or not axis.start <= value <= axis.stop:
            values[axis.parameter] = 0.5 * (axis.start + axis.stop)
    return {**preset, "spans": spans, "values": values}


def _stored_map(study: Study, name: str, data: Path) -> dict[str, Any]:
    """Return a figure's map: durations in levels of equal ratio, and where it is reliable."""
    # Imported here: xarray, for the study only.
    from model.sweeps.io import read_dataset  # noqa: PLC0415
    from model.sweeps.sweep import START  # noqa: PLC0415

    spec, dataset = study.figures[name], read_dataset(data)
    assert isinstance(spec, Map)  # noqa: S101 - a map
    tau = _square(dataset["tau_align"].values)
    known = tau[~np.isnan(tau)]
    least, most = (float(known.min()), float(known.max())) if known.size else (1.0, 1.0)
    steps = math.log(most / least) or 1.0
    share = np.nan_to_num(np.log(tau / least) / steps, nan=-1.0)
    nodes = {dim: dataset[dim.removeprefix(START)] for dim in map(str, dataset["reliable"].dims)}
    reliable = dataset["reliable"].sel(nodes, method="nearest")
    levels = np.where(share < 0.0, 0, 1 + np.rint(share * _LEVELS)).astype(np.uint8)
    return {
        "x": spec.x.parameter, "y": spec.y.parameter,
        "xs": [spec.x.start, spec.x.stop], "ys": [spec.y.start, spec.y.stop],
        "cells": len(tau), "least": least, "most": most,
        "duration": packed(levels.tobytes()), "values": study.parameters(name).given(),
        "reliable": packed(_square(reliable.values).astype(np.uint8).tobytes()),
    }  # fmt: skip


def _square(values: NDArray[Any]) -> NDArray[Any]:
    """Resample to a square, with as many rows as columns, by nearest values."""
    rows = np.rint(np.linspace(0, len(values) - 1, values.shape[1])).astype(int)
    return values[rows]


def _varied(spec: object) -> tuple[Axis | Family, ...]:
    """Return what a figure varies: along x, and along y or from curve to curve."""
    if isinstance(spec, Curves):
        return spec.swept, spec.family
    return (spec.x, spec.y) if isinstance(spec, Map) else ()


def _axes(study: Study) -> dict[str, tuple[float, float]]:
    """Return the range of each parameter over all figures that vary it."""
    ranges: dict[str, tuple[float, float]] = {}
    for spec in study.figures.values():
        for axis in _varied(spec):
            low, high = ranges.get(axis.parameter, (math.inf, -math.inf))
            ranges[axis.parameter] = min(low, *axis.values), max(high, *axis.values)
    return ranges
