"""Content of a page of the explorer: parameters, presets and words.

Values are in the page's units: SI for a device of a file, else dimensionless.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from model.engine.results import TRACK_VARIABLES
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
from model.physics.parameters import FIELDS
from model.physics.quantities import ANGLE, FORCE, PLAIN, TIME, Quantity
from model.physics.units import UNITS, Units
from model.runs.settings import Settings
from vibralign.answers.forces import until
from vibralign.answers.si import display, in_words_of, scale
from vibralign.device import StatedDevice
from vibralign.device.instead import SOURCES
from vibralign.device.mouth import MOUTH
from vibralign.plots.words import symbol_parts

FIRST = ("friction", "press_force", "tilt_stiffness", "frequency")  # sliders at the top
# Axes of the map where a preset states none.
DEFAULT_AXES: dict[str, Any] = {"x": "tilt_stiffness", "y": "press_force"}
# Track variables of each panel over time, with their labels; "" stands for the symbol.
_PANELS: tuple[Mapping[str, str], ...] = (
    {"x": ""}, {"y": ""}, {"tilt": ""},
    {"contact_force": "n, under the part", "right_force": "right side", "side_force": "left side"},
)  # fmt: skip
_SMALL_ANGLE = 0.05  # rad, from the middle of a slider to its ends

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


Values = Mapping[str, float | None]
"""Parameters, or quantities of a device in SI units, by name."""


def device_model(
    stated: StatedDevice,
    settings: Settings,
    interface: Mapping[str, Any],
    assumed: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, Any]:
    """Return the content of the page of a device, in SI units.

    ``assumed`` is what its runs assume, in words by name.
    """
    values, units, file = stated.values, stated.units, str(stated.source)
    preset = {
        **DEFAULT_AXES, "group": "Device", "title": file, "words": _held_words(stated),
        "values": values,
    }  # fmt: skip
    return {
        **page_model(f"vibralign explorer: {file}", values, units, settings, interface, assumed),
        "horizon": stated.horizon,
        "name": stated.source.stem,
        "parameters": described(values, units),
        "presets": {"device": preset},
        "first": "device",
    }


def page_model(
    title: str,
    baseline: Values,
    units: Units | None,
    settings: Settings,
    interface: Mapping[str, Any],
    assumed: Mapping[str, str],
) -> dict[str, Any]:
    """Return the content that every page has."""
    said = "; ".join(f"{name}: {words}" for name, words in assumed.items())
    shape = interface["shape"]

    def in_words(texts: Iterable[tuple[Any, str]]) -> dict[int, str]:
        return {int(each): in_words_of(shape, text) for each, text in texts}

    inserts = "inserted" in interface["events"]  # as the page's engines do, whatever the settings
    return {
        "title": title,
        "footer": f"Made by vibralign. Tolerance {settings.tolerance:g}, in maps "
        f"{max(settings.tolerance, 1e-8):g}. The error of the run is not estimated here; vibralign "
        "simulate does so." + (f" Assumed as the page opens: {said}." if said else ""),
        "horizon": None,  # latest time of the runs in s, None if it is in units of 1/p
        "name": "",
        "units": units is not None,
        "interface": interface,
        "control": dict(
            zip(interface["limits"], (settings.tolerance, *settings.control), strict=True)
        ),
        "baseline": baseline,
        "outcomes": in_words(OUTCOME_TEXT.items()),
        "reasons": in_words(REASON_TEXT.items()),
        "remedies": in_words((each, remedy(each, Reason.NONE)) for each in Outcome),
        "remedies_of_reasons": in_words(_remedies_of_reasons()),
        "events": [in_words_of(shape, _event_words(each)) for each in interface["events"]],
        "unvibrated": in_words(UNVIBRATED_TEXT.items()),
        "panels": [_panel(panel, units) for panel in _PANELS],
        "time": _shown(units, TIME),
        "force": _shown(units, FORCE),
        "on_flank": int(Reason.ON_FLANK),
        "forces_known": until(replace(settings, scene=INSERTION) if inserts else settings),
    }


def _remedies_of_reasons() -> list[tuple[Reason, str]]:
    """Return the remedies of reasons that have one whatever the outcome."""
    usual = remedy(Outcome.LEFT_SCENE, Reason.NONE)
    each = [(reason, remedy(Outcome.LEFT_SCENE, reason)) for reason in Reason]
    return [(reason, words) for reason, words in each if words != usual]


def _panel(panel: Mapping[str, str], units: Units | None) -> dict[str, Any]:
    curves = [
        {"name": name, "label": label or TRACK_VARIABLES[name].symbol}
        for name, label in panel.items()
    ]
    return {"curves": curves, **_shown(units, TRACK_VARIABLES[next(iter(panel))].quantity)}


def _held_words(stated: StatedDevice) -> str:
    """Say which parameters, computed from others, stay as they are while other values change."""
    present = {*stated.quantities, *(() if stated.materials is None else ("materials",))}
    words = [
        f"{name.replace('_', ' ')} (from {source})"
        for name, sources in SOURCES.items()
        for source in [each for each in sources if each in present][:1]
        if name not in present
    ]
    return f"Held at the file's press force: {', '.join(words)}." if words else ""


# --- Parameters ---------------------------------------------------------------------------------


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


def described(
    values: Values,
    units: Units | None,
    first: Sequence[str] = FIRST,
    axes: Mapping[str, tuple[float, float]] = MappingProxyType({}),
) -> list[dict[str, Any]]:
    """Return descriptions of the parameters for the page, those in ``first`` at the top.

    ``axes`` are the ranges of sliders, by name; others follow from the device.
    """
    rows = []
    for name in sorted(values, key=lambda each: (each in UNITS, each not in first)):
        field = MOUTH[name] if units and name in MOUTH else (FIELDS | UNITS)[name]  # type: ignore[operator]
        letter, index = symbol_parts(field.symbol)
        least, most = axes.get(name) or _range(name, field, values, scale(units, field.quantity))
        rows.append(
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
    return rows
