"""Many devices at once: those of a file with some quantities changed."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import FIELDS, Batch, Parameters
from model.physics.units import Units
from model.study.devices.stated import StatedDevice

Values = Mapping[str, NDArray[np.float64]]
"""Quantities that vary together, each of shape (n,)."""


def devices_of(stated: StatedDevice, values: Values) -> tuple[Batch, list[Units]]:
    """Return parameters and units of the devices with these quantities in SI units.

    A value that is the device's own is no change: what is computed from others still is.

    Raises:
        ValueError: a quantity outside its rule.
    """
    nothing_follows = stated.materials is None and "restitution" not in stated.quantities
    if nothing_follows and all(name in FIELDS for name in values):
        units = stated.units
        scaled = {name: v / units.of(FIELDS[name].quantity) for name, v in values.items()}
        batch = Batch.of(stated.parameters, **scaled)
        return batch, [units] * len(batch)
    own = {**stated.values, **stated.quantities}
    rows = zip(*(column.tolist() for column in values.values()), strict=True)
    named = (zip(values, row, strict=True) for row in rows)
    each = [stated.at({name: v for name, v in row if v != own.get(name)}) for row in named]
    return Batch.stack([one.parameters for one in each]), [one.units for one in each]


def batch_of(device: Parameters | StatedDevice, values: Values) -> Batch:
    """Return the parameters of devices with these values."""
    if isinstance(device, Parameters):
        return Batch.of(device, **values)
    return devices_of(device, values)[0]
