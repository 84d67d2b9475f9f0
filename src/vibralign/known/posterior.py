"""Posterior of the unknowns: adaptive multiple importance sampling.

The ranges are the prior. First their Sobol' points are weighed by the likelihood of the trials.
Then every stage draws sets from a mixture of normal distributions around the best sets so far, and
all sets are weighed anew by the mixture of all proposals (J.-M. Cornuet, J.-M. Marin, A. Mira,
C. P. Robert, Scandinavian Journal of Statistics 39, 2012, 798), so that no run is lost. Shares of
the ranges are transformed to normal variates z, so that no proposal leaves a range. Decision 0068
weighs this sampler against nested sampling and Markov chains.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from model.physics.tables import Value
from vibralign.answers.reliability import Floats
from vibralign.device.unknown import Range

FIRST = 64  # sets of the first stage, of the ranges; a power of two
STAGE = 32  # sets of each later one; a power of two
EFFECTIVE = 100.0  # effective sample size that is sought, and below which nothing is concluded
MOST = 2048  # sets
_DEFENSIVE = 0.1  # share of a stage that is drawn from the ranges
_KEPT = 0.25  # share of the sets that the tempered weights of a proposal keep, at least
_ENDS = 1e-6  # of a range, left out


@dataclass(frozen=True, eq=False, repr=False)
class Samples(Value):
    """Weighted sets of the unknowns.

    Attributes:
        z: normal variates of the shares of the ranges, shape (n, d).
        log_likelihood: of the sets, shape (n,).
        log_proposal: logarithm of n times the density of all proposals, shape (n,).
    """

    z: Floats
    log_likelihood: Floats
    log_proposal: Floats

    @property
    def log_ratio(self) -> Floats:
        """Logarithm of prior over proposals, shape (n,)."""
        return _log_prior(self.z) - self.log_proposal

    @property
    def weights(self) -> Floats:
        """Weights of sum 1, shape (n,)."""
        return normalised(self.log_ratio + self.log_likelihood)

    @property
    def effective(self) -> float:
        """Effective sample size."""
        return effective(self.weights)


def normalised(logs: Floats) -> Floats:
    """Return weights of sum 1 from their logarithms."""
    weights = np.exp(logs - logs.max())
    found: Floats = weights / weights.sum()
    return found


def equally(weights: Floats, count: int, seed: int = 0) -> NDArray[np.int64]:
    """Return ``count`` rows with the frequencies of their weights (systematic resampling)."""
    marks = (np.arange(count) + np.random.default_rng(seed).random()) / count
    rows = np.searchsorted(np.cumsum(weights) / weights.sum(), marks)
    return np.minimum(rows, weights.size - 1)


def effective(weights: Floats) -> float:
    """Return the effective sample size of weights of sum 1."""
    return float(1.0 / (weights**2).sum())


def quantiles(values: Floats, weights: Floats, ends: Sequence[float]) -> Floats:
    """Return weighted quantiles of values; weights of sum 1."""
    order = np.argsort(values)
    at = np.searchsorted(np.cumsum(weights[order]), ends)
    found: Floats = values[order][np.minimum(at, values.size - 1)]
    return found


def values_of(z: Floats, ranges: Mapping[str, Range]) -> dict[str, Floats]:
    """Return sets of the unknowns in SI units by name, each of shape (n,)."""
    shares = np.clip(scipy.stats.norm.cdf(z), _ENDS, 1.0 - _ENDS)
    return {name: each.at(shares[:, i]) for i, (name, each) in enumerate(ranges.items())}


def sample(
    ranges: Mapping[str, Range],
    log_likelihood: Callable[[dict[str, Floats]], Floats],
    tell: Callable[[str], None] = lambda _: None,
    *,
    target: float = EFFECTIVE,
    most: int = MOST,
    seed: int = 0,
) -> Samples:
    """Return weighted sets of the unknowns.

    Args:
        ranges: the prior.
        log_likelihood: of sets in SI units by name, each of shape (n,); shape (n,).
        tell: called after a stage, in words.
        target: effective sample size at which it ends.
        most: sets at most.
        seed: of the points.
    """
    d = len(ranges)
    engine = scipy.stats.qmc.Sobol(d, rng=np.random.default_rng(seed))
    z = scipy.stats.norm.ppf(np.clip(engine.random(FIRST), _ENDS, 1.0 - _ENDS))
    mixtures: list[tuple[int, Floats, Floats]] = []
    found = Samples(z, log_likelihood(values_of(z, ranges)), _log_proposal(z, FIRST, mixtures))
    stage = 0
    while found.effective < target and len(found.z) < most:
        stage += 1
        tell(f"{len(found.z)} sets, effective sample {found.effective:.0f} of {target:.0f}")
        centres, covariance = _proposal(found, seed + stage)
        points = scipy.stats.qmc.Sobol(d + 1, rng=np.random.default_rng([seed, stage])).random(
            STAGE
        )
        steps = scipy.stats.norm.ppf(np.clip(points[:, 1:], _ENDS, 1.0 - _ENDS))
        which = (points[:, 0] / (1.0 - _DEFENSIVE) * len(centres)).astype(int)
        around = which < len(centres)
        new = steps.copy()
        root = np.linalg.cholesky(covariance)
        new[around] = centres[which[around]] + steps[around] @ root.T
        own = log_likelihood(values_of(new, ranges))
        mixtures.append((STAGE, centres, covariance))
        z = np.vstack([found.z, new])
        logs = np.append(found.log_likelihood, own)
        found = Samples(z, logs, _log_proposal(z, FIRST, mixtures))
    return found


def _log_prior(z: Floats) -> Floats:
    logs: Floats = scipy.stats.norm.logpdf(z).sum(axis=1)
    return logs


def _log_proposal(z: Floats, first: int, mixtures: list[tuple[int, Floats, Floats]]) -> Floats:
    prior, d = _log_prior(z), z.shape[1]
    logs = [np.log(first) + prior]
    for count, centres, covariance in mixtures:
        root = np.linalg.cholesky(covariance)
        steps = np.linalg.solve(root, (z[:, None] - centres).reshape(-1, d).T)
        squares = (steps**2).sum(axis=0).reshape(len(z), len(centres))
        own = scipy.special.logsumexp(-0.5 * squares, axis=1) - np.log(len(centres))
        own -= np.log(np.diag(root)).sum() + 0.5 * d * np.log(2.0 * np.pi)
        logs += [np.log(count * _DEFENSIVE) + prior, np.log(count * (1.0 - _DEFENSIVE)) + own]
    total: Floats = scipy.special.logsumexp(logs, axis=0)
    return total


def _proposal(found: Samples, seed: int) -> tuple[Floats, Floats]:
    """Return centres and covariance of the next proposal, from tempered weights."""
    logs, d = found.log_ratio + found.log_likelihood, found.z.shape[1]
    power, least = 1.0, max(_KEPT * STAGE, 2.0 * d)
    while effective(weights := normalised(power * logs)) < least and power > 1e-3:
        power *= 0.8
    middle = weights @ found.z
    steps = found.z - middle
    covariance = (weights[:, None] * steps).T @ steps + 1e-4 * np.eye(d)
    size = effective(weights)
    covariance *= (4.0 / ((d + 2.0) * size)) ** (2.0 / (d + 4.0))  # Silverman's, of kernels
    return found.z[equally(weights, STAGE, seed)], covariance
