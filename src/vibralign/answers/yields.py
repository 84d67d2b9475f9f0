"""Yield of a device with tolerances: the share of devices that go in in every case.

Devices are drawn as scrambled Sobol' points through the inverse of each quantity's distribution.
One that starts inside the hole needs no alignment: it is drawn, and not counted. The interval of
the share is Wilson's for independent draws, wider than that of Sobol' points. Sobol' indices say
how much of the variance of failure and of time is due to which tolerance; their interval is that
of a bootstrap.
"""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from model.events.insertion import INSERTION
from model.physics.tables import Value
from model.runs.settings import Settings
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts
from vibralign.answers.approaches import in_worst_approach
from vibralign.answers.cases import cases_of, stated_case
from vibralign.answers.reliability import DeviceResults, Floats, need_vibration, run_devices
from vibralign.device import StatedDevice, Tolerance, load_device
from vibralign.device.stated import bound_of

CONFIDENCE = 0.95
QUANTILES = (0.05, 0.5, 0.95)
DEVICES = 4096  # a power of two
INDEX_POINTS = 256  # points of the Sobol' indices, a power of two
INDEX_STARTS = 4  # the indices take every fourth start


@dataclass(frozen=True, eq=False, repr=False)
class SobolIndices(Value):
    """Sobol' indices of one quantity, of first order and total: of failure, and of time.

    NaN where there is no variance: no device fails, or all do. ``intervals`` holds the ends of the
    interval of each, in this order.
    """

    quantity: str
    failure: float
    failure_total: float
    time: float
    time_total: float
    intervals: tuple[tuple[float, float], ...] = ((math.nan, math.nan),) * 4


@dataclass(frozen=True, eq=False, repr=False)
class Yield(Value):
    """Yield of a device with tolerances; SI units.

    Attributes:
        devices: number of devices drawn that start outside the hole.
        going_in: number of these that go in in every case.
        low, high: interval of the share.
        time: 5, 50 and 95 % quantiles of the alignment time over these devices and cases.
        force: 5, 50 and 95 % quantiles over these of the largest contact force at any place.
        runs: number of runs.
        sobol_indices: of every quantity with a tolerance, the largest total index of failure first;
            empty if no device goes in.
        inside: number of devices drawn that start inside the hole, which are not counted.
        forces: largest contact force of these devices by the place.
        insertion: 5, 50 and 95 % quantiles over these of the longest time until inserted.
        confidence: level of confidence of the intervals.
        largest: longest "time" until alignment, largest "contact_force" and "tilt" of these; if a
            limit asks for it, the share that needs "vibration" to align.
    """

    devices: int
    going_in: int
    low: float
    high: float
    time: tuple[float, float, float]
    force: tuple[float, float, float]
    runs: int
    sobol_indices: tuple[SobolIndices, ...]
    inside: int = 0
    forces: Mapping[str, float] = field(default_factory=dict)
    insertion: tuple[float, float, float] = (math.nan,) * 3
    confidence: float = CONFIDENCE
    largest: Mapping[str, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        ends = f"{100.0 * self.low:.4g} to {100.0 * self.high:.4g} %"
        return f"<Yield: {100.0 * self.share:.4g} % ({ends}) of {self.devices:,} devices>"

    @property
    def share(self) -> float:
        """Share of the devices that go in in every case, NaN if all start inside the hole."""
        return self.going_in / self.devices if self.devices else math.nan


@dataclass(frozen=True)
class FailingDevice:
    """Drawn device that fails.

    Attributes:
        quantities: values of the quantities with tolerances, in SI units.
        distance: largest deviation from the stated values, in tolerances; 1 is the end of a uniform
            tolerance, and three standard deviations of a normal one.
        start: phase and tilt at touch-down of a failing run, and its base if it is not its own.
    """

    quantities: Mapping[str, float]
    distance: float
    start: Mapping[str, float]


def distribution(name: str, value: float, tolerance: Tolerance) -> Any:
    """Return the scipy distribution of a quantity in SI units, cut off at its admissible values."""
    least = {"> 0": 1e-6 * abs(value), ">= 0": 0.0, "": -math.inf}[bound_of(name)]
    most = 1.0 if name == "restitution" else math.inf
    width = tolerance.around(value)
    if tolerance.kind == "uniform":
        low, high = max(value - width, least), min(value + width, most)
        return scipy.stats.uniform(low, high - low)
    ends = (least - value) / width, (most - value) / width
    return scipy.stats.truncnorm(*ends, loc=value, scale=width)


def from_unit_cube(stated: StatedDevice, points: Floats) -> dict[str, Floats]:
    """Return the quantities with tolerances at ``points`` of the unit cube, shape (n, d)."""
    return {
        name: np.asarray(distribution(name, stated.quantities[name], tolerance).ppf(column))
        for (name, tolerance), column in zip(stated.tolerances.items(), points.T, strict=True)
    }


def drawn(stated: StatedDevice, count: int, seed: int = 0) -> dict[str, Floats]:
    """Return quantities of ``count`` devices, a power of two, drawn as scrambled Sobol' points."""
    points = scipy.stats.qmc.Sobol(len(stated.tolerances), rng=np.random.default_rng(seed))
    return from_unit_cube(stated, points.random(count))


def check_devices(count: float) -> int:
    """Return a number of devices as an integer.

    Raises:
        ValueError: it is no power of two, which Sobol' points need.
    """
    if count != int(count) or count < 2 or int(count) & (int(count) - 1):
        raise ValueError(f"devices = {count:g}: must be a power of two, 2 or more")
    return int(count)


def yield_of(
    stated: StatedDevice | Path | str,
    starts: Starts | None = None,
    settings: Settings | None = None,
    cores: int = 1,
    *,
    devices: int = DEVICES,
    seed: int = 0,
    indices: bool = True,
) -> tuple[Yield, DeviceResults]:
    """Return the yield of a device with tolerances, and the results of the drawn devices.

    The starts, on every base if none is stated, are those of the study by default; the settings the
    defaults in the insertion scene.
    Without ``indices`` no Sobol' indices are computed.

    Raises:
        ValueError: a device without tolerances, or a number that is no power of two.
    """
    if not isinstance(stated, StatedDevice):
        stated = load_device(stated)
    settings = settings or Settings(scene=INSERTION)
    if starts is None:
        stated = in_worst_approach(stated, settings, Ensemble(), cores)
        starts = cases_of(stated, Ensemble(), varied=stated.tolerances)
    if not stated.tolerances:
        raise ValueError(f"{stated.source}: no quantity has a tolerance, such as 10 N ± 5 %")
    check_devices(devices)
    results = run_devices(stated, drawn(stated, devices, seed), starts, settings, cores)
    inside = int(results.inside.sum())
    results = results[~results.inside]
    counted = devices - inside
    going_in, runs = int(results.goes_in.sum()), devices * len(starts)
    low, high = interval(going_in, counted)
    largest = results.largest
    if "vibration" in stated.limits and counted:
        needs = need_vibration(stated, results.values, settings, cores)
        largest["vibration"] = float(needs.mean())
    sobol: tuple[SobolIndices, ...] = ()
    if indices and going_in:
        some = starts[::INDEX_STARTS]
        sobol = sobol_indices_of(stated, some, settings, cores, seed=seed)
        runs += INDEX_POINTS * (len(stated.tolerances) + 2) * len(some)
    result = Yield(
        devices=counted,
        going_in=going_in,
        low=low,
        high=high,
        time=_quantiles(results.times.ravel()),
        force=_quantiles(results.force),
        runs=runs,
        sobol_indices=sobol,
        inside=inside,
        forces={place: float(each.max(initial=0.0)) for place, each in results.forces.items()},
        insertion=_quantiles(results.insertion),
        largest=largest,
    )
    return result, results


def nearest_failing(
    stated: StatedDevice, results: DeviceResults, starts: Starts
) -> FailingDevice | None:
    """Return the failing device that is nearest to the stated values, None if none fails."""
    if results.goes_in.all():
        return None
    distance = np.stack([
        np.abs(results.values[name] - stated.quantities[name]) / each.end(stated.quantities[name])
        for name, each in stated.tolerances.items()
    ]).max(axis=0)  # fmt: skip
    nearest = int(np.argmin(np.where(results.goes_in, np.inf, distance)))
    values = {name: float(column[nearest]) for name, column in results.values.items()}
    start = stated_case(stated.changed(**values), starts[results.failing[nearest]])
    return FailingDevice(values, float(distance[nearest]), start)


def interval(successes: int, count: int) -> tuple[float, float]:
    """Return Wilson's interval of a share, of 95 % confidence; (0, 1) of none."""
    if not count:
        return 0.0, 1.0
    ends = scipy.stats.binomtest(successes, count).proportion_ci(CONFIDENCE, method="wilson")
    return float(ends.low), float(ends.high)


def sobol_indices_of(
    stated: StatedDevice, starts: Starts, settings: Settings, cores: int = 1, *, seed: int = 0
) -> tuple[SobolIndices, ...]:
    """Return the indices of every quantity with a tolerance, the largest total of failure first.

    Failure is 1 or 0 for a device. Devices that do not go in are given the mean time of the others,
    so that they have no part in the variance of the time.
    """
    names = list(stated.tolerances)
    size = len(names)
    points = sobol_cubes(size, INDEX_POINTS, seed).reshape(-1, size)
    results = run_devices(stated, from_unit_cube(stated, points), starts, settings, cores)
    known = np.isfinite(results.time)
    usual = float(results.time[known].mean()) if known.any() else 0.0
    time: Floats = np.where(known, results.time, usual)
    fails = np.where(results.goes_in, 0.0, 1.0)
    columns = np.concatenate(
        [sobol_indices(each.reshape(size + 2, INDEX_POINTS)) for each in (fails, time)]
    )
    indices = []
    for name, column in zip(names, columns.swapaxes(0, 1), strict=True):
        failure, failure_total, time_first, time_total = map(float, column[:, 0])
        ends = tuple((float(low), float(high)) for low, high in column[:, 1:])
        indices.append(SobolIndices(name, failure, failure_total, time_first, time_total, ends))

    def largest_first(each: SobolIndices) -> tuple[float, float]:
        return -np.nan_to_num(each.failure_total), -np.nan_to_num(each.time_total)

    return tuple(sorted(indices, key=largest_first))


def sobol_cubes(size: int, count: int, seed: int) -> Floats:
    """Return the points of Saltelli's scheme A, B, AB_1, …, AB_d, shape (d + 2, count, d)."""
    both = scipy.stats.qmc.Sobol(2 * size, rng=np.random.default_rng(seed)).random(count)
    a, b = both[:, :size], both[:, size:]
    mixed = [np.where(np.arange(size) == i, b, a) for i in range(size)]
    return np.stack([a, b, *mixed])


def sobol_indices(f: Floats) -> Floats:
    """Return first-order and total Sobol' indices and their intervals, NaN without variance.

    ``f``, shape (d + 2, n), holds the values of a function on ``sobol_cubes``. The result, shape
    (2, d, 3), holds of each the index and the ends of its interval.
    """
    if np.ptp(f[:2]) == 0.0:
        return np.full((2, len(f) - 2, 3), np.nan)
    if len(f) == 3:  # one quantity, which scipy refuses
        return np.ones((2, 1, 3))
    values = {"f_A": f[None, 0], "f_B": f[None, 1], "f_AB": f[2:, None]}
    indices = scipy.stats.sobol_indices(func=values, n=f.shape[1], rng=np.random.default_rng(0))
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of quantities without effect, whose interval is a point
        spread = indices.bootstrap(confidence_level=CONFIDENCE)
    both = (indices.first_order, spread.first_order), (indices.total_order, spread.total_order)
    rows = [(index, *each.confidence_interval) for index, each in both]
    found = np.array([[np.ravel(column) for column in row] for row in rows]).swapaxes(1, 2)
    return np.where(np.isnan(found), found[..., :1], found)


def _quantiles(values: Floats) -> tuple[float, float, float]:
    finite = values[np.isfinite(values)]
    if not finite.size:
        return math.nan, math.nan, math.nan
    low, middle, high = np.quantile(finite, QUANTILES)
    return float(low), float(middle), float(high)
