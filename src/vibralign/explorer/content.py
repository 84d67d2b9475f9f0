"""Content of a page of the explorer: parameters, presets, words, and stored maps.

Values are in the page's units: dimensionless for the study, SI for a device.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.engines.results import TRACK_VARIABLES
from model.events.insertion import INSERTION
from model.events.outcomes import (
    OUTCOME_TEXT,
    REASON_TEXT,
    UNVIBRATED_TEXT,
    Outcome,
    Reason,
    remedy,
)
from model.physics.fields import Field
from model.physics.parameters import FIELDS, Parameters
from model.physics.quantities import ANGLE, FORCE, PLAIN, TIME, Quantity
from model.physics.units import UNITS, Units
from model.runs.settings import Settings
from model.show.assumptions import assumptions
from model.show.explorer.page import packed
from model.show.forces import until
from model.show.si import display, scale
from model.show.words import figure_title, symbol_parts
from model.study.config.figures import CURVES, HISTORIES, MAPS, Curves, Map
from model.study.config.study import Study
from model.sweeps.axes import Axis, Family

# Axes of the map where a preset states none.
_DEFAULT_AXES: dict[str, Any] = {"x": "tilt_stiffness", "y": "press_force"}
# Track variables of each panel over time, with their labels; "" stands for the symbol.
_PANELS: tuple[Mapping[str, str], ...] = (
    {"x": ""}, {"y": ""}, {"tilt": ""},
    {"contact_force": "n, under the part", "right_force": "right side", "side_force": "left side"},
)  # fmt: skip
_SMALL_ANGLE = 0.05  # rad, from the middle of a slider to its ends
_LEVELS = 254  # number of levels of a stored duration

_EVENT_WORDS: Mapping[str, str] = {
    "aligned": "the edge is past the corner: aligned",
    "corners_inside": "both bottom corners are inside the slot",
    "inserted": "deep enough: inserted",
    "right_edge_enters": "the part lands on the edge",
    "left_edge_enters": "the part lands on the far edge",
    "right_corner_touches": "the right corner meets its wall",
    "left_corner_touches": "the left corner meets its wall",
    "support_slip": "the slip on the right ends or turns",
    "side_slip": "the slip on the left ends or turns",
}
_CHANGES: Mapping[str, str] = {
    "load": "the load on {} vanishes: lift-off",
    "gap": "the gap at {} opens",
    "reload": "{} presses again",
    "end": "{} is at the end of its face",
}
_PLACES: Mapping[str, str] = {
    "face": "the edge",
    "corner": "the corner beside the slot",
    "side": "the left edge",
    "right_side": "the right edge",
    "right_wall": "the right corner",
    "left_wall": "the left corner",
}


def _event_words(name: str) -> str:
    """Return what an event means, or its name in words."""
    place, _, change = name.rpartition("_")
    if place in _PLACES and change in _CHANGES:
        return _CHANGES[change].format(_PLACES[place])
    return _EVENT_WORDS.get(name, name.replace("_", " "))


def _shown(units: Units | None, quantity: Quantity, value: float = 0.0) -> dict[str, Any]:
    """Return a quantity's powers of the units, its unit, and the unit in which it is shown.

    The unit shown suits ``value``, in the page's unit; if that is 0, one dimensionless unit.
    """
    powers = [quantity.length, quantity.time, quantity.force, quantity.factor]
    if units is None:
        unit = "rad" if quantity == ANGLE else ""
        return {"powers": powers, "si": unit, "unit": unit, "one": 1.0}
    unit, one = display(value or units.of(quantity), quantity)
    si = "" if quantity == PLAIN else quantity.unit
    return {"powers": powers, "si": si, "unit": unit, "one": one}


def _values(units: Units | None, parameters: Parameters) -> dict[str, float | None]:
    """Return the parameters in the page's units, after the units themselves."""
    if units is None:
        return parameters.given()
    return vars(units) | units.in_si(parameters).given()


def study_model(
    study: Study, interface: Mapping[str, Any], maps: Sequence[Path] = ()
) -> dict[str, Any]:
    """Return the content of the study's page.

    ``maps`` are the datasets of MAPS.
    """
    presets = {name: _figure(study, name) for name in sorted((*HISTORIES, *CURVES, *MAPS))}
    for name, case in study.precision.hard.cases.items():
        values = study.baseline.replace(**case.at).given()
        presets[f"case_{name}"] = {"group": "Hard cases", "title": case.title, "values": values}
    return {
        **_model(
            "vibralign explorer", study.baseline, None, study.settings.settings, interface,
            assumptions(study.baseline, study.settings.settings),
        ),
        "parameters": _parameters(study.baseline, None, [*study.operating_point], _axes(study)),
        "presets": {name: _DEFAULT_AXES | each for name, each in presets.items()},
        "first": CURVES[0],
        "maps": {name: _stored_map(study, name, of) for name, of in zip(MAPS, maps, strict=False)},
    }  # fmt: skip


# The options that a device's page was made with; the commands that it copies repeat them.
_NO_ORIGIN: Mapping[str, Any] = {
    "options": (),  # all except --set, quoted for a shell
    "sets": {},  # the --set options by name, likewise
    # Parameters that follow from other quantities of the device's file, with these quantities; the
    # page keeps their values while others change.
    "held": {},
    "horizon": None,  # latest time of the runs in s, None if it is in units of 1/p
}


def device_model(
    device: Parameters,
    units: Units | None,
    file: str,
    settings: Settings,
    interface: Mapping[str, Any],
    first: Sequence[str],
    origin: Mapping[str, Any] = _NO_ORIGIN,
    assumed: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, Any]:
    """Return the content of the page of a device, in SI units if it has ``units``.

    ``assumed`` is what its runs assume, in words by name.
    """
    preset = {
        **_DEFAULT_AXES, "group": "Device", "title": file or "the study's device",
        "words": _held_words(origin["held"]), "values": _values(units, device),
    }  # fmt: skip
    return {
        **_model(f"vibralign explorer: {file}", device, units, settings, interface, assumed),
        "origin": origin,
        "name": Path(file).stem or "device",
        "parameters": _parameters(device, units, first, {}),
        "presets": {"device": preset},
        "first": "device",
        "maps": {},
    }


def _model(
    title: str,
    baseline: Parameters,
    units: Units | None,
    settings: Settings,
    interface: Mapping[str, Any],
    assumed: Mapping[str, str],
) -> dict[str, Any]:
    """Return the content that every page has."""
    said = "; ".join(f"{name}: {words}" for name, words in assumed.items())
    inserts = "inserted" in interface["events"]  # as the page's engines do, whatever the settings
    return {
        "title": title,
        "footer": f"Made by vibralign. Tolerance {settings.tolerance:g}, one run without an "
        "estimate of its error; vibralign simulate gives that."
        + (f" Assumed as the page opens: {said}." if said else ""),
        "origin": _NO_ORIGIN,
        "name": "",
        "units": units is not None,
        "interface": interface,
        "control": dict(
            zip(interface["limits"], (settings.tolerance, *settings.control), strict=True)
        ),
        "baseline": _values(units, baseline),
        "outcomes": {int(each): text for each, text in OUTCOME_TEXT.items()},
        "reasons": {int(each): text for each, text in REASON_TEXT.items()},
        "remedies": {f"{o:d},{r:d}": remedy(o, r) for o, r in product(Outcome, Reason)},
        "events": [_event_words(each) for each in interface["events"]],
        "unvibrated": {int(each): text for each, text in UNVIBRATED_TEXT.items()},
        "panels": [_panel(panel, units) for panel in _PANELS],
        "time": _shown(units, TIME),
        "force": _shown(units, FORCE),
        "forces_known": until(replace(settings, scene=INSERTION) if inserts else settings),
    }


def _panel(panel: Mapping[str, str], units: Units | None) -> dict[str, Any]:
    curves = [
        {"name": name, "label": label or TRACK_VARIABLES[name].symbol}
        for name, label in panel.items()
    ]
    return {"curves": curves, **_shown(units, TRACK_VARIABLES[next(iter(panel))].quantity)}


def _held_words(held: Mapping[str, Sequence[str]]) -> str:
    """Say what stays as it is while other values change."""
    words = [
        f"{name.replace('_', ' ')} (from {sources[0]})" for name, sources in held.items() if sources
    ]
    return f"Held at the file's press force: {', '.join(words)}." if words else ""


# --- Parameters ---------------------------------------------------------------------------------


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


def _range(
    name: str, field: Field, values: Mapping[str, float | None], unit: float
) -> tuple[float, float]:
    """Return the range of a slider around a device's value."""
    value = values[field.derived] if values[name] is None and field.derived else values[name]
    assert value is not None  # noqa: S101 - derived parameters are derived from given ones
    if name == "phase":
        return 0.0, 2.0 * math.pi
    if field.quantity is ANGLE:
        return value - _SMALL_ANGLE, value + _SMALL_ANGLE
    size = abs(value) or unit
    if field.derived:
        return value - size, value + size
    return (0.0 if field.bound == ">= 0" or value == 0.0 else value / 5.0), 3.0 * size


def _parameters(
    device: Parameters,
    units: Units | None,
    first: Sequence[str],
    axes: Mapping[str, tuple[float, float]],
) -> list[dict[str, Any]]:
    """Return descriptions of the parameters for the page, those in ``first`` at the top."""
    values, described = _values(units, device), []
    for name in sorted(values, key=lambda each: (each in UNITS, each not in first)):
        field = (FIELDS | UNITS)[name]  # type: ignore[operator]
        letter, index = symbol_parts(field.symbol)
        least, most = axes.get(name) or _range(name, field, values, scale(units, field.quantity))
        described.append(
            {
                "name": name,
                "symbol": field.symbol,
                "letter": letter,
                "index": index,
                "words": field.description.partition(";")[0],
                "rule": field.rule,
                "bound": field.bound,
                "derived": field.derived or "",
                "least": least,
                "most": most,
                "first": name in (*first, "amplitude"),
                **_shown(units, field.quantity, values[field.derived or name] or 0.0),
            }
        )
    return described


# --- Presets and maps of the study --------------------------------------------------------------


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
    assert isinstance(spec, Map)  # noqa: S101 - one of MAPS
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
