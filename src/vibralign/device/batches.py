"""Many devices at once: those of a file with some quantities changed."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import FIELDS, Batch
from model.physics.units import UNITS, Units, scales
from model.runs.settings import Settings
from vibralign.device.approach import SPEED, SUDDEN
from vibralign.device.instead import INSTEAD
from vibralign.device.mouth import MOUTH, as_parameters
from vibralign.device.stated import StatedDevice

_ALONE = {"frequency", "friction", "phase"}  # of which no other quantity follows

_COMPUTED = {*INSTEAD, "restitution", "fixture_stiffness"}  # from which others follow

Values = Mapping[str, NDArray[np.float64]]
"""Quantities that vary together, each of shape (n,)."""


def devices_of(stated: StatedDevice, values: Values) -> tuple[Batch, list[Units]]:
    """Return parameters and units of the devices with these quantities.

    A value that equals the device's own is no change: if it was computed from others, it still is.

    Raises:
        ValueError: a quantity outside its rule, or the speed of a sudden start.
    """
    if stated.sudden and SPEED in values:
        raise ValueError(f"{SPEED}: cannot vary with {SPEED}: {SUDDEN}")
    stated = stated.lowered()  # its speed is one in SI units
    size = len(next(iter(values.values()))) if values else 1
    si = _resolved(stated, values, size)
    columns = (np.broadcast_to(si[name], size).tolist() for name in UNITS)
    rows = [*zip(*columns, strict=True)]
    known = {row: Units(*row) for row in dict.fromkeys(rows)}
    units = [known[row] for row in rows]
    given = {name: column for name, column in si.items() if name in FIELDS}
    usual = Batch.stack([stated.parameters]).values
    batch = {name: np.full(size, usual[name]) for name in FIELDS}
    # The rules hold in any units: a refusal names the value in SI units.
    Batch({**batch, **{n: np.where(np.isnan(v), batch[n], v) for n, v in given.items()}}).checked(
        *given
    )
    for name, column in given.items():
        scaled = column / scales(units, FIELDS[name].quantity)
        batch[name] = np.where(np.isnan(column), batch[name], scaled)
    return Batch(batch), units


def _resolved(stated: StatedDevice, values: Values, size: int) -> dict[str, NDArray[np.float64]]:
    """Return ``stated.resolved`` of many devices, shape (n,) or (); NaN where nothing is stated."""
    own = {**stated.values, **stated.quantities}
    if not (stated.materials or stated.quantities.keys() & _COMPUTED) and (
        values.keys() <= {*FIELDS, *UNITS, *MOUTH}
    ):  # nothing is computed from others, but the start
        changed = {
            name: column
            if name in stated.quantities or name in MOUTH
            else np.where(column == own.get(name), np.nan, column)
            for name, column in values.items()
        }
        given = as_parameters({**stated.quantities, **changed})
        return {name: np.asarray(v) for name, v in given.items()}
    computing = {name: column for name, column in values.items() if name not in _ALONE}
    table = np.array([*computing.values()]).reshape(len(computing), size).T
    nodes, which = np.unique(table, axis=0, return_inverse=True)
    named = (zip(computing, row, strict=True) for row in nodes.tolist())
    each = [stated.resolved({name: v for name, v in row if v != own.get(name)}) for row in named]
    names = dict.fromkeys(name for one in each for name in one)
    found = {n: np.array([one.get(n, np.nan) for one in each]) for n in names}
    alone = {name: values[name] for name in values if name in _ALONE}
    return {name: column[which.reshape(-1)] for name, column in found.items()} | alone


def rows_of(batch: Batch, rows: Sequence[int] | NDArray[np.int64]) -> Batch:
    """Return the parameter sets in some rows of a batch."""
    return Batch({name: column[rows] for name, column in batch.values.items()})


def by_settings(
    stated: StatedDevice, settings: Settings, units: Sequence[Units]
) -> dict[Settings, list[int]]:
    """Return the rows of the devices with these units by the settings of their runs.

    A horizon or depth in SI units differs between devices of different units.
    """
    if stated.horizon is None and stated.insertion_depth is None:
        return {stated.run_settings(settings, stated.units): [*range(len(units))]}
    rows: dict[Settings, list[int]] = {}
    known: dict[int, Settings] = {}
    for row, each in enumerate(units):
        if id(each) not in known:
            known[id(each)] = stated.run_settings(settings, each)
        rows.setdefault(known[id(each)], []).append(row)
    return rows
