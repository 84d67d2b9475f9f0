"""Runs of devices in any form: of a file, as ``load_device`` returns them, or dimensionless.

A device of a file runs as the file states it: its start, its shape, and a horizon or depth in SI
units, unless the settings state another shape, horizon or depth.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.engine.results import RESULTS, VALUE_TYPES
from model.events.insertion import INSERTION
from model.physics.parameters import Batch, Parameters
from model.physics.quantities import LENGTH, TIME, Quantity
from model.physics.tables import vars_of
from model.runs import align as many
from model.runs import simulate as single
from model.runs.align import Alignments
from model.runs.settings import Settings, settings_with
from model.runs.simulate import Trajectory
from vibralign.device.amounts import read_positive
from vibralign.device.approach import read_start
from vibralign.device.load import load_device
from vibralign.device.mouth import judged
from vibralign.device.quantities import QUANTITIES
from vibralign.device.stated import StatedDevice
from vibralign.device.unknown import refusal

Device = Parameters | StatedDevice
AnyDevice = Device | Path | str
IN_SI: dict[str, Quantity] = {"horizon": TIME, "insertion_depth": LENGTH}
"""Settings that may be texts with a unit, such as ``horizon="3 s"``, for a device in SI units."""


def device_of(given: object) -> Device:
    """Return a device, and warn of what is doubtful; a text or path is that of its file.

    Raises:
        TypeError: no device; a list is not one.
        DeviceError: as ``load_device``.
        ValueError: quantities are unknown.
    """
    if isinstance(given, (str, Path)):
        given = load_device(given)
    if not isinstance(given, (Parameters, StatedDevice)):
        raise TypeError(
            "a device is Parameters, what load_device returns, or the path of its file, got "
            f"{type(given).__name__}"
        )
    if isinstance(given, StatedDevice):
        if given.unknown:
            one = next(iter(given.unknown))
            instead = f"give them with changed({one}=...), or ask known_in_part and calibrate"
            raise refusal(given.source, given.unknown, instead)
        given.warn()
    return given


def stated_of(given: object) -> StatedDevice:
    """Return a device in SI units; errors as ``device_of``.

    Raises:
        TypeError: it is dimensionless.
    """
    device = device_of(given)
    if isinstance(device, Parameters):
        raise TypeError(
            "this needs a device of a file, as load_device returns it, or the file's path, got "
            "Parameters, which only simulate and align run"
        )
    return device


def listed(given: AnyDevice | Iterable[AnyDevice]) -> list[Any]:
    """Return the list, or one of the device that is given in place of a list."""
    if isinstance(given, (str, Mapping)) or not isinstance(given, Iterable):
        return [given]
    return list(given)


def devices_in(given: AnyDevice | Iterable[AnyDevice]) -> list[Device]:
    """Return the devices of a list, or the one that is given in place of a list.

    Raises:
        TypeError, DeviceError: as ``device_of``.
    """
    return [device_of(each) for each in listed(given)]


def _check_start(device: StatedDevice, start: str | None) -> None:
    """Refuse a start that is not the device's, which would have no effect."""
    if start not in (None, device.run_settings(Settings(), device.units).start):
        read_start({"start": start})


def settings_for(device: StatedDevice, settings: Settings | None) -> Settings:
    """Return the settings of an answer; by default, those of the insertion scene.

    Raises:
        ValueError: a start that is not the device's.
    """
    if settings is not None:
        _check_start(device, settings.start)
    return settings or Settings(scene=INSERTION)


def with_changes(
    device: StatedDevice, settings: Settings | None, changes: dict[str, Any]
) -> tuple[StatedDevice, Settings]:
    """Return a device with a horizon and depth given as texts, and settings with other changes.

    Raises:
        TypeError, ValueError: as ``settings_with``, a text that is no amount, or a start that is
            not the device's.
    """
    _check_start(device, changes.get("start", None if settings is None else settings.start))
    texts = {n: v for n, v in changes.items() if n in IN_SI and isinstance(v, str)}
    in_si: Any = {n: read_positive(n, text, IN_SI[n].unit) for n, text in texts.items()}
    others = {name: value for name, value in changes.items() if name not in texts}
    return replace(device, **in_si), _settings_with(settings, others)


def _settings_with(settings: Settings | None, changes: dict[str, Any]) -> Settings:
    """Return ``settings_with``; refuse a quantity of a device, and say where it belongs."""
    for name, value in changes.items():
        if name in QUANTITIES:
            raise ValueError(
                f"unknown setting {name!r}: it is a quantity of the device. Change the device: "
                f"load_device(file, {{{name!r}: {value!r}}}), device.changed({name}={value!r}), or "
                f"Parameters.replace for dimensionless ones; sweep(device, {name}={value!r}) takes "
                "it, too"
            )
    return settings_with(settings, changes)


def as_run(
    device: Device, settings: Settings | None, changes: dict[str, Any]
) -> tuple[Parameters, Settings]:
    """Return the parameters of a device and the settings of its runs; errors as above."""
    if isinstance(device, Parameters):
        return device, _settings_with(settings, changes)
    device, settings = with_changes(device, settings, changes)
    return device.parameters, device.run_settings(settings, device.units)


def simulate(parameters: AnyDevice, settings: Settings | None = None, **changes: Any) -> Trajectory:
    """Run one device and return its trajectory, dimensionless, with the units of a device in SI.

    Args:
        parameters: ``Parameters``, a device as ``load_device`` returns it, or the path of its file.
            A device of a file runs from the start that it states, with its shape unless the
            settings state another.
        settings: settings of the run; the defaults of ``Settings`` if None.
        **changes: fields of ``Settings`` by name, over those of ``settings`` (``horizon=100``);
            ``horizon="3 s"`` and ``insertion_depth="2 mm"`` for a device in SI units.

    Raises:
        TypeError: no ``Parameters`` and no device, or a setting of the wrong type.
        ValueError: a setting that is unknown or out of range, or a file that states no device.
    """
    device = device_of(parameters)
    own, settings = as_run(device, settings, changes)
    run = single.simulate(own, settings)
    return run if isinstance(device, Parameters) else of_device(run, device)


def of_device(run: Trajectory, device: StatedDevice) -> Trajectory:
    """Return the run of a device in SI units, with its units and what ``judged`` says of it."""
    results = {name: np.asarray(getattr(run, name)) for name in RESULTS}
    found = judged(results, vars_of(run.parameters), chamfered=device.is_chamfered)
    values = {name: VALUE_TYPES[name].scalar(each) for name, each in found.items()}
    return replace(run, units=device.units, **values)


def align(
    batch: Batch | AnyDevice | Sequence[AnyDevice],
    settings: Settings | None = None,
    *,
    cores: int | None = None,
    **changes: Any,
) -> Alignments:
    """Run every device of ``batch`` to its end and estimate the error of its result.

    Each result depends on its own device only: row i of ``align(batch)`` equals
    ``align([batch[i]])`` to the bit, for any order and any number of cores.

    Args:
        batch: a ``Batch``, a device as ``simulate`` takes it, or a sequence of such devices.
        settings: settings of the runs; the defaults of ``Settings`` if None.
        cores: number of threads, >= 1; all cores by default.
        **changes: fields of ``Settings`` by name, as ``simulate`` takes them.

    Raises:
        TypeError: no batch and no sequence of devices, or a setting of the wrong type.
        ValueError: an empty batch, fewer than one core, or a setting that is unknown or out of
            range.
    """
    devices = batch if isinstance(batch, Batch) else devices_in(batch)
    if isinstance(devices, Batch) or all(isinstance(each, Parameters) for each in devices):
        own = _settings_with(settings, changes)
        return many.align(devices, own, cores=cores)  # type: ignore[arg-type]
    runs = [as_run(each, settings, changes) for each in devices]
    rows: dict[Settings, list[int]] = {}
    for row, (_, own) in enumerate(runs):
        rows.setdefault(own, []).append(row)
    found: dict[str, Any] = {}
    for own, some in rows.items():
        part = many.align([runs[row][0] for row in some], own, cores=cores)
        for name, column in vars_of(part).items():
            found.setdefault(name, np.empty(len(runs), column.dtype))[some] = column
    chamfered = [each.is_chamfered if isinstance(each, StatedDevice) else None for each in devices]
    for kind in {*chamfered} - {None}:
        some = [row for row, each in enumerate(chamfered) if each is kind]
        batch, columns = Batch.stack([runs[row][0] for row in some]), _rows(found, some)
        for name, column in judged(columns, batch.values, chamfered=bool(kind)).items():
            found[name][some] = column
    return Alignments(**found)


def _rows(columns: Mapping[str, NDArray[Any]], rows: Sequence[int]) -> dict[str, NDArray[Any]]:
    return {name: column[rows] for name, column in columns.items()}
