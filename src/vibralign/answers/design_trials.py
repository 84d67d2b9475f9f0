"""Trials of a setting of a design: a quick one for the search, and the check that ``assess`` makes.

The quick trial takes the setting itself and ``POINTS`` devices drawn within the tolerances, each
from a quarter of the starts; from device to device the quarters differ. Where all go in, devices on
``LINES`` lines outwards are tried. It can accept a setting that fails. So a setting is checked
before it is recommended, by the devices that ``assess`` draws, from every start. One error is left,
on the safe side: a good setting that the quick trial refuses. A setting that exceeds a limit of the
vibrator is not run.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from model.physics.tables import Value
from model.runs.settings import Settings
from model.sweeps.starts import Starts
from vibralign.answers.cases import at_each_tilt
from vibralign.answers.reliability import (
    DeviceResults,
    Floats,
    are_reliable,
    counted,
    joined,
    need_vibration,
    run_devices,
)
from vibralign.answers.yields import DEVICES, STAGE, drawn, nearest_failing
from vibralign.device import StatedDevice
from vibralign.device.amounts import SIGMAS
from vibralign.device.batches import Values
from vibralign.device.limits import OF_VIBRATOR, of_vibrator
from vibralign.device.quantities import bound_of

POINTS = 16  # devices drawn within the tolerances of a setting, a power of two
LINES = 8  # on which the nearest failing device is sought
QUARTERS = 4  # the quick trial takes one start of every four
SCALES = (1.0, 2.0, 3.0)  # distances along a line that are tried, in tolerances
FARTHEST = SCALES[-1]
HALVINGS = 3  # a failure along a line is located to 1/8 of a tolerance
MEASURES = ("time", "contact_force", "tilt", "vibration", *OF_VIBRATOR)

Ints = NDArray[np.int64]


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
    """

    stated: StatedDevice
    starts: Starts
    settings: Settings
    cores: int = 1
    seed: int = 0
    devices: int = DEVICES

    def quick(self, points: Floats) -> list[Row]:
        """Return the results of settings, ``points`` in SI units of shape (n, free quantities)."""
        inner, lines = self._offsets()
        drive = self._of_vibrator(points)
        may = np.logical_and.reduce(
            [each <= self.stated.limits.get(name, math.inf) for name, each in drive.items()]
        )
        goes_in = np.full((len(points), len(inner)), np.nan)
        measures = {name: np.full(len(points), np.nan) for name in MEASURES[:3]}
        good, first = np.flatnonzero(may), 0
        for last in (1 + POINTS // 4, len(inner)):
            turns = np.arange(first, last)
            values = self._values(np.repeat(points[good], last - first, axis=0),
                                  np.tile(inner[first:last], (len(good), 1)))  # fmt: skip
            if not good.size:
                break
            results = self._run(values, np.tile(turns, len(good)))
            goes_in[good, first:last] = results.goes_in.reshape(len(good), -1)
            for name, each in results.measures.items():
                most = np.fmax.reduce(each.reshape(len(good), -1), axis=1)
                measures[name][good] = np.fmax(measures[name][good], most)
            good, first = good[np.nanmin(goes_in[good], axis=1) == 1.0], last
        tried = ~np.isnan(goes_in)
        share = np.where(may, np.nansum(goes_in, axis=1) / np.maximum(tried.sum(axis=1), 1), 0.0)
        failing = np.where(goes_in == 0.0, np.abs(inner).max(axis=1), FARTHEST)
        margin, needs = np.where(may, failing.min(axis=1), 0.0), np.full(len(points), np.nan)
        if good.size:
            outwards = np.full(good.size, FARTHEST)
            margin[good] = self._nearest_failure(points[good], lines, outwards, turn=len(inner))
            values = self._values(np.repeat(points[good], len(inner), axis=0),
                                  np.tile(inner, (len(good), 1)))  # fmt: skip
            needs[good] = self._needs_vibration(values, (len(good), len(inner)))
        columns = share, margin, *measures.values(), needs, *drive.values()
        return [tuple(float(each) for each in row) for row in zip(*columns, strict=True)]

    def _of_vibrator(self, points: Floats) -> dict[str, Floats]:
        """Return the most that settings need of the vibrator, at the ends of the tolerances too.

        Acceleration and stroke, shape (n,) each.
        """
        own, tolerances = self.stated.quantities, self.stated.tolerances
        of = {n: np.full(len(points), own[n]) for n in ("amplitude", "frequency")}
        of |= dict(zip(self.stated.free, points.T, strict=True))
        for name in of.keys() & tolerances.keys() & {"amplitude", "frequency"}:
            of[name] = of[name] + [tolerances[name].end(each) for each in of[name].tolist()]
        return of_vibrator(of["amplitude"], of["frequency"])

    def check(self, setting: Mapping[str, float]) -> Check:
        """Return the results of a setting (SI units by name) as ``assess`` has them.

        No further devices are drawn once the setting does not hold.
        """
        stated = self.stated.changed(**setting)
        values = {name: np.full(self.devices, value) for name, value in setting.items()}
        values |= drawn(stated, self.devices)
        itself = {name: np.array([stated.quantities[name]]) for name in values}
        starts = at_each_tilt(stated, self.starts)
        drive = self._of_vibrator(np.array([list(setting.values())]))
        of_vibrator = [float(each[0]) for each in drive.values()]
        if not are_reliable(stated, itself, starts, self.settings, self.cores)[0]:
            unknown = [math.nan] * (len(MEASURES) - len(of_vibrator))
            return Check((0.0, 0.0, *unknown, *of_vibrator), 0, 0)
        parts, done, holds = list[DeviceResults](), 0, True
        while holds and done < self.devices:
            last = min(max(STAGE, 4 * done), self.devices)
            some = {name: column[done:last] for name, column in values.items()}
            parts.append(self._run_from(stated, some, self.starts))
            holds, done = bool(self._is_good(parts[-1]).all()), last
        whole = joined(parts)
        if not whole.inside.all():  # what starts inside the hole is not counted
            whole = whole[~whole.inside]
        done = len(whole.goes_in)
        failing = nearest_failing(stated, whole, self.starts)
        if failing is None:
            point, (_, lines) = np.array([list(setting.values())]), self._offsets()
            margin = float(self._nearest_failure(point, lines, np.array([FARTHEST]))[0])
        else:
            margin = failing.distance
        possible = whole[~whole.impossible].values
        needs = float(self._needs_vibration(possible, (1, int((~whole.impossible).sum())))[0])
        going_in = int(whole.goes_in.sum())
        forces = {place: float(np.fmax.reduce(each)) for place, each in whole.forces.items()}
        largest = *whole.largest.values(), needs, *of_vibrator
        row = (going_in / done, margin, *largest)
        return Check(row, done, going_in, forces)

    def _is_good(self, results: DeviceResults) -> NDArray[np.bool_]:
        """Return which devices go in and keep the limits of time, force and tilt, if any."""
        limits = self.stated.limits
        kept = [~(each > limits.get(name, math.inf)) for name, each in results.measures.items()]
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
        return joined(parts, np.argsort(np.concatenate(rows)))

    def _run_from(self, stated: StatedDevice, values: Values, starts: Starts) -> DeviceResults:
        return run_devices(stated, values, starts, counted(self.settings), self.cores)

    def _needs_vibration(self, values: Values, shape: tuple[int, int]) -> Floats:
        """Return for each setting the share of devices that do not align without vibration.

        ``shape`` is (settings, devices). The shares are NaN unless a limit asks for them.
        """
        if "vibration" not in self.stated.limits:
            return np.full(shape[0], np.nan)
        needs = need_vibration(self.stated, values, counted(self.settings), self.cores)
        shares: Floats = needs.reshape(shape).mean(axis=1)
        return shares

    def _nearest_failure(
        self, points: Floats, lines: Floats, margin: Floats, turn: int | None = None
    ) -> Floats:
        """Return the margins of settings by failures on ``lines``, at most ``margin``.

        The search goes outwards until a device fails, and then halves the interval. ``turn`` is
        that of the first line; None for all starts.
        """
        low, high = np.zeros((2, len(points), len(lines)))
        high += np.inf
        for further in (*SCALES, *[None] * HALVINGS):
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
            own, at = values[name], offsets[:, i]
            width = np.array([tolerance.end(value) for value in own.tolist()])
            beyond = (np.abs(at) > 1.0) & (name not in ("clearance", "play"))
            bounded = beyond & bool(bound_of(name) or name == "press_force")
            values[name] = np.maximum(own + width * at, np.where(bounded, 1e-3 * own, -np.inf))
        if "misalignment" in values:
            values["misalignment"] = np.abs(values["misalignment"])
        return values

    def _offsets(self) -> tuple[Floats, Floats]:
        """Return offsets of devices from a setting, in tolerances, and directions of lines.

        The devices are the setting itself and ``POINTS`` drawn ones; there are ``LINES`` lines.
        """
        size = len(self.stated.tolerances)
        cube = stats.qmc.Sobol(size, rng=np.random.default_rng(self.seed)).random(POINTS)
        around = 2.0 * cube - 1.0
        lines = (around / np.abs(around).max(axis=1, keepdims=True))[:LINES]
        normal = [each.kind == "normal" for each in self.stated.tolerances.values()]
        around[:, normal] = stats.norm.ppf(cube[:, normal]) / SIGMAS
        return np.concatenate([np.zeros((1, size)), around]), lines
