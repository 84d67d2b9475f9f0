"""Files of designs: every setting of a search as a dataset, from which the search can go on."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from model.device.design import Design, Search, Setting
from model.device.design_judges import MEASURES, Row, Thorough
from model.device.stated import unit_of
from model.device.yields import CONFIDENCE
from model.sweeps.io import NO_YES

_NAMES = {
    "share": ("share of the devices within the tolerances that go in from every start", "1"),
    "margin": ("distance of the nearest failing device, in tolerances", "1"),
    "time": ("longest time until alignment within the tolerances, of the runs that go in", "s"),
    "contact_force": ("largest contact force within the tolerances", "N"),
    "tilt": ("largest tilt within the tolerances", "radian"),
    "vibration": ("share of the devices within the tolerances that need the vibration", "1"),
}
_COLUMNS = ("share", "margin", *MEASURES)
_COUNTS = {
    "devices": "number of devices that assess draws, from every start; 0 if not judged so",
    "going_in": "number of these that go in from every start",
}


def design_dataset(search: Search, design: Design) -> xr.Dataset:
    """Return every setting of a search with its results, dim "candidate", in SI units.

    ``quick_*`` are the results of the quick judge. Those of the thorough one stand in their place
    where it was asked.
    """
    variables: dict[str, Any] = {}
    checked = [search.checked.get(key) for key in search.known]
    quick = list(search.known.values())
    rows = [row if each is None else each.row for row, each in zip(quick, checked, strict=True)]
    for prefix, of, judge in (("", rows, ""), ("quick_", quick, ", by the quick judge")):
        for name, column in zip(_COLUMNS, np.array(of).T, strict=True):
            words, unit = _NAMES[name]
            attributes = {"long_name": words + judge, "units": unit}
            variables[f"{prefix}{name}"] = ("candidate", column, attributes)
    for name, words in _COUNTS.items():
        column = np.array([getattr(each, name, 0) for each in checked], dtype=np.int32)
        variables[name] = ("candidate", column, {"long_name": words, "units": "1"})
    for name, values in design.tried.settings.items():
        attributes = {"long_name": f"setting: {name}", "units": unit_of(name)}
        variables[f"setting_{name}"] = ("candidate", values, attributes)
    front = np.isin(np.arange(design.tried.share.size), design.front).astype(np.int8)
    variables["front"] = (
        "candidate",
        front,
        {"long_name": "whether the setting is on the front of time and margin", **NO_YES},
    )
    metadata: dict[str, Any] = {
        "title": "Settings of a device: yield, margin and time",
        "summary": f"{len(search.known)} settings of {search.stated.source.name} that a search has "
        "tried, each judged by devices within and beyond the tolerances.",
        "identity": search.identity,
        "free": list(search.stated.free),
        "recommended": design.best,
        "yield_interval": design.interval,
        "yield_confidence": CONFIDENCE,
    }
    return xr.Dataset(variables, attrs=metadata)


def known_in(path: Path, search: Search) -> tuple[dict[Setting, Row], dict[Setting, Thorough]]:
    """Return ``known`` and ``checked`` from the file of an earlier part of the same search.

    Empty for the file of another search.

    Raises:
        ValueError: it is no file of a search, or an earlier version's.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4") as stored:
            return _known(stored.load(), search)
    except (OSError, ValueError, RuntimeError, LookupError) as error:
        raise ValueError(
            f"--out {path}: is no file of this version's design ({error}): choose another name, "
            "or delete it"
        ) from None


def _known(
    dataset: xr.Dataset, search: Search
) -> tuple[dict[Setting, Row], dict[Setting, Thorough]]:
    if dataset.attrs["identity"] != search.identity:
        return {}, {}

    def rows(*names: str) -> list[Any]:
        return np.stack([dataset[name].values for name in names], axis=1).tolist()

    keys = [tuple(key) for key in rows(*(f"setting_{name}" for name in search.stated.free))]
    quick = map(tuple, rows(*(f"quick_{name}" for name in _COLUMNS)))
    checked = {
        key: Thorough(tuple(row), *count)
        for key, row, count in zip(keys, rows(*_COLUMNS), rows(*_COUNTS), strict=True)
        # A setting that did not hold is judged anew, for its lessons.
        if count[0] == search.judges.devices
    }
    return dict(zip(keys, quick, strict=True)), checked
