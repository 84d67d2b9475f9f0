"""Calibration: what trials tell of the unknowns of a device.

Trials of one setting share their runs. The runs of all sets are kept, so that the fit is judged
without further ones.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from model.events.insertion import INSERTION
from model.physics.tables import Value
from model.runs.settings import Settings
from vibralign.answers.reliability import Floats
from vibralign.device import StatedDevice
from vibralign.known.fit import Fit, Model, fit_of, rivals_of
from vibralign.known.likelihood import log_likelihood
from vibralign.known.next_trial import SETS, Next, next_of
from vibralign.known.possible import Sets, run_sets, stated, touch_downs
from vibralign.known.posterior import (
    EFFECTIVE,
    FIRST,
    Samples,
    equally,
    quantiles,
    sample,
    values_of,
)
from vibralign.known.trials import Trial, distrusted, notes_on, read_trials, times_of

if TYPE_CHECKING:
    import xarray as xr

TOUCH_DOWNS = 16  # of a trial, a power of two
_WAIT = 1.05  # of the longest time of the trials, until which runs are followed
_AT_ONCE = 1e-4  # s, time of a part that goes in before the vibrator starts, when times begin
_PILED = 0.05, 0.3  # share of a range at its end, and of the posterior there, that are worth a word


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Value):
    """Posterior of a device after its trials; SI units.

    Attributes:
        device: the device with its ranges.
        trials: the trials.
        samples: weighted sets of the unknowns.
        times: of each trial, the times of all sets from its touch-downs, shape (n, m).
        horizon: time at which a run ends.
        fit: how the model fits the trials.
        notes: words on what the trials cannot tell.
        seconds: core-seconds that it took.
    """

    device: StatedDevice
    trials: tuple[Trial, ...]
    samples: Samples
    times: tuple[Floats, ...]
    horizon: float
    fit: Fit
    notes: tuple[str, ...] = ()
    seconds: float = math.nan

    def __repr__(self) -> str:
        words = "fits" if self.fit.fits else "does not fit"
        return f"<Calibration: the model {words} {len(self.trials)} trials>"

    @property
    def concludes(self) -> bool:
        """True if the model fits and the sample is large enough."""
        return self.fit.fits and self.samples.effective >= EFFECTIVE

    @property
    def sets(self) -> Sets:
        """Sets of the unknowns by name, each of shape (n,); ``samples`` has their weights."""
        return values_of(self.samples.z, self.device.unknown)

    def equally(self, count: int) -> dict[str, Floats]:
        """Return ``count`` equally probable sets.

        Raises:
            ValueError: the model does not fit the trials.
        """
        self._check_fit()
        rows = equally(self.samples.weights, count)
        return {name: column[rows] for name, column in self.sets.items()}

    def intervals(self, ends: Sequence[float] = (0.05, 0.5, 0.95)) -> dict[str, tuple[float, ...]]:
        """Return quantiles of the unknowns by name; errors as ``equally``."""
        self._check_fit()
        return {
            name: tuple(quantiles(column, self.samples.weights, ends).tolist())
            for name, column in self.sets.items()
        }

    def _check_fit(self) -> None:
        if not self.fit.fits:
            raise ValueError(
                "the model does not fit these trials, so they tell nothing of the unknowns: see "
                "fit.outside"
            )

    @property
    def piled(self) -> list[str]:
        """Words on unknowns that pile up at an end of their range."""
        words, (width, least) = [], _PILED
        for name, each in self.device.unknown.items():
            share = each.share(self.sets[name])
            for end, near in (("lower", share < width), ("upper", share > 1.0 - width)):
                if self.samples.weights[near].sum() > least:
                    words.append(
                        f"{name} piles up at the {end} end of its range: the truth may lie beyond"
                    )
        return words

    def posterior(self, count: int = 400) -> "xr.Dataset":
        """Return ``count`` equally probable sets with the dimensions chain and draw, for arviz."""
        import xarray as xr  # noqa: PLC0415  (a second)

        return xr.Dataset({n: (("chain", "draw"), v[None]) for n, v in self.equally(count).items()})

    def next(
        self,
        settings: Settings | None = None,
        cores: int = 1,
        tell: Callable[[str], None] = lambda _: None,
    ) -> Next:
        """Return the verdict at the intended setting, and the trial or test to make next.

        Raises:
            ValueError: the model does not fit, or the sample is too small.
        """
        if not self.concludes:
            raise ValueError("nothing can be concluded from these trials: see fit and samples")
        tried = [each.device for each in self.trials]
        settings = settings or Settings(scene=INSERTION)
        return next_of(self.device, tried, self.equally(SETS), settings, cores, tell)


def calibrate(
    device: StatedDevice | Path | str,
    trials: Any,
    settings: Settings | None = None,
    cores: int = 1,
    *,
    tell: Callable[[str], None] = lambda _: None,
    target: float = EFFECTIVE,
    touch_downs_tried: int = TOUCH_DOWNS,
    seed: int = 0,
) -> Calibration:
    """Return what trials tell of the unknowns of a device.

    Args:
        device: with ranges below ``unknown``, or the path of its file.
        trials: path of a CSV file, DataFrame, or rows as mappings from the names of the columns.
        settings: settings of the runs; None for the defaults, in the insertion scene.
        cores: number of threads.
        tell: called with the step, in words.
        target: effective sample size that is sought.
        touch_downs_tried: touch-downs of each trial, a power of two.
        seed: of sets and touch-downs.

    Raises:
        ValueError: bad input, as ``read_trials`` and ``check_known``; before anything is computed.
    """
    device = replace(stated(device), samples=None)  # a calibration starts from the ranges
    table = read_trials(device, trials)
    settings = settings or Settings(scene=INSERTION)
    own = device.run_settings(settings, device.units)
    horizon = max([own.horizon * device.units.time, *(_WAIT * each for each in times_of(table))])
    groups: dict[str, list[int]] = {}
    for number, each in enumerate(table):
        groups.setdefault(str(sorted(each.setting.items())), []).append(number)
    downs = {
        key: touch_downs(table[rows[0]].device, touch_downs_tried, seed=seed + 10 + rows[0])
        for key, rows in groups.items()
    }
    times: list[list[Floats]] = [[] for _ in table]
    began = time.process_time()

    def runs(sets: Sets, model: Model | None = None) -> Iterator[tuple[list[int], Floats]]:
        for key, rows in groups.items():
            lowered, own = replace(table[rows[0]].device, horizon=horizon), sets
            if model is not None:
                lowered, own = model(lowered, sets)
            found = run_sets(lowered, own, downs[key], settings, cores).time
            yield rows, np.maximum(found, _AT_ONCE)

    def likelihood(sets: Sets) -> Floats:
        logs = np.zeros(len(next(iter(sets.values()))))
        for rows, found in runs(sets):
            for row in rows:
                logs += log_likelihood(table[row], found, horizon)
                times[row].append(found)
        return logs

    samples = sample(device.unknown, likelihood, tell, target=target, seed=seed)
    whole = tuple(np.concatenate(each) for each in times)
    rivals: dict[str, Floats] = {}
    few = values_of(samples.z[:FIRST], device.unknown)
    for words, model in rivals_of(device, table).items():
        tell(f"rival: {words}")
        logs = [log_likelihood(table[i], x, horizon) for at, x in runs(few, model) for i in at]
        rivals[words] = np.sum(logs, axis=0)
    fit = fit_of(table, whole, samples, horizon, rivals)
    seconds = time.process_time() - began
    sets = values_of(samples.z, device.unknown)
    middle = {n: float(quantiles(x, samples.weights, [0.5])[0]) for n, x in sets.items()}
    notes = (*notes_on(table, len(device.unknown)), *distrusted(table, middle))
    return Calibration(device, tuple(table), samples, whole, horizon, fit, notes, seconds)
