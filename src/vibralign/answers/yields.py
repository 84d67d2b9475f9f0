"""Yield of a device with tolerances: the share of devices that go in in every case.

Devices are drawn as scrambled Sobol' points through the inverse of each quantity's distribution.
One that starts inside the hole needs no alignment: it is drawn, and not counted. One whose chamfers
meet the hole's goes in under the press, and counts. The interval of the share is Wilson's for
independent draws, wider than that of Sobol' points. Sobol' indices say how much of the variance of
failure and of time is due to which tolerance; their interval is that of a bootstrap.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
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
from vibralign.answers.reliability import (
    DeviceResults,
    Floats,
    joined,
    need_vibration,
    run_devices,
)
from vibralign.device import StatedDevice, Tolerance
from vibralign.device.limits import of_vibrator
from vibralign.device.runs import AnyDevice, stated_of

CONFIDENCE = 0.95
QUANTILES = (0.05, 0.5, 0.95)
DEVICES = 4096  # a power of two
DIGITS = 6  # of the values of a drawn device
INDEX_POINTS = 256  # points of the Sobol' indices, a power of two
INDEX_STARTS = 4, 12  # the indices take every fourth start, and at most twelve
STAGE = 64  # devices after which the yield is estimated first
POOR, WIDE = 0.95, 0.1  # a yield is known if its interval is below POOR and narrower than WIDE
WIDEST = 0.6  # interval of an index that is known
_BLAMED = 0.05  # index from which a tolerance is named


@dataclass(frozen=True, eq=False, repr=False)
class SobolIndices(Value):
    """Total Sobol' indices of one quantity: of failure, and of time; at most 1.

    The share of the variance in which the quantity has a part, alone or with others. NaN where
    there is no variance: no device fails, or all do; or where the interval is wider than
    ``WIDEST``: not known.
    """

    quantity: str
    failure: float
    time: float


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
        impossible: number of devices drawn that are impossible (no play, a negative friction …);
            they count as not going in.
        forces: largest contact force of these devices by the place.
        insertion: 5, 50 and 95 % quantiles over these of the longest time until inserted.
        confidence: level of confidence of the intervals.
        largest: longest "time" until alignment, largest "contact_force" and "tilt" of these, and
            "acceleration" and "stroke" of their vibrator; if a limit asks for it, the share that
            needs "vibration" to align.
        on_chamfers: number of devices that go in as their chamfers meet the hole's: the press alone
            brings them in.
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
    impossible: int = 0
    on_chamfers: int = 0

    def __repr__(self) -> str:
        ends = f"{100.0 * self.low:.4g} to {100.0 * self.high:.4g} %"
        return f"<Yield: {100.0 * self.share:.4g} % ({ends}) of {self.devices:,} devices>"

    @property
    def blame(self) -> str:
        """The tolerances to blame, by their total Sobol' indices, in words; empty without any."""
        parts = []
        for of in ("failure", "time"):
            indices = {each.quantity: getattr(each, of) for each in self.sobol_indices}
            known = {name: each for name, each in indices.items() if each >= _BLAMED}
            most = sorted(known, key=lambda name: -known[name])[:3]
            words = ", ".join(f"{name} {100.0 * known[name]:.0f} %" for name in most)
            name = "failures" if of == "failure" else "the spread of times"
            parts += [f"of {name}: {words}"] if words else []
        failed = self.devices - self.going_in
        if self.sobol_indices and failed and not (parts and parts[0].startswith("of failures")):
            parts.insert(
                0, f"too few of one kind to blame a tolerance: {failed:,} fail of {self.devices:,}"
            )
        return "; ".join(parts)

    def meets(self, required: float) -> bool:
        """Return whether the yield is at least this, with confidence; true if all start inside."""
        return not self.devices or self.low >= required

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


def distribution(value: float, tolerance: Tolerance) -> Any:
    """Return the scipy distribution of a quantity in SI units."""
    width = tolerance.around(value)
    if tolerance.kind == "uniform":
        return scipy.stats.uniform(value - width, 2.0 * width)
    return scipy.stats.norm(value, width)


def from_unit_cube(stated: StatedDevice, points: Floats) -> dict[str, Floats]:
    """Return the quantities with tolerances at ``points`` of the unit cube, shape (n, d).

    They have ``DIGITS`` digits in the unit in which they are stated, as they are printed. The sign
    of a misalignment is dropped: both sides of the hole are alike.
    """
    found = {}
    for (name, tolerance), column in zip(stated.tolerances.items(), points.T, strict=True):
        _, one = stated.written.get(name, ("", 1.0))
        values = np.asarray(distribution(stated.quantities[name], tolerance).ppf(column)) / one
        found[name] = np.array([float(f"{each:.{DIGITS}g}") * one for each in values.tolist()])
    if "misalignment" in found:
        found["misalignment"] = np.abs(found["misalignment"])
    return found


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
    stated: AnyDevice,
    starts: Starts | None = None,
    settings: Settings | None = None,
    cores: int = 1,
    *,
    devices: int = DEVICES,
    seed: int = 0,
    indices: bool = True,
    required: float | None = None,
) -> tuple[Yield, DeviceResults]:
    """Return the yield of a device with tolerances, and the results of the drawn devices.

    Args:
        stated: a device of a file, as ``simulate`` takes it.
        starts: None for those of the study, on every base if none is stated.
        settings: settings of the runs; None for the defaults, in the insertion scene.
        cores: number of threads.
        devices: most devices drawn, a power of two. Fewer are drawn once the interval of the yield
            is below ``POOR``, is narrower than ``WIDE``, and does not contain ``required``.
        seed: of the devices.
        indices: False to compute no Sobol' indices.
        required: yield that is asked for, None if none is.

    Raises:
        TypeError: a dimensionless device.
        ValueError: a device without tolerances, or a number that is no power of two.
    """
    stated = stated_of(stated)
    settings = settings or Settings(scene=INSERTION)
    if starts is None:
        stated = in_worst_approach(stated, settings, Ensemble(), cores)
        starts = cases_of(stated, Ensemble(), varied=stated.tolerances)
    if not stated.tolerances:
        raise ValueError(f"{stated.source}: no quantity has a tolerance, such as 10 N ± 5 %")
    check_devices(devices)
    some = starts[:: max(INDEX_STARTS[0], -(-len(starts) // INDEX_STARTS[1]))]
    of_indices = INDEX_POINTS * (len(stated.tolerances) + 1) * len(some) if indices else 0
    values, parts, done = drawn(stated, devices, seed), list[DeviceResults](), 0
    known = False
    while done < devices and not known:
        last = min(max(STAGE, 4 * done), devices)
        few = {name: column[done:last] for name, column in values.items()}
        parts.append(run_devices(stated, few, starts, settings, cores))
        known, done = _is_known(joined(parts), required), last
    results = joined(parts)
    inside, runs = int(results.inside.sum()), done * len(starts)
    results, counted = results[~results.inside], done - inside
    going_in = int(results.goes_in.sum())
    low, high = interval(going_in, counted)
    drive = [results.values.get(n, stated.quantities[n]) for n in ("amplitude", "frequency")]
    largest = results.largest | {n: float(np.max(v)) for n, v in of_vibrator(*drive).items()}
    if "vibration" in stated.limits and counted:
        possible = results[~results.impossible]
        needs = need_vibration(stated, possible.values, settings, cores) & ~possible.on_chamfers
        largest["vibration"] = float(needs.mean())
    sobol: tuple[SobolIndices, ...] = ()
    if indices and going_in:
        sobol = sobol_indices_of(stated, some, settings, cores, seed=seed)
        runs += of_indices
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
        on_chamfers=int(results.on_chamfers.sum()),
        forces={
            place: float(np.fmax.reduce(each, initial=0.0))
            for place, each in results.forces.items()
        },
        insertion=_quantiles(results.insertion),
        largest=largest,
        impossible=int(results.impossible.sum()),
    )
    return result, results


def _is_known(results: DeviceResults, required: float | None) -> bool:
    """Return whether a yield is known well enough: surely poor, and above or below ``required``."""
    counted = results.goes_in[~results.inside]
    low, high = interval(int(counted.sum()), counted.size)
    decided = required is None or not low < required < high
    return high < POOR and high - low < WIDE and decided


def nearest_failing(
    stated: StatedDevice, results: DeviceResults, starts: Starts
) -> FailingDevice | None:
    """Return the failing device that is nearest to the stated values, None if none fails.

    Impossible devices are left out.
    """
    results = results[~results.impossible]
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
    columns = (total_indices(each.reshape(size + 1, INDEX_POINTS)) for each in (fails, time))
    indices = [SobolIndices(*each) for each in zip(names, *columns, strict=True)]

    def largest_first(each: SobolIndices) -> tuple[float, float]:
        return -np.nan_to_num(each.failure), -np.nan_to_num(each.time)

    return tuple(sorted(indices, key=largest_first))


def sobol_cubes(size: int, count: int, seed: int) -> Floats:
    """Return the points A, AB_1, …, AB_d of Saltelli's scheme, shape (d + 1, count, d)."""
    both = scipy.stats.qmc.Sobol(2 * size, rng=np.random.default_rng(seed)).random(count)
    a, b = both[:, :size], both[:, size:]
    mixed = [np.where(np.arange(size) == i, b, a) for i in range(size)]
    return np.stack([a, *mixed])


def total_indices(f: Floats) -> list[float]:
    """Return total Sobol' indices by Jansen's estimate, NaN without variance or if not known.

    ``f``, shape (d + 1, n), holds the values of a function on ``sobol_cubes``. The interval of an
    index is that of the mean of n squares (M. J. W. Jansen, Computer Physics Communications 117,
    1999, 35).
    """
    variance = float(f.var())
    if variance == 0.0:
        return [math.nan] * (len(f) - 1)
    squares = 0.5 * (f[1:] - f[0]) ** 2 / variance
    wide = 2.0 * scipy.stats.norm.ppf(0.5 + 0.5 * CONFIDENCE) / math.sqrt(f.shape[1])
    known = wide * squares.std(axis=1) <= WIDEST
    found: list[float] = np.where(known, np.minimum(squares.mean(axis=1), 1.0), np.nan).tolist()
    return found


def _quantiles(values: Floats) -> tuple[float, float, float]:
    finite = values[np.isfinite(values)]
    if not finite.size:
        return math.nan, math.nan, math.nan
    low, middle, high = np.quantile(finite, QUANTILES)
    return float(low), float(middle), float(high)
