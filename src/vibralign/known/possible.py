"""Possible devices: sets of the unknowns, run from every touch-down.

A *touch-down* is a phase of the vibration and a value of each quantity with a tolerance, drawn as a
scrambled Sobol' point. All sets of the unknowns meet the same touch-downs (common random numbers).
A set is *reliable* if the device goes in from every touch-down tried, within the limits.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from model.events.insertion import INSERTION
from model.events.outcomes import SUCCESSES, Outcome
from model.physics.tables import Value
from model.runs.align import run_once
from model.runs.settings import Settings
from model.sweeps.io import DatasetError
from vibralign.answers.causes import STICKS
from vibralign.answers.reliability import Floats, can_be, counted
from vibralign.answers.yields import distribution, interval
from vibralign.device import StatedDevice, load_device
from vibralign.device.batches import devices_of
from vibralign.device.limits import OF_VIBRATOR, of_vibrator
from vibralign.device.mouth import judged
from vibralign.known import doubt
from vibralign.known.posterior import equally

SETS = 512  # sets of the unknowns, a power of two
TOUCH_DOWNS = 32  # of a verdict, a power of two

Sets = Mapping[str, Floats]
"""Values of the unknowns by name in SI units, each of shape (n,)."""


def check_known(device: StatedDevice) -> None:
    """Refuse a device of which something is neither stated nor unknown.

    "The worst that was tried" is no share of what is possible: a base, an approach or a tilt of the
    gripper is stated, or is one of the unknowns.

    Raises:
        ValueError: with the lines that are missing, or nothing is unknown.
    """
    if not device.unknown:
        raise ValueError(
            f"{device.source}: nothing is unknown; state, for example, "
            "unknown: {friction: 0.1 to 0.3}"
        )
    if device.needed_in_part:
        raise ValueError(f"{device.source}: {device.needed_in_part}")


def sets_of(device: StatedDevice, count: int, seed: int = 0) -> dict[str, Floats]:
    """Return ``count`` equally probable sets: of the ranges, or of what trials left.

    Raises:
        DatasetError: the file of samples cannot be read, or is of other unknowns.
    """
    if device.samples is not None:
        return _of_file(device, count, seed)
    points = _sobol(len(device.unknown), count, seed)
    return {name: each.at(points[:, i]) for i, (name, each) in enumerate(device.unknown.items())}


def _of_file(device: StatedDevice, count: int, seed: int) -> dict[str, Floats]:
    import xarray as xr  # noqa: PLC0415  (a second, for devices with samples only)

    assert device.samples is not None  # noqa: S101
    try:
        with xr.open_dataset(device.samples, engine="netcdf4", decode_timedelta=False) as stored:
            columns = {name: stored[name].values for name in device.unknown}
            weights = stored["weight"].values
    except (OSError, KeyError, ValueError) as error:
        raise DatasetError(
            f"{device.samples}: has no samples of {', '.join(device.unknown)} ({error}): run "
            "vibralign calibrate again"
        ) from None
    rows = equally(weights, count, seed)
    return {name: column[rows] for name, column in columns.items()}


def _sobol(dimensions: int, count: int, seed: int) -> Floats:
    return scipy.stats.qmc.Sobol(dimensions, rng=np.random.default_rng(seed)).random(count)


def touch_downs(device: StatedDevice, count: int, seed: int = 1) -> dict[str, Floats]:
    """Return ``count`` touch-downs: phase in rad, and quantities with tolerances in SI units."""
    varied = [name for name in device.tolerances if name not in device.unknown]
    points = _sobol(1 + len(varied), count, seed)
    found = {"phase": 2.0 * np.pi * points[:, 0]}
    for name, column in zip(varied, points[:, 1:].T, strict=True):
        own = distribution(device.quantities[name], device.tolerances[name])
        found[name] = np.asarray(own.ppf(np.clip(column, 1e-6, 1.0 - 1e-6)))
    if "misalignment" in found:
        found["misalignment"] = np.abs(found["misalignment"])  # the other side is alike
    return found


@dataclass(frozen=True)
class Runs:
    """Results of n sets from m touch-downs, in SI units, each of shape (n, m).

    Attributes:
        time: alignment time in s, 0 if it starts inside the hole; NaN if it does not go in.
        force: largest contact force in N.
        tilt: largest tilt in rad.
        late: True if it has neither gone in nor stopped at the horizon, and still moves.
    """

    time: Floats
    force: Floats
    tilt: Floats
    late: NDArray[np.bool_]

    def reliable(self, limits: Mapping[str, float]) -> NDArray[np.bool_]:
        """Return where it goes in from every touch-down, within ``limits``, shape (n,)."""
        found = np.logical_and.reduce(np.isfinite(self.time), axis=1)
        for name, each in (("time", self.time), ("contact_force", self.force), ("tilt", self.tilt)):
            if name in limits:
                found &= np.fmax.reduce(each, axis=1, initial=0.0) <= limits[name]
        return np.asarray(found)

    def undecided(self, limits: Mapping[str, float]) -> NDArray[np.bool_]:
        """Return where nothing but the horizon keeps it from being reliable, shape (n,)."""
        in_time = replace(self, time=np.where(self.late, 0.0, self.time))
        return in_time.reliable(limits) & ~self.reliable(limits)


def run_sets(
    device: StatedDevice,
    sets: Sets,
    downs: Mapping[str, Floats],
    settings: Settings,
    cores: int = 1,
) -> Runs:
    """Run all sets of the unknowns from all touch-downs."""
    n, m = (len(next(iter(each.values()))) for each in (sets, downs))
    values = {name: np.repeat(each, m) for name, each in sets.items()}
    values |= {name: np.tile(each, n) for name, each in downs.items() if name not in sets}
    impossible = ~can_be(device, {k: v for k, v in values.items() if k != "phase"})
    for name, each in values.items():
        values[name] = np.where(impossible, device.quantities.get(name, 0.0), each)
    # Devices of different units differ in their dimensionless horizon: the longest is run.
    horizon = device.horizon
    batch, units = devices_of(replace(device, horizon=None), values)
    second = np.array([each.time for each in units])
    own = counted(settings)
    device = replace(device, horizon=None)
    if horizon is not None:
        own = replace(own, horizon=float(horizon / second.min()))
    found = run_once(batch, device.run_settings(own, units[0]).quickest, cores=cores)
    found = judged(found, batch.values, chamfered=device.is_chamfered)
    goes_in = np.isin(found["outcome"], SUCCESSES) & ~impossible
    time = np.where(goes_in, found["tau_align"] * second, np.nan)
    slow = (found["outcome"] == Outcome.HORIZON_REACHED) & (found["sticking_share"] < STICKS)
    if horizon is not None:
        slow |= time > horizon
        time = np.where(time <= horizon, time, np.nan)
    last = own.horizon * second if horizon is None else horizon
    late = slow & ~impossible & (last < device.limits.get("time", np.inf))
    force = found["contact_force_max"] * [each.force for each in units]
    columns: tuple[NDArray[Any], ...] = time, force, found["tilt_max"], late
    return Runs(*(each.reshape(n, m) for each in columns))


def exceeds_vibrator(device: StatedDevice) -> bool:
    """Return whether the device takes more of the vibrator than its limits allow."""
    drive = of_vibrator(device.units.amplitude, device.quantities["frequency"])
    return any(drive[name] > device.limits.get(name, np.inf) for name in OF_VIBRATOR)


@dataclass(frozen=True, eq=False, repr=False)
class Possible(Value):
    """Possible sets of a device, and its verdict; SI units.

    Attributes:
        sets: sets of the unknowns, equally probable.
        reliable: where the device is reliable, shape (n,).
        longest: longest alignment time in s of each set, NaN if it fails somewhere, shape (n,).
        touch_downs: number of touch-downs.
        unknowns: part of each unknown in the verdict, the one that decides most first.
        undecided: share of what is possible that only the horizon keeps from being reliable.
    """

    sets: Sets
    reliable: NDArray[np.bool_]
    longest: Floats
    touch_downs: int
    unknowns: tuple[doubt.Unknown, ...]
    undecided: float = 0.0

    @property
    def share(self) -> float:
        """Share of what is possible for which the device is reliable."""
        return float(self.reliable.mean())

    @property
    def effective(self) -> float:
        """Effective sample size: sets that trials left are repeated by their weights."""
        table = np.stack([*self.sets.values()])
        counts = np.unique(table, axis=1, return_counts=True)[1]
        return float(counts.sum() ** 2 / (counts**2).sum())

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of the share, of 95 % confidence."""
        count = round(self.effective)
        return interval(round(self.share * count), count)

    @property
    def doubt(self) -> float:
        """Entropy of the verdict, 0 to 1 bit."""
        return float(doubt.entropy(self.share))


def stated(device: StatedDevice | Path | str) -> StatedDevice:
    """Return a device that may be known in part, with a warning of what is doubtful.

    Raises:
        ValueError: as ``load_device`` and ``check_known``.
    """
    device = load_device(device) if isinstance(device, (Path, str)) else device
    check_known(device)
    device.warn()
    return device


def known_in_part(
    device: StatedDevice | Path | str,
    settings: Settings | None = None,
    cores: int = 1,
    *,
    sets: int = SETS,
    touch_downs_tried: int = TOUCH_DOWNS,
    seed: int = 0,
) -> Possible:
    """Return what is possible of a device with ranges, and what decides if it is reliable.

    Args:
        device: with ranges below ``unknown``, or the path of its file.
        settings: settings of the runs; None for the defaults, in the insertion scene.
        cores: number of threads.
        sets: sets of the unknowns, a power of two.
        touch_downs_tried: touch-downs of each, a power of two.
        seed: of the sets.

    Raises:
        ValueError: as ``check_known``.
    """
    device, settings = stated(device), settings or Settings(scene=INSERTION)
    tried = sets_of(device, sets, seed)
    runs = run_sets(device, tried, touch_downs(device, touch_downs_tried), settings, cores)
    reliable, undecided = runs.reliable(device.limits), runs.undecided(device.limits)
    if exceeds_vibrator(device):
        reliable[:], undecided[:] = False, False
    longest = runs.time.max(axis=1)
    unknowns = doubt.unknowns_of(device.unknown, tried, reliable)
    return Possible(tried, reliable, longest, touch_downs_tried, unknowns, float(undecided.mean()))
