"""Files of designs: every setting of a search as a dataset, from which the search can go on."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from model.study.design import MEASURES, Design, Search
from model.study.devices.stated import unit_of
from model.study.io import NO_YES

_NAMES = {
    "share": ("share of the devices within the tolerances that go in from every start", "1"),
    "margin": ("distance of the nearest failing device, in tolerances", "1"),
    "time": ("longest alignment time within the tolerances", "s"),
    "contact_force": ("largest contact force within the tolerances", "N"),
    "tilt": ("largest tilt within the tolerances", "radian"),
    "vibration": ("share of the devices within the tolerances that need the vibration", "1"),
}


def design_dataset(search: Search, design: Design) -> xr.Dataset:
    """Return every setting of a search with its results, dim "candidate", in SI units."""
    tried = design.tried
    columns = {"share": tried.share, "margin": tried.margin, **tried.measures}
    variables: dict[str, Any] = {
        name: ("candidate", values, {"long_name": _NAMES[name][0], "units": _NAMES[name][1]})
        for name, values in columns.items()
    }
    for name, values in tried.settings.items():
        attributes = {"long_name": f"setting: {name}", "units": unit_of(name)}
        variables[f"setting_{name}"] = ("candidate", values, attributes)
    front = np.isin(np.arange(tried.share.size), design.front).astype(np.int8)
    words = {"long_name": "whether the setting is on the front of time and margin", **NO_YES}
    variables["front"] = ("candidate", front, words)
    metadata: dict[str, Any] = {
        "title": "Settings of a device: yield, margin and time",
        "summary": f"{tried.share.size} settings of {search.stated.source.name} that a search has "
        "tried, each judged by devices within and beyond the tolerances.",
        "identity": search.identity,
        "free": list(search.stated.free),
        "recommended": design.best,
    }
    return xr.Dataset(variables, attrs=metadata)


def known_in(path: Path, search: Search) -> dict[tuple[float, ...], tuple[float, ...]]:
    """Return ``Search.known`` from the file of an earlier part of the same search.

    Empty for the file of another search.

    Raises:
        ValueError: it is no file of a search, or an earlier version's.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4") as stored:
            return known_of(stored.load(), search)
    except (OSError, ValueError, RuntimeError, LookupError) as error:
        raise ValueError(
            f"--out {path}: is no file of this version's design ({error}): choose another name, "
            "or delete it"
        ) from None


def known_of(dataset: xr.Dataset, search: Search) -> dict[tuple[float, ...], tuple[float, ...]]:
    """Return ``Search.known`` from the dataset of an earlier part of the same search.

    Empty for the dataset of another search.

    Raises:
        KeyError: it is no dataset of a search.
    """
    if dataset.attrs["identity"] != search.identity:
        return {}
    keys = np.stack([dataset[f"setting_{name}"].values for name in search.stated.free], axis=1)
    rows = np.stack([dataset[name].values for name in ("share", "margin", *MEASURES)], axis=1)
    pairs = zip(keys.tolist(), rows.tolist(), strict=True)
    return {tuple(key): tuple(row) for key, row in pairs}
