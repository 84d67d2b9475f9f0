"""The page of a device that ``vibralign assess --sheet`` writes."""

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import xarray as xr

from model.runs.settings import Settings
from model.runs.simulate import simulate_once
from model.sweeps.files import write_text
from model.sweeps.settings import Ensemble, RunSettings
from model.sweeps.sweep import merge, run
from model.sweeps.version import version
from vibralign.answers.assess import Assessment
from vibralign.answers.assumptions import source_words
from vibralign.answers.leeways import ADDED, moved
from vibralign.answers.maps import QuantityAxis, in_every_case, map_of
from vibralign.answers.sheet import deciding
from vibralign.device import StatedDevice
from vibralign.device.instead import name_in
from vibralign.doubts import DoubtWarning
from vibralign.plots.device_sheet import render

_AXES = ("tilt_stiffness", "press_force")  # of the map, where no two quantities decide
_SPAN = 0.25, 2.5  # ends of an axis over the value, where the file states no range
_STEPS = 10  # of a scan, to either side, where a value may be 0
_COUNT = 33  # values along each side of the map
_TOLERANCE = 1e-7  # least local error of a step


def write_sheet(
    path: Path,
    stated: StatedDevice,
    verdict: tuple[str, bool],
    groups: Mapping[str, Sequence[str]],
    result: Assessment,
    settings: Settings,
) -> None:
    """Write the page of an assessed device: what ``assess`` prints, a map and a run.

    ``verdict`` is the headline, and whether it is good; ``groups`` are printed lines by title.
    """
    settings = replace(settings, tolerance=max(settings.tolerance, _TOLERANCE))
    lowered = stated.lowered(result.worst)
    dataset = _map(stated, result, settings)
    made_by = f"{source_words(stated)}; vibralign {version()}"
    course = simulate_once(stated.parameters, settings)
    write_text(render(lowered, verdict, groups, course, dataset, made_by), path)


def _map(stated: StatedDevice, result: Assessment, settings: Settings) -> xr.Dataset:
    """Return a map over what is free, then over what decides; no warnings on its far ends."""
    usual = [name_in(stated.quantities, name) for name in _AXES]
    names = dict.fromkeys([*stated.free, *deciding(result), *usual])
    x, y = (_axis(stated, name, stated.free.get(name)) for name in [*names][:2])
    ensemble, cores = Ensemble(), os.cpu_count() or 1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DoubtWarning)
        lowered = stated.lowered(result.worst)
        sweep = map_of(lowered, RunSettings.of(settings), (x, y), ensemble)
    title = f"What goes in, over {x.parameter} and {y.parameter}"
    found = merge(sweep, title, [run(sweep, cores=cores)])
    return in_every_case(found, stated, settings, ensemble, cores)


def _axis(stated: StatedDevice, name: str, range_: tuple[float, float] | None) -> QuantityAxis:
    """Return an axis of the map, in SI units."""
    value = {**stated.values, **stated.quantities}[name]
    low, high = range_ or (value * _SPAN[0], value * _SPAN[1])
    if name in ADDED:
        low, high = (moved(name, value, steps) for steps in (-_STEPS, _STEPS))
    return QuantityAxis(parameter=name, start=low, stop=high, count=_COUNT)
