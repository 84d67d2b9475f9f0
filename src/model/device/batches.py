"""Many devices at once: those of a file with some quantities changed."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from model.device.base import CENTRE
from model.device.stated import StatedDevice
from model.physics.parameters import FIELDS, Batch, Parameters
from model.physics.units import Units
from model.runs.settings import Settings

Values = Mapping[str, NDArray[np.float64]]
"""Quantities that vary together, each of shape (n,)."""


def devices_of(stated: Parameters | StatedDevice, values: Values) -> tuple[Batch, list[Units]]:
    """Return parameters of the devices with these quantities, and units of those in SI units.

    A value that is the device's own is no change: what is computed from others still is.

    Raises:
        ValueError: a quantity outside its rule.
    """
    if isinstance(stated, Parameters):
        return Batch.of(stated, **values), []
    nothing_follows = stated.materials is None and not {"restitution", CENTRE} & {
        *stated.quantities
    }
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


def rows_of(batch: Batch, rows: Sequence[int] | NDArray[np.int64]) -> Batch:
    """Return the parameter sets in some rows of a batch."""
    return Batch({name: column[rows] for name, column in batch.values.items()})


def by_settings(
    stated: StatedDevice, settings: Settings, units: Sequence[Units]
) -> dict[Settings, list[int]]:
    """Return the rows of the devices with these units by the settings of their runs.

    A horizon or depth in SI units differs between devices of different units.
    """
    rows: dict[Settings, list[int]] = {}
    for row, each in enumerate(units):
        rows.setdefault(stated.run_settings(settings, each), []).append(row)
    return rows
