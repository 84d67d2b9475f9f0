"""The sheet of a device that ``vibralign assess --sheet`` writes."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlencode

from model.physics.parameters import FIELDS
from model.runs.settings import Settings
from model.runs.simulate import simulate_once
from model.show.assumptions import changes_words
from model.show.device_sheet import Sheet, render
from model.show.explorer.content import Scales
from model.study.config import RunSettings, Study
from model.study.devices import StatedDevice, load_device
from model.study.files import atomic_write
from model.study.maps.compute import MapNodes
from model.study.maps.dataset import map_dataset
from model.study.maps.plan import QuantitySpan, plan_of
from model.study.version import version

_AXES = ("tilt_stiffness", "press_force")  # of the map, where the file frees no two quantities
_SPAN = 2.5  # an axis is value / _SPAN to value * _SPAN, where the file states no range
_RESOLUTION = 32
_TOLERANCE = 1e-7  # least local error of a step


def write_sheet(
    path: Path,
    stated: StatedDevice,
    verdict: tuple[str, bool],
    groups: Mapping[str, Sequence[str]],
    study: Study,
    settings: Settings,
) -> None:
    """Write the sheet of an assessed device: what ``assess`` prints, a map and a run.

    Args:
        path: file to write.
        stated: the device.
        verdict: the headline, and whether it is good.
        groups: printed lines by their group, such as "Verdict" and "Leeways".
        study: the study, for the starts of the map.
        settings: settings of the runs.

    Raises:
        OSError: the file cannot be written.
    """
    settings = replace(settings, tolerance=max(settings.tolerance, _TOLERANCE))
    device = stated.device
    names = dict.fromkeys((*stated.free, *_AXES))
    x, y = (_span(stated, name) for name in list(names)[:2])
    starts = study.maps.ensemble.model_copy(update={"every": 1})
    run_settings, cores = RunSettings.of(settings), os.cpu_count() or 1
    spans, parameters = (x, y), device.parameters
    plan = plan_of("map", parameters, run_settings, spans, _RESOLUTION, starts, stated)
    title = f"Area of stable alignment over {x.parameter} and {y.parameter}"
    dataset = map_dataset(plan, MapNodes(plan), title, cores=cores)
    words, good = verdict
    changes = changes_words(stated)
    sheet = Sheet(
        stated=stated,
        verdict=words,
        reliable=good,
        lines=list(groups.items()),
        run=simulate_once(device.parameters, settings),
        map_data=dataset,
        made_by=f"{stated.source}{changes and f', with {changes}'}; vibralign {version()}",
        explorer=_explorer(path, stated),
    )
    with atomic_write(path) as part:
        part.write_text(render(sheet), encoding="utf-8")


def _explorer(path: Path, stated: StatedDevice) -> str | None:
    """Return the address that opens the device in DEVICE.html, its explorer beside the sheet.

    None if there is no such page, or it is of another device.
    """
    page = path.with_name(f"{stated.source.stem}.html")
    if page.name == path.name or not page.exists():
        return None
    file = load_device(stated.source)
    own = json.dumps(Scales(file.units).values(file.parameters))
    if f'"baseline": {own}' not in page.read_text(encoding="utf-8", errors="replace"):
        return None
    quantities = stated.resolved({})
    changes = {name: quantities[name] for name in stated.changes if name in FIELDS}
    return f"{page.name}#{urlencode(changes)}" if changes else page.name


def _span(stated: StatedDevice, name: str) -> QuantitySpan:
    """Return the range of an axis of the map, in SI units."""
    value = {**stated.values, **stated.quantities}[name]
    low, high = stated.free.get(name, (value / _SPAN, value * _SPAN))
    return QuantitySpan(parameter=name, start=low, stop=high)
