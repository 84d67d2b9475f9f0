"""Tolerances of results: largest differences between two computations of the same run.

Each follows from the estimated error of the alignment time or from the way engines obtain a result.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome

Array = NDArray[np.float64]

# The estimated error is below the true one for about one point in a hundred (decision 3), by a
# small factor. An error of 1 % in a force changes a duration by a thousand times this margin.
MARGIN = 10.0
UNKNOWN_ERROR = 1e-4  # of a run without an estimate: the difference that makes a set sensitive
# At loose tolerances largest tilts and forces are less accurate than times.
TILT_SAMPLED = 1e-4
FORCE_SAMPLED = 2e-2
# A run that settles may do so a period sooner or later.
SHARE_SETTLED = 1e-2
# Without vibration a part that comes to rest still moves by this much when its run ends.
TILT_AT_REST = 1e-3
# The share of a run that lasts to the horizon changes by less than 1e-9 at tighter tolerances.
SHARE_AT_HORIZON = 1e-6


class Compared(NamedTuple):
    """Accepted values, errors of their alignment times, and outcomes; arrays of shape (n,)."""

    value: Array
    error: Array
    outcome: Array


Tolerance = Callable[[Compared], Array]
"""Function that returns the largest admissible difference, shape (n,)."""


def by_error(runs: Compared) -> Array:
    """Admit a multiple of the estimated error of the alignment time."""
    return MARGIN * np.where(np.isfinite(runs.error), runs.error, UNKNOWN_ERROR)


def of_sampled_tilt(runs: Compared) -> Array:
    """Admit the error of the largest tilt that sampling causes."""
    return np.fmax(MARGIN * runs.error, TILT_SAMPLED)


def of_sampled_force(runs: Compared) -> Array:
    """Admit the error of the largest force that sampling causes."""
    return FORCE_SAMPLED * np.maximum(1.0, np.abs(runs.value))


def of_share(runs: Compared) -> Array:
    """Admit the change of a share of time if the run ends at another time."""
    ends = [runs.outcome == Outcome.ALIGNED, runs.outcome == Outcome.HORIZON_REACHED]
    return np.select(ends, [by_error(runs) + 1e-8, SHARE_AT_HORIZON], SHARE_SETTLED)


def of_rest(runs: Compared) -> Array:
    """Admit the remaining motion of a part that comes to rest."""
    return np.full(runs.value.shape, TILT_AT_REST)


def equal(runs: Compared) -> Array:
    """Admit no difference."""
    return np.zeros(runs.value.shape)


def equal_if_aligned(runs: Compared) -> Array:
    """Admit no difference between runs that align."""
    return np.where(runs.outcome == Outcome.ALIGNED, 0.0, np.inf)
