"""Settings of a device that is known in part: the one that covers most of what is possible.

Settings are Sobol' points of the free ranges, then points around the best, tried by a few sets and
touch-downs. The best is then tried as ``known_in_part`` does. *Knowing everything* would let each
set have a setting of its own: what that adds to the share of the best setting is an upper bound of
what any trial can add.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from model.events.insertion import INSERTION
from model.physics.tables import Value
from model.runs.settings import Settings
from vibralign.answers.design import DIGITS
from vibralign.answers.reliability import Floats
from vibralign.device import StatedDevice
from vibralign.known.possible import (
    SETS,
    Possible,
    Sets,
    exceeds_vibrator,
    known_in_part,
    run_sets,
    sets_of,
    stated,
    touch_downs,
)

COUNT = 32  # settings of the first round, a power of two
FEW_SETS, FEW_TOUCH_DOWNS = 64, 16  # by which a setting is tried, powers of two
CHECKED = 3  # settings that are tried by all sets
NOTHING = 0.01  # what knowing everything adds, below which no trial is worth making
_NEAR = 0.15  # of the ranges, around the best

Setting = Mapping[str, float]


class Tried(NamedTuple):
    """Results of settings; c settings, n sets, m touch-downs.

    Attributes:
        settings: values by name in SI units.
        times: alignment times in s, NaN where it fails, shape (c, n, m).
        reliable: where the device is reliable, shape (c, n).
    """

    settings: list[Setting]
    times: Floats
    reliable: NDArray[np.bool_]

    @property
    def order(self) -> NDArray[np.int64]:
        """Numbers of the settings, the best first: reliable for most, then fastest."""
        longest = np.nan_to_num(self.times, nan=np.inf).max(axis=2)
        found: NDArray[np.int64] = np.lexsort(
            (np.median(longest, axis=1), -self.reliable.mean(axis=1))
        )
        return found

    @property
    def knowing_adds(self) -> float:
        """Share of what is possible that knowing everything would add to the best setting."""
        best = float(self.reliable.mean(axis=1).max())
        return float(self.reliable.any(axis=0).mean()) - best

    def with_others(self, other: "Tried") -> "Tried":
        """Return the results of these settings and others."""
        both = [np.concatenate(pair) for pair in zip(self[1:], other[1:], strict=True)]
        return Tried([*self.settings, *other.settings], *both)


def try_settings(
    device: StatedDevice,
    settings_tried: Sequence[Setting],
    sets: Sets,
    settings: Settings,
    cores: int = 1,
    tell: Callable[[str], None] = lambda _: None,
) -> Tried:
    """Run sets at settings, from ``FEW_TOUCH_DOWNS`` touch-downs."""
    times, reliable = [], []
    for number, setting in enumerate(settings_tried):
        tell(f"setting {number + 1} of {len(settings_tried)}")
        own = device.changed(**setting)
        runs = run_sets(own, sets, touch_downs(own, FEW_TOUCH_DOWNS), settings, cores)
        times.append(runs.time)
        reliable.append(runs.reliable(device.limits) & (not exceeds_vibrator(own)))
    return Tried([*settings_tried], np.array(times), np.array(reliable))


def settings_in(
    device: StatedDevice, count: int, around: Setting | None = None, seed: int = 3
) -> list[Setting]:
    """Return settings within the free ranges, or near one, with the digits that are printed."""
    low, high = np.array([*device.free.values()]).T
    points = scipy.stats.qmc.Sobol(low.size, rng=np.random.default_rng(seed)).random(count)
    if around is not None:
        middle = (np.array([around[name] for name in device.free]) - low) / (high - low)
        points = np.clip(middle + _NEAR * (2.0 * points - 1.0), 0.0, 1.0)
    values = low + points * (high - low)
    return [
        {name: float(f"{each:.{DIGITS}g}") for name, each in zip(device.free, row, strict=True)}
        for row in values.tolist()
    ]


@dataclass(frozen=True, eq=False, repr=False)
class Covering(Value):
    """The setting that covers most of what is possible.

    Attributes:
        setting: values by name in SI units.
        possible: verdict at the setting.
        knowing_adds: share that knowing everything would add, by the settings tried.
        tried: number of settings tried.
    """

    setting: Setting
    possible: Possible
    knowing_adds: float
    tried: int


def covering(
    device: StatedDevice | Path | str,
    settings: Settings | None = None,
    cores: int = 1,
    tell: Callable[[str], None] = lambda _: None,
    *,
    count: int = COUNT,
    sets: int = SETS,
) -> Covering:
    """Return the setting of the free quantities that is reliable for most of what is possible.

    Args:
        device: as for ``known_in_part``, with free quantities.
        settings: as for ``known_in_part``.
        cores: number of threads.
        tell: called with the step, in words.
        count: settings of the first round, a power of two; two more, around the best, have half.
        sets: sets of the unknowns by which the best are tried, a power of two.

    Raises:
        ValueError: nothing is free, or as ``known_in_part``.
    """
    device, settings = stated(device), settings or Settings(scene=INSERTION)
    if not device.free:
        raise ValueError(
            f"{device.source}: nothing is free; state free: {{press_force: 5 to 20 N}}"
        )
    few = sets_of(device, min(sets, FEW_SETS))
    found = try_settings(device, settings_in(device, count), few, settings, cores, tell)
    for number in range(2):
        best = found.settings[int(found.order[0])]
        near = settings_in(device, count // 2, best, seed=4 + number)
        found = found.with_others(try_settings(device, near, few, settings, cores, tell))
    checked = []
    for number, row in enumerate(found.order[:CHECKED].tolist()):
        tell(f"check {number + 1} of {CHECKED}")
        own = device.changed(**found.settings[row])
        checked.append((row, known_in_part(own, settings, cores, sets=sets)))
    row, possible = min(checked, key=_rank)
    adds = float(found.reliable.any(axis=0).mean() - found.reliable[row].mean())
    return Covering(found.settings[row], possible, adds, len(found.settings))


def _rank(checked: tuple[int, Possible]) -> tuple[float, float]:
    possible = checked[1]
    longest = np.median(np.nan_to_num(possible.longest, nan=np.inf))
    return -possible.share, float(longest)
