"""Likelihood of trials, given the runs of a set of the unknowns from many touch-downs.

A trial's touch-down is not known: n touch-downs give a set the probability (k + ½)/(n + 1) of
failing within the time that was waited, k of them having failed, and a density of the logarithm of
the time: a kernel around each run's time, as wide as the error of the stated time and a bandwidth
(B. W. Silverman, Density Estimation, 1986, eq. 3.31). Failures and stopped trials are censored
times. A share ``OUTLIERS`` of all results has nothing to do with the model: it fails or has a time
between ``WIDEST`` of each other, at even odds.
"""

import math
from collections.abc import Sequence

import numpy as np
import scipy

from vibralign.answers.reliability import Floats
from vibralign.known.trials import Trial

OUTLIERS = 0.02
WIDEST = 100.0  # factor between the times that an outlier may have
_BANDWIDTH = 0.05, 0.3  # least and most, of the logarithm of a time


def log_likelihood(trial: Trial, times: Floats, horizon: float) -> Floats:
    """Return the logarithm of the likelihood of one trial, shape (n,).

    Args:
        trial: the trial.
        times: alignment times in s of n sets from m touch-downs, NaN where it fails, shape (n, m).
        horizon: time in s at which a run ends.
    """
    if trial.time is None:
        return log_failing(times, trial.waited or horizon)
    return log_density(times, np.array([math.log(trial.time)]), trial.error)[:, 0]


def log_failing(times: Floats, waited: float) -> Floats:
    """Return the logarithm of the probability of failing within a time in s, shape (n,)."""
    failing = (~(times <= waited)).sum(axis=-1)
    share = (failing + 0.5) / (times.shape[-1] + 1.0)
    return np.log((1.0 - OUTLIERS) * share + 0.5 * OUTLIERS)


def log_density(times: Floats, logs: Floats, error: float) -> Floats:
    """Return the logarithm of the density at logarithms of times, shape (n, len(logs)).

    ``times`` as for ``log_likelihood``; ``error`` is the relative error of an observed time.
    """
    known = np.log(times)
    count = np.isfinite(known).sum(axis=1)
    middle = np.where(np.isfinite(known), known, 0.0).sum(axis=1) / np.maximum(count, 1)
    deviation = np.where(np.isfinite(known), known - middle[:, None], 0.0)
    spread = np.sqrt((deviation**2).sum(axis=1) / np.maximum(count - 1, 1))
    bandwidth = np.clip(0.9 * spread * np.maximum(count, 1) ** -0.2, *_BANDWIDTH)
    width = np.hypot(bandwidth, error)[:, None, None]
    z = (known[:, None, :] - logs[:, None]) / width
    kernel = np.where(np.isfinite(z), np.exp(-0.5 * np.where(np.isfinite(z), z, 0.0) ** 2), 0.0)
    density = (kernel / (width * math.sqrt(math.tau))).sum(axis=2)
    unseen = 0.5 / math.log(WIDEST)  # of a touch-down that goes in, and was not among those tried
    own = (density + unseen) / (times.shape[1] + 1.0)
    outlier = 0.5 / math.log(WIDEST)
    return np.log((1.0 - OUTLIERS) * own + OUTLIERS * outlier)


def log_chance(trials: Sequence[Trial]) -> float:
    """Return the logarithm of the likelihood of all trials at random.

    Each fails with the share that fails, and the times have the normal distribution of the
    logarithm that fits them best.
    """
    logs = np.log([each.time for each in trials if each.time is not None])
    fails = len(trials) - logs.size
    share = (fails + 0.5) / (len(trials) + 1.0)
    found = fails * math.log(share) + logs.size * math.log(1.0 - share)
    if logs.size:
        spread = max(float(logs.std()), 0.1)
        found += float(scipy.stats.norm.logpdf(logs, logs.mean(), spread).sum())
    return found
