"""Does the model fit the trials at all?

Each trial is compared with what all others predict of it: the probability of a result as far out,
from both ends, or of failing (A. E. Gelfand, D. K. Dey, H. Chang, Bayesian Statistics 4, 1992,
147). If the product of these probabilities is too small, by Fisher's combined test (R. A. Fisher,
Statistical Methods for Research Workers, 1932, sect. 21.1), the model does not fit.

Nor does it fit if another model, a *rival*, makes the trials ``BETTER`` times as probable, by the
evidence of the first sets of the ranges. Only rivals need further runs.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy

from vibralign.answers.reliability import Floats
from vibralign.device import StatedDevice
from vibralign.device.approach import SPEED, USUAL
from vibralign.known.likelihood import log_chance, log_likelihood
from vibralign.known.possible import Sets
from vibralign.known.posterior import Samples, normalised
from vibralign.known.trials import Trial

LEAST = 0.02  # probability of trials as far out below which the model does not fit
BETTER = 3.0  # the model does not fit if a rival makes the trials so many times as probable
_SOFTER = 10.0  # factor by which the base of a rival is softer
_SMALLEST = 1e-4  # of these probabilities: no trial counts for more
OUTSIDE = 0.05  # probability of a result, from both ends, below which a trial is named


Model = Callable[[StatedDevice, Sets], tuple[StatedDevice, Sets]]
"""From the device and the sets of the unknowns, those with which a rival is run."""


class Fit(NamedTuple):
    """Fit of the model to the trials.

    Attributes:
        share: probability that trials made by the model are at least as far out as these.
        odds: common logarithm of the evidence of the model over that of chance.
        predicted: probability of each trial's result as the others predict it, from both ends;
            of a failure, that of failing.
        rivals: common logarithm of each rival's evidence over the model's, by the rival's words.
    """

    share: float
    odds: float
    predicted: tuple[float, ...]
    rivals: Mapping[str, float] = {}

    @property
    def fits(self) -> bool:
        """True if the model fits the trials."""
        return self.share >= LEAST and max(self.rivals.values(), default=0.0) < math.log10(BETTER)

    @property
    def outside(self) -> list[int]:
        """Numbers of the trials that the others do not predict."""
        return [i for i, each in enumerate(self.predicted) if each < OUTSIDE]


def fit_of(
    trials: Sequence[Trial],
    times: Sequence[Floats],
    samples: Samples,
    horizon: float,
    rivals: Mapping[str, Floats],
) -> Fit:
    """Return how the model fits.

    Args:
        trials: the trials.
        times: of each trial, the times in s of all sets from its touch-downs, shape (n, m).
        samples: the sets with their weights.
        horizon: time in s at which a run ends.
        rivals: logarithms of the likelihood of the first sets, by the words of each rival.
    """
    predicted = []
    for trial, each in zip(trials, times, strict=True):
        own = log_likelihood(trial, each, horizon)
        others = normalised(samples.log_ratio + samples.log_likelihood - own)
        predicted.append(_probability(trial, each, others, horizon))
    product = -2.0 * float(np.log(np.maximum(predicted, _SMALLEST)).sum())
    share = float(scipy.stats.chi2.sf(product, 2 * len(trials)))
    evidence = float(scipy.special.logsumexp(samples.log_ratio + samples.log_likelihood))
    odds = (evidence - log_chance(trials)) / math.log(10.0)
    model = samples.log_likelihood
    better = {
        words: float(scipy.special.logsumexp(each) - scipy.special.logsumexp(model[: each.size]))
        / math.log(10.0)
        for words, each in rivals.items()
    }
    return Fit(share, odds, tuple(predicted), better)


def rivals_of(device: StatedDevice, trials: Sequence[Trial]) -> dict[str, Model]:
    """Return the rivals of the model of a device that these trials can tell from it, in words."""

    def changed(**changes: float | str) -> Model:
        return lambda own, sets: (own.changed(**changes), sets)

    def falling(own: StatedDevice, sets: Sets) -> tuple[StatedDevice, Sets]:
        one = np.ones_like(next(iter(sets.values())))
        known = one * sets.get("friction", own.quantities["friction"])
        factor = math.sqrt(float(np.median(presses)) / own.quantities["press_force"])
        return own, {**sets, "friction": factor * known}

    vibrator = "still" if device.vibrator == "running" else "running"
    approach = changed(vibrator=vibrator, **({SPEED: USUAL} if device.sudden else {}))
    found = {f"an approach with the vibrator {vibrator}": approach}
    if "contact_stiffness" not in device.unknown:
        softer = device.values["contact_stiffness"] / _SOFTER
        found[f"a base {_SOFTER:.0f} times as soft"] = changed(contact_stiffness=softer)
    presses = [each.device.quantities["press_force"] for each in trials]
    if min(presses) < max(presses):
        found["a friction that falls as the root of press_force"] = falling
    return found


def _probability(trial: Trial, times: Floats, weights: Floats, horizon: float) -> float:
    """Return how probable a result is, from both ends of what is predicted."""
    waited = trial.waited or horizon
    fails = float(weights @ (~(times <= waited)).mean(axis=1))
    if trial.time is None:
        return fails
    width = max(trial.error, 1e-9)
    known = np.isfinite(times)
    z = (math.log(trial.time) - np.log(np.where(known, times, 1.0))) / width
    below = float(weights @ (known * scipy.stats.norm.cdf(z)).mean(axis=1))
    return min(1.0, 2.0 * max(0.0, min(below, 1.0 - below)))
