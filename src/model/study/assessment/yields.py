"""Yield of a device with tolerances: the share of devices that go in from every start.

Devices are drawn as scrambled Sobol' points through the inverse of each quantity's distribution.
The interval of the share is Wilson's for independent draws, which is wider than that of these
points. Sobol' indices say how much of the variance of failure and time is due to which tolerance.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from model.physics.parameters import FIELDS, Batch
from model.physics.units import Device
from model.runs.settings import Settings
from model.study.devices import StatedDevice, Tolerance
from model.study.maps.starts import Starts, every_start

Floats = NDArray[np.float64]
Values = Mapping[str, Floats]
CONFIDENCE = 0.95
QUANTILES = (0.05, 0.5, 0.95)
DEVICES = 4096  # a power of two
BLAME = 256  # points of the Sobol' indices, a power of two
BLAME_STARTS = 4  # every so many starts only
STATISTICAL_TOLERANCE = 1e-6  # local error of a step; the yield is the same as at 1e-10


@dataclass(frozen=True)
class Devices:
    """Results of devices in SI units, from every start.

    Attributes:
        values: quantities that differ, each of shape (n,).
        goes_in: True if the part goes in from every start, shape (n,).
        time: longest alignment time in s, NaN where it does not go in from any start, shape (n,).
        times: alignment times in s, NaN where it does not go in, shape (n, starts).
        force: largest contact force in N, shape (n,).
        tilt: largest tilt in rad, shape (n,).
        failing: number of the first start that fails, -1 if none does, shape (n,).
    """

    values: Values
    goes_in: NDArray[np.bool_]
    time: Floats
    times: Floats
    force: Floats
    tilt: Floats
    failing: NDArray[np.int64]


@dataclass(frozen=True)
class Blame:
    """Sobol' indices of one quantity, of first order and total, for failure and for time.

    NaN where there is no variance: no device fails, or all do.
    """

    quantity: str
    failure: float
    failure_total: float
    time: float
    time_total: float


@dataclass(frozen=True)
class Yield:
    """Yield of a device with tolerances; SI units.

    Attributes:
        devices, going_in: number of devices drawn, and of those that go in from every start.
        low, high: interval of the share, of 95 % confidence.
        time: 5, 50 and 95 % quantiles of the alignment time over devices and starts.
        force: the same of a device's largest contact force.
        runs: number of runs.
        blame: Sobol' indices, the quantity with the largest total index of failure first; empty if
            no device goes in.
    """

    devices: int
    going_in: int
    low: float
    high: float
    time: tuple[float, float, float]
    force: tuple[float, float, float]
    runs: int
    blame: tuple[Blame, ...]

    @property
    def share(self) -> float:
        """Share of the devices that go in from every start."""
        return self.going_in / self.devices


@dataclass(frozen=True)
class FailingDevice:
    """Drawn device that fails.

    Attributes:
        quantities: its quantities with tolerances, in SI units.
        distance: largest deviation, in tolerances: 1 is the end of a uniform one, and three
            standard deviations of a normal one.
        start: phase and tilt at touch-down of a failing run.
    """

    quantities: Mapping[str, float]
    distance: float
    start: Mapping[str, float]


def distribution(name: str, value: float, tolerance: Tolerance) -> Any:
    """Return the distribution of a quantity, in SI units, cut where its rule ends (scipy)."""
    bound = FIELDS[name].bound if name in FIELDS else "> 0"
    least = {"> 0": 1e-6 * abs(value), ">= 0": 0.0, "": -math.inf}[bound]
    most = 1.0 if name == "restitution" else math.inf
    width = tolerance.around(value)
    if tolerance.kind == "uniform":
        low, high = max(value - width, least), min(value + width, most)
        return stats.uniform(low, high - low)
    ends = (least - value) / width, (most - value) / width
    return stats.truncnorm(*ends, loc=value, scale=width)


def from_unit_cube(stated: StatedDevice, points: Floats) -> dict[str, Floats]:
    """Return the quantities with tolerances at ``points`` of the unit cube, shape (n, d)."""
    laws = [distribution(n, stated.quantities[n], t) for n, t in stated.tolerances.items()]
    names = list(stated.tolerances)
    return {
        n: np.asarray(law.ppf(points[:, i]))
        for i, (n, law) in enumerate(zip(names, laws, strict=True))
    }


def drawn(stated: StatedDevice, count: int, seed: int = 0) -> dict[str, Floats]:
    """Return the quantities of ``count`` devices, a power of two, as scrambled Sobol' points."""
    points = stats.qmc.Sobol(len(stated.tolerances), rng=np.random.default_rng(seed)).random(count)
    return from_unit_cube(stated, points)


def _devices_at(stated: StatedDevice, values: Values) -> list[Device]:
    rows = zip(*(each.tolist() for each in values.values()), strict=True)
    return [stated.at(dict(zip(values, row, strict=True))) for row in rows]


def batch_of(stated: StatedDevice, values: Values) -> Batch:
    """Return the parameters of devices with these quantities, in SI units, each of shape (n,)."""
    return Batch.stack([each.parameters for each in _devices_at(stated, values)])


def run_devices(
    stated: StatedDevice, values: Values, starts: Starts, settings: Settings, cores: int = 1
) -> Devices:
    """Run devices with these quantities (SI units, each of shape (n,)) from every start.

    Raises:
        ValueError: a quantity outside its rule.
    """
    each = _devices_at(stated, values)
    found = every_start(Batch.stack([one.parameters for one in each]), starts, settings, cores)
    goes_in = found["goes_in"]
    times = np.where(goes_in, found["tau_align"], np.nan)
    times = times * np.array([[one.units.time] for one in each])
    force = np.array([one.units.force for one in each]) * found["contact_force_max"].max(axis=1)
    return Devices(
        values=values,
        goes_in=np.logical_and.reduce(goes_in, axis=1),
        time=np.fmax.reduce(times, axis=1),
        times=times,
        force=force,
        tilt=found["tilt_max"].max(axis=1),
        failing=np.where(goes_in.all(axis=1), -1, np.argmin(goes_in, axis=1)),
    )


def check_devices(count: float) -> int:
    """Return a number of devices.

    Raises:
        ValueError: it is no power of two, which Sobol' points need.
    """
    if count != int(count) or count < 2 or int(count) & (int(count) - 1):
        raise ValueError(f"devices = {count:g}: must be a power of two, 2 or more")
    return int(count)


def yield_of(
    stated: StatedDevice,
    starts: Starts,
    settings: Settings,
    cores: int = 1,
    *,
    devices: int = DEVICES,
    seed: int = 0,
    blame: bool = True,
) -> tuple[Yield, Devices]:
    """Return the yield of a device with tolerances, and the devices that were drawn.

    Raises:
        ValueError: a device without tolerances, or a number that is no power of two.
    """
    if not stated.tolerances:
        raise ValueError(f"{stated.source}: no quantity has a tolerance, such as 10 N ± 5 %")
    check_devices(devices)
    found = run_devices(stated, drawn(stated, devices, seed), starts, settings, cores)
    going_in = int(found.goes_in.sum())
    blame = blame and going_in > 0
    low, high = interval(going_in, devices)
    indices = blame_of(stated, starts[::BLAME_STARTS], settings, cores, seed=seed) if blame else ()
    runs = devices * len(starts)
    if blame:
        runs += BLAME * (len(stated.tolerances) + 2) * len(starts[::BLAME_STARTS])
    return (
        Yield(
            devices=devices,
            going_in=going_in,
            low=low,
            high=high,
            time=_quantiles(found.times.ravel()),
            force=_quantiles(found.force),
            runs=runs,
            blame=indices,
        ),
        found,
    )


def nearest_failing(stated: StatedDevice, known: Devices, starts: Starts) -> FailingDevice | None:
    """Return the drawn device that fails nearest to the stated values, None if none fails."""
    off = np.stack([
        np.abs(known.values[name] - stated.quantities[name])
        / (each.around(stated.quantities[name]) * (1.0 if each.kind == "uniform" else 3.0))
        for name, each in stated.tolerances.items()
    ]).max(axis=0)  # fmt: skip
    nearest = int(np.argmin(np.where(known.goes_in, np.inf, off)))
    if known.goes_in[nearest]:
        return None
    values = {name: float(each[nearest]) for name, each in known.values.items()}
    return FailingDevice(values, float(off[nearest]), dict(starts[known.failing[nearest]]))


def interval(successes: int, count: int) -> tuple[float, float]:
    """Return Wilson's interval of a share, of 95 % confidence."""
    found = stats.binomtest(successes, count).proportion_ci(CONFIDENCE, method="wilson")
    return float(found.low), float(found.high)


def blame_of(
    stated: StatedDevice,
    starts: Starts,
    settings: Settings,
    cores: int = 1,
    *,
    count: int = BLAME,
    seed: int = 0,
) -> tuple[Blame, ...]:
    """Return the Sobol' indices of every quantity with a tolerance, the worst first.

    Failure is 1 or 0 for a device. Devices that do not go in have the mean time of the others, and
    so no part in the variance of the time.
    """
    names = list(stated.tolerances)
    size = len(names)

    def results(points: Floats) -> Floats:
        found = run_devices(stated, from_unit_cube(stated, points), starts, settings, cores)
        return np.stack([1.0 - found.goes_in, found.time])

    cubes = sobol_cubes(size, count, seed)
    f = results(cubes.reshape(-1, size)).reshape(2, size + 2, count)
    known = np.isfinite(f[1])
    f[1] = np.where(known, f[1], f[1][known].mean() if known.any() else 0.0)
    failure, time = sobol_indices(f[0]), sobol_indices(f[1])
    found = [
        Blame(name, *(float(each[i]) for each in (*failure, *time))) for i, name in enumerate(names)
    ]
    return tuple(
        sorted(found, key=lambda b: (-np.nan_to_num(b.failure_total), -np.nan_to_num(b.time_total)))
    )


def sobol_cubes(size: int, count: int, seed: int) -> Floats:
    """Return the points of Saltelli's scheme A, B, AB_1, …, AB_d, shape (d + 2, count, d)."""
    both = stats.qmc.Sobol(2 * size, rng=np.random.default_rng(seed)).random(count)
    a, b = both[:, :size], both[:, size:]
    mixed = [np.where(np.arange(size) == i, b, a) for i in range(size)]
    return np.stack([a, b, *mixed])


def sobol_indices(f: Floats) -> tuple[Floats, Floats]:
    """Return first-order and total Sobol' indices of values on ``sobol_cubes``, shape (d + 2, n).

    NaN for values without variance.
    """
    if np.ptp(f[:2]) == 0.0:
        nothing = np.full(len(f) - 2, np.nan)
        return nothing, nothing
    if len(f) == 3:  # one quantity, which scipy refuses
        return np.ones(1), np.ones(1)
    values = {"f_A": f[None, 0], "f_B": f[None, 1], "f_AB": f[2:, None]}
    found = stats.sobol_indices(func=values, n=f.shape[1])
    return np.asarray(found.first_order).ravel(), np.asarray(found.total_order).ravel()


def _quantiles(values: Floats) -> tuple[float, float, float]:
    finite = values[np.isfinite(values)]
    if not finite.size:
        return math.nan, math.nan, math.nan
    low, middle, high = np.quantile(finite, QUANTILES)
    return float(low), float(middle), float(high)
