"""The sheet of a device that ``vibralign assess --sheet`` writes."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from model.runs.settings import Settings
from model.runs.simulate import simulate_once
from model.sweeps.files import write_text
from model.sweeps.settings import Ensemble, RunSettings
from model.sweeps.sweep import merge, run
from model.sweeps.version import version
from vibralign.answers.assumptions import source_words
from vibralign.answers.maps import QuantityAxis, in_every_case, map_of
from vibralign.device import StatedDevice
from vibralign.plots.device_sheet import render

_AXES = ("tilt_stiffness", "press_force")  # of the map, where the file frees no two quantities
_SPAN = 2.5  # an axis is value / _SPAN to value * _SPAN, where the file states no range
_COUNT = 33  # values along each side of the map
_TOLERANCE = 1e-7  # least local error of a step


def write_sheet(
    path: Path,
    stated: StatedDevice,
    verdict: tuple[str, bool],
    groups: Mapping[str, Sequence[str]],
    settings: Settings,
) -> None:
    """Write the sheet of an assessed device: what ``assess`` prints, a map and a run.

    ``verdict`` is the headline, and whether it is good; ``groups`` are printed lines by title,
    such as "Verdict" and "Leeways".
    """
    settings = replace(settings, tolerance=max(settings.tolerance, _TOLERANCE))
    names = dict.fromkeys((*stated.free, *_AXES))
    x, y = (_axis(stated, name) for name in list(names)[:2])
    ensemble, cores = Ensemble(), os.cpu_count() or 1
    sweep = map_of(stated, RunSettings.of(settings), (x, y), ensemble)
    title = f"Area of stable alignment over {x.parameter} and {y.parameter}"
    dataset = merge(sweep, title, [run(sweep, cores=cores)])
    dataset = in_every_case(dataset, stated, settings, ensemble, cores)
    made_by = f"{source_words(stated)}; vibralign {version()}"
    course = simulate_once(stated.parameters, settings)
    write_text(render(stated, verdict, groups, course, dataset, made_by), path)


def _axis(stated: StatedDevice, name: str) -> QuantityAxis:
    """Return an axis of the map, in SI units."""
    value = {**stated.values, **stated.quantities}[name]
    low, high = stated.free.get(name, (value / _SPAN, value * _SPAN))
    return QuantityAxis(parameter=name, start=low, stop=high, count=_COUNT)
