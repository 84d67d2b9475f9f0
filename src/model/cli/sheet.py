"""The sheet of a device that ``vibralign assess --sheet`` writes."""

import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlencode

from model.physics.parameters import FIELDS
from model.runs.settings import Settings
from model.runs.simulate import simulate_once
from model.show.device_sheet import Sheet, render
from model.show.explorer.content import Scales
from model.study.config import RunSettings, Span, Study
from model.study.devices import StatedDevice, load_device
from model.study.files import atomic_write
from model.study.maps.compute import MapNodes
from model.study.maps.dataset import in_si, map_dataset
from model.study.maps.plan import plan_of
from model.study.version import version

_AXES = ("tilt_stiffness", "press_force")  # of the map, where the file frees no two quantities
_SPAN = 2.5  # an axis is value / _SPAN to value * _SPAN, where the file states no range
_RESOLUTION = 32
_TOLERANCE = 1e-7  # least local error of a step


def write_sheet(
    path: Path,
    stated: StatedDevice,
    groups: Mapping[str, Sequence[str]],
    study: Study,
    settings: Settings,
) -> None:
    """Write the sheet of an assessed device: what ``assess`` prints, a map and a run.

    Args:
        path: file to write.
        stated: the device.
        groups: printed lines by their group: "Verdict", "Leeways" and perhaps "Yield".
        study: the study, for the starts of the map.
        settings: settings of the runs.

    Raises:
        OSError: the file cannot be written.
    """
    settings = replace(settings, tolerance=max(settings.tolerance, _TOLERANCE))
    device = stated.device
    names = [name for name in (*stated.free, *_AXES) if name in FIELDS]
    x, y = (_span(stated, name) for name in list(dict.fromkeys(names))[:2])
    starts = study.maps.ensemble.model_copy(update={"every": 1})
    run_settings, cores = RunSettings.of(settings), os.cpu_count() or 1
    plan = plan_of("map", device.parameters, run_settings, (x, y), _RESOLUTION, starts)
    title = f"Area of stable alignment over {x.parameter} and {y.parameter}"
    dataset = map_dataset(plan, MapNodes(plan), title, cores=cores)
    verdict = re.sub(r"^((not )?reliable)\s+", r"\1: ", groups["Verdict"][1])
    good = verdict.startswith("reliable")
    if "Yield" in groups:
        share = " ".join(groups["Yield"][0].split()).partition(":")[0]
        verdict, good = f"{verdict}; {share}", good and share.startswith("yield 100 %")
    sheet = Sheet(
        stated=stated,
        verdict=verdict,
        reliable=good,
        lines=[("Verdict", groups["Verdict"][2:]), *list(groups.items())[1:]],
        run=simulate_once(device.parameters, settings),
        map_data=in_si(dataset, device.units),
        made_by=f"vibralign {version()}",
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
    units, parameters = load_device(stated.source, {})
    own = json.dumps(Scales(units).values(parameters))
    if f'"baseline": {own}' not in page.read_text(encoding="utf-8", errors="replace"):
        return None
    quantities = stated.resolved({})
    changes = {name: quantities[name] for name in stated.changes if name in FIELDS}
    return f"{page.name}#{urlencode(changes)}" if changes else page.name


def _span(stated: StatedDevice, name: str) -> Span:
    """Return the range of an axis of the map, dimensionless."""
    value, unit = stated.resolved({})[name], stated.device.units.of(FIELDS[name].quantity)
    low, high = stated.free.get(name, (value / _SPAN, value * _SPAN))
    return Span(parameter=name, start=low / unit, stop=high / unit)
