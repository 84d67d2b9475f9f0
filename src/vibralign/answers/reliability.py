"""Reliability of devices, for all commands: does a device go in (or align) in every case?

Phase and tilt at touch-down cannot be controlled, and a base that is not stated is not known: a
*reliable* device goes in from every start, on every base that is tried (cases.py). Values of a
device are in SI units, and change as ``--set`` changes them.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from model.events.outcomes import SUCCESSES, Outcome, Reason, Unvibrated
from model.events.table import PLACES_OF_CONTACT
from model.physics.tables import Value
from model.physics.units import Units
from model.runs.settings import Settings
from model.runs.unvibrated import unvibrated
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts, every_start
from vibralign.answers.cases import at_tilts, by_approach, cases_of, on_bases
from vibralign.device import StatedDevice
from vibralign.device.amounts import read_amount
from vibralign.device.batches import Values, by_settings, devices_of, rows_of
from vibralign.device.limits import LIMITS, of_vibrator
from vibralign.device.mouth import CHAMFERS, judged, judged_on_chamfers
from vibralign.device.quantities import bound_of, unit_of
from vibralign.device.runs import AnyDevice, settings_for, stated_of

Floats = NDArray[np.float64]
STATISTICAL_TOLERANCE = 1e-6  # local error of a step; yields are the same as at 1e-10
FORCES = {place: f"{place}_force_max" for place in PLACES_OF_CONTACT}
"""Results of a run that are the largest force at a place of contact, by the place."""
_FIRST = 4  # cases that are tried before all others
_SPREAD = (5.0**0.5 - 1.0) / 2.0  # of the cases, from one to the next: far from all before


@dataclass(frozen=True, eq=False, repr=False)
class DeviceResults(Value):
    """Results of n devices in every case, in SI units.

    Attributes:
        values: quantities that differ between the devices, each of shape (n,).
        goes_in: True if the part goes in in every case, shape (n,).
        time: longest alignment time in s, NaN where it never goes in, shape (n,).
        times: alignment times in s, NaN where it does not go in, shape (n, cases).
        force: largest contact force at any place in N, until the end of the runs, shape (n,).
        tilt: largest tilt in rad, shape (n,).
        failing: index of the first case that fails, -1 if none does, shape (n,).
        forces: largest contact force in N by the place, each of shape (n,).
        inside: True if the part starts inside the hole, shape (n,).
        insertion: longest time until inserted in s, NaN where it is never inserted, shape (n,).
        impossible: True if there is no such device (no play, a negative friction …): it does not go
            in, and its numbers are NaN, shape (n,).
        on_chamfers: True if it goes in as its chamfers meet the hole's, from every start: the press
            alone brings it in; its forces and tilts are not modelled, and NaN. Shape (n,).
    """

    values: Values
    goes_in: NDArray[np.bool_]
    time: Floats
    times: Floats
    force: Floats
    tilt: Floats
    failing: NDArray[np.int64]
    forces: Mapping[str, Floats]
    inside: NDArray[np.bool_]
    insertion: Floats
    impossible: NDArray[np.bool_]
    on_chamfers: NDArray[np.bool_]

    def __getitem__(self, rows: Any) -> "DeviceResults":
        """Return the results of some devices, or of all in another order."""

        def of(column: Any) -> Any:
            if isinstance(column, Mapping):
                return {name: each[rows] for name, each in column.items()}
            return column[rows]

        return DeviceResults(*(of(getattr(self, each.name)) for each in fields(self)))

    @property
    def measures(self) -> dict[str, Floats]:
        """Measure that a limit of each name bounds, shape (n,)."""
        return {"time": self.time, "contact_force": self.force, "tilt": self.tilt}

    @property
    def largest(self) -> dict[str, float]:
        """Largest of each of the measures over all devices, NaN without any."""
        measures = self.measures.items()
        return {name: float(np.fmax.reduce(each, initial=np.nan)) for name, each in measures}

    def __repr__(self) -> str:
        return f"<DeviceResults: {self.goes_in.sum():,} of {self.goes_in.size:,} devices go in>"


def counted(settings: Settings) -> Settings:
    """Return the settings of runs of which many are counted."""
    return replace(settings, tolerance=max(settings.tolerance, STATISTICAL_TOLERANCE))


def as_stated(device: StatedDevice) -> Values:
    """Return the values of one device without a change."""
    return {"friction": np.array([device.quantities["friction"]])}


def from_every_start(
    device: StatedDevice, values: Values, starts: Starts, settings: Settings, cores: int = 1
) -> tuple[dict[str, NDArray[Any]], list[Units]]:
    """Return ``every_start`` of devices with these values, and their units."""
    if "vibrates" in starts[0]:
        return _from_every_approach(device, values, starts, settings, cores)
    devices, units = devices_of(device, values)
    fixture = values.get("fixture_stiffness", device.fixture)
    of_cases = on_bases(devices, units, starts, device.shape, fixture) | at_tilts(devices, starts)
    results = dict[str, NDArray[Any]]()
    for own, rows in by_settings(device, settings, units).items():
        others = {name: column[rows] for name, column in of_cases.items()}
        found = every_start(rows_of(devices, rows), starts, own, cores, others)
        for name, column in found.items():
            whole = results.setdefault(name, np.empty((len(devices), len(starts)), column.dtype))
            whole[rows] = column
    parameters = {name: column[:, None] for name, column in devices.values.items()} | of_cases
    results = judged(results, parameters, chamfered=device.is_chamfered)
    if device.is_chamfered:
        one = np.array([each.amplitude for each in units])
        stated = {name: device.quantities.get(name, 0.0) for name in CHAMFERS} | {**values}
        part, hole = ((stated[name] / one)[:, None] for name in CHAMFERS)
        results = judged_on_chamfers(results, parameters, (part, hole))
    return {**results, "goes_in": np.isin(results["outcome"], SUCCESSES)}, units


def _from_every_approach(
    device: StatedDevice, values: Values, starts: Starts, settings: Settings, cores: int
) -> tuple[dict[str, NDArray[Any]], list[Units]]:
    """Return ``from_every_start`` of cases that have approaches."""
    results, units = dict[str, NDArray[Any]](), list[Units]()
    for lowered, places, own in by_approach(device, starts):
        found, units = from_every_start(lowered, values, own, settings, cores)
        for name, column in found.items():
            shape = len(column), len(starts)
            results.setdefault(name, np.empty(shape, column.dtype))[:, places] = column
    return results, units


def run_devices(
    stated: StatedDevice, values: Values, starts: Starts, settings: Settings, cores: int = 1
) -> DeviceResults:
    """Run devices with these quantities (SI units, each of shape (n,)) from every start."""
    impossible = ~can_be(stated, values)
    possible = {n: np.where(impossible, stated.quantities[n], v) for n, v in values.items()}
    results, units = from_every_start(stated, possible, starts, settings, cores)
    goes_in = results["goes_in"] & ~impossible[:, None]
    at_once = (results["tau_align"] == 0.0) & ~impossible[:, None]
    second = np.array([each.time for each in units])
    by_press = at_once & (results["reason"] == Reason.BY_PRESS)
    inside = np.logical_and.reduce(at_once & ~by_press, axis=1)
    on_chamfers = np.logical_and.reduce(at_once, axis=1) & ~inside
    unknown = impossible | on_chamfers
    newton = np.where(unknown, np.nan, np.array([each.force for each in units]))
    counted = goes_in & ~at_once
    times = np.where(counted, results["tau_align"], np.nan) * second[:, None]
    inserted = np.where(counted, results["tau_align"] + results["tau_inserted"], np.nan)
    return DeviceResults(
        values=values,
        goes_in=np.logical_and.reduce(goes_in, axis=1),
        time=np.fmax.reduce(times, axis=1),
        times=times,
        force=newton * np.fmax.reduce(results["contact_force_max"], axis=1),
        tilt=np.where(unknown, np.nan, np.fmax.reduce(results["tilt_max"], axis=1)),
        failing=np.where(goes_in.all(axis=1), -1, np.argmin(goes_in, axis=1)),
        forces={n: newton * np.fmax.reduce(results[r], axis=1) for n, r in FORCES.items()},
        inside=inside,
        insertion=np.fmax.reduce(inserted, axis=1) * second,
        impossible=impossible,
        on_chamfers=on_chamfers,
    )


def joined(parts: Sequence[DeviceResults], order: NDArray[np.int64] | None = None) -> DeviceResults:
    """Return the results of all parts, in another ``order`` of the devices if it is given.

    If parts have different numbers of cases, ``times`` holds the longest of a device, shape (n, 1).
    """

    def join(name: str) -> Any:
        columns = [getattr(part, name) for part in parts]
        if isinstance(columns[0], Mapping):
            return {key: np.concatenate([each[key] for each in columns]) for key in columns[0]}
        if name == "times" and len({each.shape[1] for each in columns}) > 1:
            return join("time")[:, None]
        return np.concatenate(columns)

    whole = DeviceResults(*(join(each.name) for each in fields(DeviceResults)))
    return whole if order is None else whole[order]


def can_be(stated: StatedDevice, values: Values) -> NDArray[np.bool_]:
    """Return where a device with these quantities has play and starts at the hole, shape (n,)."""
    given: dict[str, Any] = {**stated.values, **stated.quantities, **values}
    admitted = np.ones(len(next(iter(values.values()))), np.bool_)
    for name, column in values.items():
        bound = "> 0" if name == "press_force" else bound_of(name)
        if bound:
            admitted &= (column > 0.0) if bound == "> 0" else (column >= 0.0)
        if name == "restitution":
            admitted &= column <= 1.0
    beyond = given["half_width"] * (2.0 + given["clearance"])
    return admitted & (given["misalignment"] < beyond)


def need_vibration(
    stated: StatedDevice, values: Values, settings: Settings, cores: int = 1
) -> NDArray[np.bool_]:
    """Return a mask of the devices that do not align without vibration, shape (n,)."""
    devices, units = devices_of(stated, values)
    needs = np.empty(len(devices), dtype=bool)
    for own, rows in by_settings(stated, settings, units).items():
        controls = unvibrated(rows_of(devices, rows), own, cores)
        needs[rows] = controls.outcome != Unvibrated.ALIGNS
    return needs


def are_reliable(
    device: StatedDevice,
    values: Values,
    starts: Starts,
    settings: Settings,
    cores: int = 1,
    limits: Mapping[str, float] = MappingProxyType({}),
    failures: NDArray[np.int64] | None = None,
) -> NDArray[np.bool_]:
    """Return a mask of the devices that go in in all cases, within ``limits``, shape (n,).

    A case is tried only where those before it succeed: first a few, then each time twice as many.
    ``limits`` are those of a device file, in SI units. ``failures`` counts by case the devices that
    failed before, and those that fail now are added; cases in which most failed are tried first.
    """
    reliable = np.ones(len(next(iter(values.values()))), np.bool_)
    own = {**device.quantities, **values}
    for name, each in of_vibrator(own["amplitude"], own["frequency"]).items():
        reliable &= each <= limits.get(name, math.inf)
    failures = np.zeros(len(starts), np.int64) if failures is None else failures
    order = in_turn(len(starts))
    order = order[np.argsort(-failures[order], kind="stable")]
    begin = 0
    settings = settings if limits else settings.quickest  # the quickest runs do not know all forces
    while begin < len(order) and (left := np.flatnonzero(reliable)).size:
        some = order[begin : 2 * begin + _FIRST]
        tried = {name: column[left] for name, column in values.items()}
        found, units = from_every_start(device, tried, [starts[i] for i in some], settings, cores)
        holds = found["goes_in"] & _kept(found, units, limits)
        failures[some] += (~holds).sum(axis=0)
        reliable[left] = holds.all(axis=1)
        begin += len(some)
    return reliable


def _kept(
    found: Mapping[str, NDArray[Any]], units: Sequence[Units], limits: Mapping[str, float]
) -> NDArray[np.bool_]:
    """Return where devices keep the limits of time, force and tilt, shape (n, cases)."""
    kept = np.ones(found["goes_in"].shape, np.bool_)
    of = {"time": "tau_align", "contact_force": "contact_force_max", "tilt": "tilt_max"}
    for name, limit in limits.items():
        if name in of:
            one = np.array([each.of(LIMITS[name][1]) for each in units])[:, None]
            kept &= ~(found[of[name]] * one > limit)
    return kept


def in_turn(count: int) -> NDArray[np.int64]:
    """Return the numbers of cases in the order in which to try them: the next, and one far from it.

    A failing device fails in cases that are alike, or in those in which other devices fail; these
    come first if they are known.
    """
    spread = np.argsort(np.argsort(np.arange(count) * _SPREAD % 1.0)).tolist()
    turns = itertools.chain.from_iterable(zip(range(count), spread, strict=True))
    return np.array(list(dict.fromkeys(turns)))


def are_late(
    device: StatedDevice, values: Values, starts: Starts, settings: Settings, cores: int = 1
) -> NDArray[np.bool_]:
    """Return a mask of the devices that fail, if at all, only by the horizon, shape (n,).

    A longer horizon may let them go in.
    """
    results, _ = from_every_start(device, values, starts, settings.quickest, cores)
    late = results["outcome"] == Outcome.HORIZON_REACHED
    return np.logical_and.reduce(results["goes_in"] | late, axis=1)


def reliable_at(
    device: AnyDevice,
    settings: Settings | None = None,
    *,
    cores: int = 1,
    **quantities: ArrayLike,
) -> NDArray[np.bool_]:
    """Return where a device goes in in every case, shape (n,), as ``assess`` says.

    Args:
        device: of a file, as ``simulate`` takes it.
        settings: settings of the runs; None for the defaults, in the insertion scene.
        cores: number of threads.
        **quantities: what varies together, each of shape (n,), such as
            ``press_force=[8.0, 10.0, "12 N"]``; numbers in SI units.

    Raises:
        TypeError: no device, or a dimensionless one.
        ValueError: an unknown quantity, shapes that differ, or a value outside its rule.
    """
    device = stated_of(device)
    units = {name: unit_of(name) for name in quantities}
    values = {
        name: np.array([read_amount(name, v, units[name]).value for v in np.ravel(given).tolist()])
        for name, given in quantities.items()
    }
    if len({each.shape for each in values.values()}) > 1:
        shapes = ", ".join(f"{name}: {each.size}" for name, each in values.items())
        raise ValueError(f"quantities must have one common length, got {shapes}")
    varied: Values = values or as_stated(device)
    settings = settings_for(device, settings)
    cases = cases_of(device, Ensemble(), varied=varied)
    return are_reliable(device, varied, cases, settings, cores)
