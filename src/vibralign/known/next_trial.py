"""Next step: the trial or the bench test that takes most of the doubt away.

The outcome of a trial is a class: fails, or one of ``CLASSES`` of time. A trial is worth the mutual
information between its class and the verdict at the intended setting, over the sets that the trials
so far leave possible (D. V. Lindley, Annals of Mathematical Statistics 27, 1956, 986). A bench
test measures an unknown to a tenth of its range; its worth is the mutual information between its
reading and the verdict, in the same bits. If quantities are free, the intended setting is the one
that is reliable for most of what is possible; no trial is worth making if knowing everything adds
less than ``NOTHING`` to that share.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.runs.settings import Settings
from vibralign.answers.reliability import Floats
from vibralign.device import StatedDevice
from vibralign.device.instead import INSTEAD
from vibralign.known.doubt import entropy, unknowns_of
from vibralign.known.possible import (
    TOUCH_DOWNS,
    Sets,
    exceeds_vibrator,
    run_sets,
    touch_downs,
)
from vibralign.known.settings import NOTHING, Setting, settings_in, try_settings

CLASSES = 5  # of the times of a trial
SETS = 128  # sets by which a trial is judged, a power of two
COUNT = 16  # settings within the free ranges, a power of two
NOISE = 0.02  # bits: a trial tells less of 95 in 100 shuffled verdicts
_SMOOTH = 0.04  # share of all classes that the touch-downs tried have not shown

# How an unknown is measured at the bench.
BENCH: Mapping[str, str] = {
    "friction": "tilt the parts until one slides on the other",
    "axial_stiffness": "push the holder, or tap it: natural frequency along the axis",
    "lateral_stiffness": "push the holder, or tap it: natural frequency across the axis",
    "tilt_stiffness": "push the holder at a height, or tap it: natural frequency of the tilt",
    "mass": "weigh what moves",
    "inertia": "swing it on the tilt spring: period",
    "gripper_tilt": "gauge the tilt of the part in the gripper",
    "misalignment": "gauge the axes at the mouth",
    "amplitude": "accelerometer at the holder",
    "restitution": "drop a ball: ratio of heights",
    "clearance": "gauge part and hole",
    "contact_stiffness": "press the part on its base: force over displacement",
}


class Worth(NamedTuple):
    """Worth of a trial or a bench test.

    Attributes:
        words: the setting, or the test.
        bits: doubt of the verdict that it takes away.
        setting: of a trial, values by name in SI units; empty for a bench test.
    """

    words: str
    bits: float
    setting: Setting


@dataclass(frozen=True)
class Next:
    """Verdict at the intended setting, and what to do next.

    Attributes:
        intended: the intended setting; empty if it is that of the file.
        share: share of what is possible for which it is reliable.
        knowing_adds: share that knowing everything adds; NaN if nothing is free.
        trials: trials, the one that is worth most first.
        bench: bench tests, likewise.
    """

    intended: Setting
    share: float
    knowing_adds: float
    trials: tuple[Worth, ...]
    bench: tuple[Worth, ...]

    @property
    def doubt(self) -> float:
        """Doubt of the verdict, in bits."""
        return float(entropy(self.share))

    @property
    def is_worth_it(self) -> bool:
        """True if a trial can be worth making."""
        if not np.isnan(self.knowing_adds):
            return self.knowing_adds >= NOTHING
        return NOTHING < self.share < 1.0 - NOTHING


def next_of(
    device: StatedDevice,
    settings_tried: Sequence[StatedDevice],
    sets: Sets,
    settings: Settings,
    cores: int = 1,
    tell: Callable[[str], None] = lambda _: None,
) -> Next:
    """Return what to do next.

    Args:
        device: with its unknowns; its own setting is the intended one if nothing is free.
        settings_tried: devices at the settings of the trials so far, which may be repeated.
        sets: ``SETS`` equally probable sets that are still possible.
        settings: of the runs.
        cores: number of threads.
        tell: called with the step, in words.
    """
    keys = {str(sorted(each.quantities.items())): each for each in settings_tried}
    keys.pop(str(sorted(device.quantities.items())), None)
    tried = list(keys.values())
    intended: Setting = {}
    adds, times = float("nan"), list[tuple[StatedDevice, Setting, Floats]]()
    if device.free:
        found = try_settings(device, settings_in(device, COUNT), sets, settings, cores, tell)
        best = int(found.order[0])
        intended, adds = found.settings[best], found.knowing_adds
        times = [
            (device.changed(**s), s, x) for s, x in zip(found.settings, found.times, strict=True)
        ]
    at = device.changed(**intended)
    runs = run_sets(at, sets, touch_downs(at, TOUCH_DOWNS), settings, cores)
    verdict = runs.reliable(device.limits) & (not exceeds_vibrator(at))
    if not device.free:
        times = [(device, {}, runs.time)]
    for number, each in enumerate(tried):
        tell(f"setting {number + 1} of {len(tried)} that were tried")
        own = run_sets(each, sets, touch_downs(each, TOUCH_DOWNS), settings, cores)
        times.append((each, _setting(each), own.time))
    trials = [Worth(_words(each), information(x, verdict), setting) for each, setting, x in times]
    doubt, bench = float(entropy(verdict.mean())), []
    for one in unknowns_of(device.unknown, sets, verdict):
        how = BENCH.get(INSTEAD[one.name].parameter if one.name in INSTEAD else one.name)
        words = f"measure {one.name}: {how or 'to a tenth of its range'}"
        bench.append(Worth(words, max(0.0, one.worth) * doubt, {}))
    return Next(intended, float(verdict.mean()), adds, _sorted(trials), _sorted(bench))


def _sorted(each: Sequence[Worth]) -> tuple[Worth, ...]:
    return tuple(sorted(each, key=lambda one: -one.bits))


def _setting(device: StatedDevice) -> Setting:
    return {n: device.quantities[n] for n in device.changes if n in device.quantities}


def _words(device: StatedDevice) -> str:
    from vibralign.answers.si import named_words  # noqa: PLC0415

    return named_words(_setting(device), device) or "the setting of the device file"


def information(times: Floats, verdict: NDArray[np.bool_]) -> float:
    """Return the mutual information in bits between the class of a trial and the verdict.

    ``times`` in s are those of n sets from m touch-downs, NaN where it fails, shape (n, m).
    """
    classes = class_shares(times)
    both = np.stack([classes[verdict].sum(axis=0), classes[~verdict].sum(axis=0)]) / len(times)
    alone = both.sum(axis=1, keepdims=True) * both.sum(axis=0)
    return float(
        (both * np.log2(np.where(both > 0.0, both, 1.0) / np.maximum(alone, 1e-300))).sum()
    )


def class_shares(times: Floats) -> Floats:
    """Return the probabilities of the classes of a trial's result for each set, shape (n, 6)."""
    known = times[np.isfinite(times)]
    marks = np.arange(1, CLASSES) / CLASSES
    edges = np.quantile(known, marks) if known.size else np.empty(0)
    which = np.where(np.isfinite(times), np.searchsorted(edges, np.nan_to_num(times)), CLASSES)
    shares = np.stack([(which == each).mean(axis=1) for each in range(CLASSES + 1)], axis=1)
    return (1.0 - _SMOOTH) * shares + _SMOOTH / (CLASSES + 1)
