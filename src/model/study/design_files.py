"""Files of designs: every setting of a search as a dataset, from which the search can go on."""

from typing import Any

import numpy as np
import xarray as xr

from model.physics.parameters import FIELDS
from model.study.design import MEASURES, Design, Search

_NAMES = {
    "share": ("share of the devices within the tolerances that go in from every start", "1"),
    "margin": ("distance of the nearest failing device, in tolerances", "1"),
    "time": ("longest alignment time within the tolerances", "s"),
    "contact_force": ("largest contact force within the tolerances", "N"),
    "tilt": ("largest tilt within the tolerances", "rad"),
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
        unit = FIELDS[name].quantity.unit if name in FIELDS else ""
        attributes = {"long_name": f"setting: {name}", "units": unit}
        variables[f"setting_{name}"] = ("candidate", values, attributes)
    front = np.isin(np.arange(tried.share.size), design.front).astype(np.int8)
    variables["front"] = ("candidate", front, {"long_name": "1 on the front of time and margin"})
    metadata: dict[str, Any] = {
        "title": "Settings of a device: yield, margin and time",
        "identity": search.identity,
        "free": list(search.stated.free),
        "recommended": design.best,
    }
    return xr.Dataset(variables, attrs=metadata)


def known_of(dataset: xr.Dataset, search: Search) -> dict[tuple[float, ...], tuple[float, ...]]:
    """Return ``Search.known`` from the dataset of an earlier part of the same search.

    Empty for the dataset of another search.
    """
    if dataset.attrs.get("identity") != search.identity:
        return {}
    keys = np.stack([dataset[f"setting_{name}"].values for name in search.stated.free], axis=1)
    rows = np.stack([dataset[name].values for name in ("share", "margin", *MEASURES)], axis=1)
    pairs = zip(keys.tolist(), rows.tolist(), strict=True)
    return {tuple(key): tuple(row) for key, row in pairs}
