"""Files of designs: every setting of a search as a dataset."""

from typing import Any

import numpy as np
import xarray as xr

from model.sweeps.io import NO_YES
from vibralign.answers.design import Design
from vibralign.answers.yields import CONFIDENCE
from vibralign.device import StatedDevice
from vibralign.device.limits import LIMITS
from vibralign.device.stated import unit_of

_NAMES = {
    "time": ("longest time until alignment within the tolerances, of the runs that go in", "s"),
    "contact_force": ("largest contact force within the tolerances", "N"),
    "tilt": ("largest tilt within the tolerances", "radian"),
    "vibration": ("share of the devices within the tolerances that need the vibration", "1"),
    "share": ("share of the devices within the tolerances that go in from every start", "1"),
    "margin": ("distance of the nearest failing device, in tolerances", "1"),
    "within": ("whether all devices go in and all limits are kept", "1"),
    "devices": ("number of devices by which the setting was checked; 0 if it was not", "1"),
    "going_in": ("number of these that go in from every start", "1"),
    "acceleration": ("largest acceleration of the vibrator within the tolerances", "m s-2"),
    "stroke": ("largest stroke of the vibrator within the tolerances", "m"),
}


def design_dataset(stated: StatedDevice, design: Design) -> xr.Dataset:
    """Return every setting of a search with its results, dim "candidate", in SI units.

    The results of a check stand in place of those of the quick trial.
    """
    tried, numbers = design.tried, range(design.tried.share.size)
    columns: dict[str, Any] = {**tried.measures, "share": tried.share, "margin": tried.margin}
    for name in ("devices", "going_in"):
        counts = [getattr(design.checks.get(i), name, 0) for i in numbers]
        columns[name] = np.array(counts, dtype=np.int32)
    columns["within"] = tried.keeps(design.limits).astype(np.int8)
    variables: dict[str, Any] = {
        name: ("candidate", columns[name], {"long_name": words, "units": unit})
        for name, (words, unit) in _NAMES.items()
    }
    variables["within"][2].update(NO_YES)
    for name in (each for each in LIMITS if each in design.limits):
        variables[name][2]["limit"] = design.limits[name]
    for name, values in tried.settings.items():
        attributes = {"long_name": f"setting: {name}", "units": unit_of(name)}
        variables[f"setting_{name}"] = ("candidate", values, attributes)
    metadata: dict[str, Any] = {
        "title": "Settings of a device: yield, margin and time",
        "summary": f"{len(numbers)} settings of {stated.source.name} that a search has tried, each "
        "by devices within and beyond the tolerances.",
        "free": list(stated.free),
        "recommended": design.best,
        "feasible": int(design.feasible),
        "limiting": [f"{kind} of {name}" for kind, name, _ in design.limiting],
        "yield_interval": design.interval,
        "yield_confidence": CONFIDENCE,
    }
    return xr.Dataset(variables, attrs=metadata)
