"""Does the model fit the trials at all?

Each trial is compared with what all others predict of it: the probability of a result as far out,
from both ends, or of failing (A. E. Gelfand, D. K. Dey, H. Chang, Bayesian Statistics 4, 1992,
147). If the product of these probabilities is too small, by Fisher's combined test (R. A. Fisher,
Statistical Methods for Research Workers, 1932, sect. 21.1), the model does not fit. No further run
is made.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from vibralign.answers.reliability import Floats
from vibralign.known.likelihood import log_chance, log_likelihood
from vibralign.known.posterior import Samples, normalised
from vibralign.known.trials import Trial

LEAST = 0.07  # probability of trials as far out, below which the model does not fit
_SMALLEST = 1e-4  # of these probabilities: no trial counts for more
OUTSIDE = 0.05  # probability of a result, from both ends, below which a trial is named


class Fit(NamedTuple):
    """Fit of the model to the trials.

    Attributes:
        share: probability that trials of the model are as far out as these.
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
    trials: Sequence[Trial], times: Sequence[Floats], samples: Samples, horizon: float
) -> Fit:
    """Return how the model fits.

    Args:
        trials: the trials.
        times: of each trial, the times in s of all sets from its touch-downs, shape (n, m).
        samples: the sets with their weights.
        horizon: time in s at which a run ends.
    """
    predicted, quantiles = [], []
    for trial, each in zip(trials, times, strict=True):
        own = log_likelihood(trial, each, horizon)
        others = normalised(samples.log_ratio + samples.log_likelihood - own)
        predicted.append(_probability(trial, each, others, horizon))
        quantiles.append(_quantiles(each, samples.weights))
    product = -2.0 * float(np.log(np.maximum(predicted, _SMALLEST)).sum())
    share = float(scipy.stats.chi2.sf(product, 2 * len(trials)))
    evidence = float(scipy.special.logsumexp(samples.log_ratio + samples.log_likelihood))
    odds = (evidence - log_chance(trials)) / math.log(10.0)
    return Fit(share, odds, tuple(predicted), np.array(quantiles))


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
