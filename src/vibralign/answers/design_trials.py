"""Trials of a setting of a design: a quick one for the search, and the check that ``assess`` makes.

The quick trial takes ``POINTS`` devices drawn within the tolerances, and as many lines outwards,
each from a quarter of the starts; from device to device the quarters differ. It can accept a
setting that fails. So a setting is checked before it is recommended, by the devices that ``assess``
draws, from every start. One error is left, on the safe side: a good setting that the quick trial
refuses.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from model.physics.tables import Value
from model.runs.settings import Settings
from model.sweeps.starts import Starts
from vibralign.answers.reliability import (
    STATISTICAL_TOLERANCE,
    DeviceResults,
    Floats,
    are_reliable,
    need_vibration,
    run_devices,
)
from vibralign.answers.yields import DEVICES, drawn, nearest_failing
from vibralign.device import StatedDevice
from vibralign.device.amounts import SIGMAS
from vibralign.device.batches import Values
from vibralign.device.stated import bound_of

POINTS = 16  # devices drawn within the tolerances of a setting, a power of two
QUARTERS = 4  # the quick trial takes one start of every four
SCALES = (1.0, 2.0, 3.0)  # distances along a line that are tried, in tolerances
FARTHEST = SCALES[-1]
HALVINGS = 3  # a failure along a line is located to 1/8 of a tolerance
STAGE = 64  # devices after which a check first looks whether a setting holds
MEASURES = ("time", "contact_force", "tilt", "vibration")

Ints = NDArray[np.int64]


class SpentError(Exception):
    """No further runs may be taken."""


@dataclass
class Runs:
    """Count of the runs that trials take.

    Attributes:
        most: number of runs that may be taken.
        taken: number of runs so far.
    """

    most: float = math.inf
    taken: int = 0

    def take(self, number: int) -> None:
        """Count runs before they begin.

        Raises:
            SpentError: there would be more than ``most``; they are not counted.
        """
        if self.taken + number > self.most:
            raise SpentError
        self.taken += number


Row = tuple[float, ...]
"""Results of a setting: share, margin, and ``MEASURES``."""


@dataclass(frozen=True, eq=False, repr=False)
class Check(Value):
    """Results of a setting by the devices and starts of ``assess``.

    Attributes:
        row: its results; a share of 0 if the device itself does not go in.
        devices: number of devices drawn; fewer than asked for once the setting does not hold.
        going_in: number of them that go in from every start.
        forces: largest contact force in N by the place.
    """

    row: Row
    devices: int
    going_in: int
    forces: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Trials:
    """Trials of the settings of a device.

    Attributes:
        stated: device with free quantities and tolerances.
        starts: phases and tilts at touch-down.
        settings: settings of the runs.
        cores: number of threads.
        seed: seed of the devices of the quick trial.
        devices: number of devices of a check, a power of two.
        runs: count of the runs that are taken.
    """

    stated: StatedDevice
    starts: Starts
    settings: Settings
    cores: int = 1
    seed: int = 0
    devices: int = DEVICES
    runs: Runs = field(default_factory=Runs, compare=False)

    def quick(self, points: Floats) -> list[Row]:
        """Return the results of settings, ``points`` in SI units of shape (n, free quantities)."""
        inner, lines = self._offsets()
        shape = len(points), len(inner)
        centres, offsets = np.repeat(points, len(inner), axis=0), np.tile(inner, (len(points), 1))
        values = self._values(centres, offsets)
        results = self._run(values, np.tile(np.arange(len(inner)), len(points)))
        goes_in = results.goes_in.reshape(shape)
        margin = np.where(goes_in, FARTHEST, np.abs(inner).max(axis=1)).min(axis=1)
        on_lines = goes_in[:, -len(lines) :]
        margin = self._nearest_failure(points, lines, on_lines, margin, 1 + POINTS)
        measures = [
            np.fmax.reduce(each.reshape(shape), axis=1) for each in results.measures.values()
        ]
        share = goes_in[:, : 1 + POINTS].mean(axis=1)
        columns = share, margin, *measures, self._needs_vibration(values, shape)
        return [tuple(float(each) for each in row) for row in zip(*columns, strict=True)]

    def check(self, setting: Mapping[str, float], *, stop: bool = True) -> Check:
        """Return the results of a setting (SI units by name) as ``assess`` has them.

        With ``stop`` no further devices are drawn once the setting does not hold.
        """
        stated = self.stated.changed(**setting)
        values = {name: np.full(self.devices, value) for name, value in setting.items()}
        values |= drawn(stated, self.devices)
        _keep_on_edge(stated, values)
        itself = {name: np.array([stated.quantities[name]]) for name in values}
        self.runs.take(len(self.starts))
        if not are_reliable(stated, itself, self.starts, self.settings, self.cores)[0]:
            return Check((0.0, 0.0, *[math.nan] * len(MEASURES)), 0, 0)
        parts, done, holds = list[DeviceResults](), 0, True
        while holds and done < self.devices:
            last = min(max(STAGE, 4 * done), self.devices)
            some = {name: column[done:last] for name, column in values.items()}
            parts.append(self._run_from(stated, some, self.starts))
            holds, done = not stop or bool(self._is_good(parts[-1]).all()), last
        whole = _joined(parts)
        if not whole.inside.all():  # what starts inside the hole is not counted
            whole = whole[~whole.inside]
        done = len(whole.goes_in)
        failing = nearest_failing(stated, whole, self.starts)
        if failing is None:
            margin = self._margin_from_every_start(np.array([list(setting.values())]))
        else:
            margin = failing.distance
        needs = float(self._needs_vibration(whole.values, (1, done))[0])
        going_in = int(whole.goes_in.sum())
        forces = {place: float(np.fmax.reduce(each)) for place, each in whole.forces.items()}
        row = (going_in / done, margin, *whole.largest.values(), needs)
        return Check(row, done, going_in, forces)

    @property
    def _statistical(self) -> Settings:
        """Settings of runs of which many are counted, as in ``assess``."""
        least = max(self.settings.tolerance, STATISTICAL_TOLERANCE)
        return replace(self.settings, tolerance=least)

    def _is_good(self, results: DeviceResults) -> NDArray[np.bool_]:
        """Return which devices go in and keep the limits of time, force and tilt."""
        limits = self.stated.limits
        kept = [each <= limits.get(name, math.inf) for name, each in results.measures.items()]
        good: NDArray[np.bool_] = np.logical_and.reduce([results.goes_in, *kept])
        return good

    def _run(self, values: Values, turns: Ints | None) -> DeviceResults:
        """Run devices, each from the quarter of the starts in ``turns``; from all for None."""
        quarters = 1 if turns is None else min(QUARTERS, len(self.starts))
        turn = np.zeros(len(next(iter(values.values()))), dtype=int) if turns is None else turns
        parts, rows = [], []
        for quarter in range(quarters):
            own = np.flatnonzero(turn % quarters == quarter)
            if own.size:
                some = {name: column[own] for name, column in values.items()}
                starts = self.starts[quarter::quarters]
                parts.append(self._run_from(self.stated, some, starts))
                rows.append(own)
        return _joined(parts, np.argsort(np.concatenate(rows)))

    def _run_from(self, stated: StatedDevice, values: Values, starts: Starts) -> DeviceResults:
        self.runs.take(len(next(iter(values.values()))) * len(starts))
        return run_devices(stated, values, starts, self._statistical, self.cores)

    def _needs_vibration(self, values: Values, shape: tuple[int, int]) -> Floats:
        """Return the shares of devices, shape (settings, devices), not in without vibration.

        NaN unless a limit asks for them.
        """
        if "vibration" not in self.stated.limits:
            return np.full(shape[0], np.nan)
        self.runs.take(shape[0] * shape[1])
        needs = need_vibration(self.stated, values, self._statistical, self.cores)
        shares: Floats = needs.reshape(shape).mean(axis=1)
        return shares

    def _margin_from_every_start(self, point: Floats) -> float:
        """Return the margin of a setting, shape (1, free quantities), by failures on the lines."""
        _, lines = self._offsets()
        values = self._values(np.repeat(point, len(lines), axis=0), lines)
        goes_in = self._run(values, None).goes_in[None]
        return float(self._nearest_failure(point, lines, goes_in, np.array([FARTHEST]))[0])

    def _nearest_failure(
        self,
        points: Floats,
        lines: Floats,
        goes_in: NDArray[np.bool_],
        margin: Floats,
        turn: int | None = None,
    ) -> Floats:
        """Return the margins of settings by failures on ``lines``, at most ``margin``.

        The search goes outwards until a device fails, and then halves the interval. ``goes_in``,
        shape (n, lines), is the result at one tolerance. ``turn`` is that of the first line; None
        for all starts.
        """
        low, high = np.where(goes_in, 1.0, 0.0), np.where(goes_in, np.inf, 1.0)
        for further in (*SCALES[1:], *[None] * HALVINGS):
            open_ones = np.isinf(high) if further else np.isfinite(high)
            row, line = np.nonzero(open_ones & (low < margin[:, None]))
            if not row.size:
                continue
            at = np.full(row.size, further) if further else 0.5 * (low + high)[row, line]
            values = self._values(points[row], lines[line] * at[:, None])
            results = self._run(values, None if turn is None else line + turn)
            low[row, line] = np.where(results.goes_in, at, low[row, line])
            high[row, line] = np.where(results.goes_in, high[row, line], at)
            margin = np.minimum(margin, high.min(axis=1))
        return margin

    def _values(self, points: Floats, offsets: Floats) -> dict[str, Floats]:
        """Return the quantities of devices at ``offsets``, in tolerances, from settings."""
        names = list(dict.fromkeys((*self.stated.free, *self.stated.tolerances)))
        values = {name: np.full(len(points), self.stated.quantities[name]) for name in names}
        values |= dict(zip(self.stated.free, points.T, strict=True))
        for i, (name, tolerance) in enumerate(self.stated.tolerances.items()):
            own = values[name]
            width = np.array([tolerance.end(value) for value in own.tolist()])
            positive = bound_of(name) or name == "press_force"
            least = 1e-3 * own if positive else -np.inf
            values[name] = np.maximum(own + width * offsets[:, i], least)
        _keep_on_edge(self.stated, values)
        return values

    def _offsets(self) -> tuple[Floats, Floats]:
        """Return offsets of devices from a setting, in tolerances, and directions of lines.

        The devices are the setting itself, ``POINTS`` drawn ones, and the ends of as many lines.
        """
        size = len(self.stated.tolerances)
        cube = stats.qmc.Sobol(size, rng=np.random.default_rng(self.seed)).random(POINTS)
        around = 2.0 * cube - 1.0
        lines = around / np.abs(around).max(axis=1, keepdims=True)
        normal = [each.kind == "normal" for each in self.stated.tolerances.values()]
        around[:, normal] = stats.norm.ppf(cube[:, normal]) / SIGMAS
        return np.concatenate([np.zeros((1, size)), around, lines]), lines


def _joined(parts: Sequence[DeviceResults], order: Ints | None = None) -> DeviceResults:
    """Return the results of all parts, in another order of the devices if it is given.

    ``times`` holds the longest time of a device only, shape (n, 1).
    """

    def join(name: str) -> Any:
        columns = [getattr(part, name) for part in parts]
        if isinstance(columns[0], Mapping):
            return {key: np.concatenate([each[key] for each in columns]) for key in columns[0]}
        return np.concatenate(columns)

    names = [each.name for each in fields(DeviceResults) if each.name != "times"]
    whole = DeviceResults(times=join("time")[:, None], **{name: join(name) for name in names})
    return whole if order is None else whole[order]


def _keep_on_edge(stated: StatedDevice, values: dict[str, Floats]) -> None:
    """Cut misalignments off at the largest with which the part starts on the edge.

    With a larger one it cannot go in anyway.
    """
    if "misalignment" in values:
        sizes = {n: values.get(n, stated.quantities[n]) for n in ("half_width", "clearance")}
        most = 0.999 * sizes["half_width"] * (2.0 + sizes["clearance"])
        values["misalignment"] = np.minimum(values["misalignment"], most)
