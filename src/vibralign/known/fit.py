"""Does the model fit the trials at all?

The evidence of the trials, the mean of their likelihood over what is possible, is compared with
that of ``REPLICATES`` tables which the model makes itself: with sets of the posterior, a touch-down
each, the error of the times and the outliers. If fewer than ``LEAST`` of these have as little
evidence, the model does not fit (G. E. P. Box, Journal of the Royal Statistical Society A 143,
1980, 383, with the predictions of the posterior). No further run is made. Each trial is then looked
at by what the others predict of it (A. E. Gelfand, D. K. Dey, H. Chang, Bayesian Statistics 4,
1992, 147).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from vibralign.answers.reliability import Floats
from vibralign.known.likelihood import (
    OUTLIERS,
    WIDEST,
    log_chance,
    log_density,
    log_failing,
    log_likelihood,
)
from vibralign.known.posterior import Samples, normalised
from vibralign.known.trials import Trial

REPLICATES = 300
LEAST = 0.05  # share of the replicates below which the model does not fit
OUTSIDE = 0.05  # probability of a result, from both ends, below which a trial is named


class Fit(NamedTuple):
    """How the model fits the trials.

    Attributes:
        share: share of tables made by the model that have as little evidence as the trials.
        odds: common logarithm of the evidence of the model over that of chance.
        predicted: probability of each trial's result as the others predict it, from both ends;
            of a failure, that of failing.
        times: 5, 50 and 95 % quantiles of each trial's predicted time in s, shape (trials, 3).
    """

    share: float
    odds: float
    predicted: tuple[float, ...]
    times: Floats

    @property
    def fits(self) -> bool:
        """True if the model fits the trials."""
        return self.share >= LEAST

    @property
    def outside(self) -> list[int]:
        """Numbers of the trials that the others do not predict."""
        return [i for i, each in enumerate(self.predicted) if each < OUTSIDE]


def fit_of(
    trials: Sequence[Trial],
    times: Sequence[Floats],
    samples: Samples,
    horizon: float,
    seed: int = 0,
) -> Fit:
    """Return how the model fits.

    Args:
        trials: the trials.
        times: of each trial, the times in s of all sets from its touch-downs, shape (n, m).
        samples: the sets with their weights.
        horizon: time in s at which a run ends.
        seed: of the replicates.
    """
    own = np.stack([log_likelihood(t, x, horizon) for t, x in zip(trials, times, strict=True)], 1)
    evidence = _evidence(samples, own.sum(axis=1)[:, None])[0]
    made = _of_replicates(trials, times, samples, horizon, np.random.default_rng(seed))
    share = (1.0 + float((made <= evidence).sum())) / (1.0 + REPLICATES)
    predicted, quantiles = [], []
    for i, (trial, each) in enumerate(zip(trials, times, strict=True)):
        without = normalised(samples.log_ratio + samples.log_likelihood - own[:, i])
        predicted.append(_probability(trial, each, without, horizon))
        quantiles.append(_quantiles(each, samples.weights))
    odds = (evidence - log_chance(trials)) / math.log(10.0)
    return Fit(share, float(odds), tuple(predicted), np.array(quantiles))


def _evidence(samples: Samples, logs: Floats) -> Floats:
    """Return the logarithm of the evidence of tables, whose log likelihoods have shape (n, k)."""
    found: Floats = scipy.special.logsumexp(samples.log_ratio[:, None] + logs, axis=0)
    return found


def _of_replicates(
    trials: Sequence[Trial],
    times: Sequence[Floats],
    samples: Samples,
    horizon: float,
    rng: np.random.Generator,
) -> Floats:
    """Return the evidence of tables that the model makes, shape (``REPLICATES``,)."""
    rows = rng.choice(len(samples.z), REPLICATES, p=samples.weights)
    longest = max((each.waited for each in trials if each.waited), default=horizon)
    logs = np.zeros((len(samples.z), REPLICATES))
    for trial, each in zip(trials, times, strict=True):
        waited = trial.waited or longest
        time = each[rows, rng.integers(each.shape[1], size=REPLICATES)]
        time = time * np.exp(trial.error * rng.standard_normal(REPLICATES))
        odd, middle = rng.random(REPLICATES) < OUTLIERS, 0.1 * waited
        any_time = middle * WIDEST ** (rng.random(REPLICATES) - 0.5)
        time = np.where(odd, np.where(rng.random(REPLICATES) < 0.5, np.nan, any_time), time)
        fails = ~(time <= waited)
        logs[:, fails] += log_failing(each, waited)[:, None]
        if not fails.all():
            logs[:, ~fails] += log_density(each, np.log(time[~fails]), trial.error)
    return _evidence(samples, logs)


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
    return min(1.0, 2.0 * min(below, 1.0 - below))


def _quantiles(times: Floats, weights: Floats) -> Floats:
    """Return weighted quantiles of the times, infinite where it fails."""
    flat = np.nan_to_num(times, nan=np.inf).ravel()
    order = np.argsort(flat)
    share = np.cumsum(np.repeat(weights / times.shape[1], times.shape[1])[order])
    at = np.minimum(np.searchsorted(share, (0.05, 0.5, 0.95)), flat.size - 1)
    found: Floats = flat[order][at]
    return found
