"""Studies of devices: one call from devices and ranges with units to a dataset in SI units."""

import json
import numbers
from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.engine.results import RESULTS, VALUE_TYPES
from model.events.outcomes import Outcome
from model.physics.quantities import ANGLE, PLAIN
from model.physics.tables import vars_of
from model.physics.units import scales
from model.runs.align import align
from model.runs.settings import Settings
from model.sweeps.io import described, result_attributes, summary_of
from vibralign.answers.assumptions import (
    as_attribute,
    assumptions_with,
    at_corners,
    source_words,
)
from vibralign.answers.maps import corners_of, held_at_corners, quantity_attributes
from vibralign.device.amounts import read_values
from vibralign.device.batches import by_settings, devices_of, rows_of
from vibralign.device.mouth import judged
from vibralign.device.quantities import unit_of
from vibralign.device.runs import IN_SI, AnyDevice, listed, stated_of, with_changes
from vibralign.device.stated import StatedDevice

Axes = Mapping[str, NDArray[np.float64]]

_OF_INSERTION = ("tau_inserted", "insertion_error")


def sweep(
    device: AnyDevice | Iterable[AnyDevice],
    settings: Settings | None = None,
    *,
    points: int = 101,
    cores: int | None = None,
    **axes: Any,
) -> xr.Dataset:
    """Run a device over a grid of its quantities and return all results as a dataset.

    ``sweep("peg.yaml", frequency="20 to 150 Hz", press_force=[8, 10, "12 N"])`` has the dimensions
    frequency and press_force. Its variables are the results of ``align`` in SI units: times with
    their errors, outcomes as CF flags, forces; and the quantities that are held. Its attributes
    state the device, its shape, the version and what the answers assume.

    Args:
        device: of a file, as ``simulate`` takes it; a list has its own dimension, ``device``.
        settings: settings of the runs; the defaults of ``Settings`` if None.
        points: number of values, >= 2, of an axis that is given as a range.
        cores: number of threads, >= 1; all cores by default.
        **axes: quantities by name, each given as a range in a text ("20..150 Hz"), as its values,
            or as one value for all runs. Numbers are in SI units, texts have units. Also fields of
            ``Settings``, as for ``simulate``.

    Raises:
        TypeError: no device, a dimensionless one, or a setting of the wrong type.
        ValueError: an unknown name, or a value that is no amount or breaks its rule.
    """
    names = {each.name for each in fields(Settings)}
    changes = {name: value for name, value in axes.items() if name in names}
    varied = {name: value for name, value in axes.items() if name not in names}
    devices = [with_changes(each, settings, changes) for each in map(stated_of, listed(device))]
    if not devices:
        raise ValueError("no device: give at least one")
    if not (isinstance(points, numbers.Integral) and points >= 2):
        raise ValueError(f"points = {points!r}: must be a whole number >= 2")
    for name in changes.keys() & IN_SI.keys():
        if not isinstance(changes[name], str):
            rule = f"must be a text with a unit, such as '1 {IN_SI[name].unit}'"
            raise ValueError(f"{name} = {changes[name]!r}: {rule}")  # noqa: TRY004 - by its value
    units = {name: unit_of(name) for name in varied}
    values = {name: read_values(name, v, units[name], int(points)) for name, v in varied.items()}
    for one, _ in devices:
        _check(one, values)
        for each in corners_of(_lists(values)) if values else ():
            one.warn(each)
    parts = [_study(one, own, values, cores) for one, own in devices]
    if not isinstance(device, (StatedDevice, str)) and isinstance(device, Iterable):
        return described(_side_by_side(parts))
    return described(parts[0])


def _side_by_side(parts: list[xr.Dataset]) -> xr.Dataset:
    """Return the datasets of several devices as one, with the dimension ``device``.

    An attribute that differs between the devices is a variable of its name.
    """
    names = xr.Variable("device", [each.attrs["device"] for each in parts])
    found = xr.concat(
        parts, names, data_vars="all", coords="minimal", compat="override", join="exact",
        combine_attrs="drop_conflicts",
    )  # fmt: skip
    differing = {name for each in parts for name in each.attrs} - set(found.attrs)
    own = {name: ("device", [each.attrs[name] for each in parts])
           for name in sorted(differing - {"device", "title"})}  # fmt: skip
    title = f"Study of {len(parts)} devices"
    return found.assign(own).assign_coords(device=names).assign_attrs(title=title)


def _lists(axes: Axes) -> dict[str, list[float]]:
    return {name: np.atleast_1d(values).tolist() for name, values in axes.items()}


def _check(device: StatedDevice, axes: Axes) -> None:
    """Refuse values that no file may state, of every axis and at the corners of the grid."""
    lists = _lists(axes)
    first = {name: values[0] for name, values in lists.items()}
    alone = [first | {name: value} for name, values in lists.items() for value in values]
    for each in [*corners_of(lists), *alone]:
        device.admitted(each)


def _study(device: StatedDevice, settings: Settings, axes: Axes, cores: int | None) -> xr.Dataset:
    """Return the dataset of one device."""
    swept = {name: values for name, values in axes.items() if values.ndim}
    shape = tuple(values.size for values in swept.values())
    grid = np.meshgrid(*axes.values(), indexing="ij") if axes else []
    columns = {name: each.ravel() for name, each in zip(axes, grid, strict=True)}
    batch, units = devices_of(device, columns)
    groups = by_settings(device, settings, units)
    found: dict[str, NDArray[Any]] = {}
    for own, rows in groups.items():
        some = rows_of(batch, rows)
        runs = judged(
            vars_of(align(some, own, cores=cores)), some.values, chamfered=device.is_chamfered
        )
        for name, result in RESULTS.items():
            if name in _OF_INSERTION and own.success is not Outcome.INSERTED:
                continue
            column = runs[name]
            if result.quantity not in (PLAIN, ANGLE):
                column = column * scales([units[row] for row in rows], result.quantity)
            whole = found.setdefault(name, np.empty(len(batch), VALUE_TYPES[name].stored))
            whole[rows] = column
    variables = {
        name: ([*swept], column.reshape(shape), _attributes(name)) for name, column in found.items()
    }
    is_input = {"coverage_content_type": "referenceInformation"}
    held = {
        name: ((), value, _of_quantity(name) | is_input)
        for name, value in held_at_corners(device, _lists(axes)).items()
        if not np.ndim(axes.get(name, 0.0))
    }
    dimensions = {name: (name, v, _of_quantity(name)) for name, v in swept.items()}
    stated = _stated(device, next(iter(groups)), swept)
    corners = corners_of(_lists(axes))
    words = [assumptions_with(device, each, settings, None) for each in corners]
    stated["assumptions"] = as_attribute(at_corners(words))
    return xr.Dataset(variables | held, dimensions, stated)


def _attributes(name: str) -> dict[str, Any]:
    attributes, quantity = result_attributes(RESULTS[name]), RESULTS[name].quantity
    if quantity not in (PLAIN, ANGLE):
        attributes["units"] = quantity.unit
    if name == "tau_align":
        attributes["ancillary_variables"] = "tau_error outcome reason sensitive"
    return attributes


def _of_quantity(name: str) -> dict[str, Any]:
    """Return the attributes of a quantity, with a name that is short enough for a plot."""
    attributes = quantity_attributes(name)
    return attributes | {"long_name": attributes["long_name"].partition(";")[0]}


def _stated(device: StatedDevice, settings: Settings, swept: Axes) -> dict[str, Any]:
    """Return the attributes of the dataset of one device."""
    words = source_words(device)
    return {
        "title": f"Study of the device {words}",
        "summary": summary_of(
            {_of_quantity(name)["long_name"]: v.size for name, v in swept.items()}
        ),
        "device": words,
        "shape": settings.shape or "square",
        "scene": settings.scene.name,
        "start": settings.start or "simultaneous",
        "readings": json.dumps(asdict(settings.readings)),
        "tolerance": settings.tolerance,
        "comment": "SI units",
    }
