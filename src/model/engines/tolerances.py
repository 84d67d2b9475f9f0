"""Tolerances of results: how far two computations of the same run may differ.

Each follows from the estimated error of the alignment time or from how the engines obtain a result.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome

Array = NDArray[np.float64]

# The estimated error is below the true one for about one point in a hundred (decision 3), there by
# a factor of a few. An error of 1 % in a force changes a duration by a thousand times this.
MARGIN = 10.0
UNKNOWN_ERROR = 1e-4  # where there is no estimate: the difference that makes a point sensitive
# The reference engine takes largest tilts and forces from samples.
TILT_SAMPLED = 1e-4
FORCE_SAMPLED = 2e-2
# A run that does not align ends when its motion is seen to repeat itself, a period sooner or later.
SHARE_SETTLED = 1e-2
# One that lasts to the horizon ends there: at tighter tolerances its share moves by less than 1e-9.
SHARE_AT_HORIZON = 1e-6


class Compared(NamedTuple):
    """Accepted values, errors of their alignment times, and outcomes; arrays of shape (n,)."""

    value: Array
    error: Array
    outcome: Array


Tolerance = Callable[[Compared], Array]
"""The largest difference that is admitted, shape (n,)."""


def by_error(runs: Compared) -> Array:
    """Admit a multiple of the estimated error of the alignment time."""
    return MARGIN * np.where(np.isfinite(runs.error), runs.error, UNKNOWN_ERROR)


def of_sampled_tilt(runs: Compared) -> Array:
    """Admit what samples of the tilt miss of its largest value."""
    return np.fmax(MARGIN * runs.error, TILT_SAMPLED)


def of_sampled_force(runs: Compared) -> Array:
    """Admit what samples of a force miss of its largest value."""
    return FORCE_SAMPLED * np.maximum(1.0, np.abs(runs.value))


def of_share(runs: Compared) -> Array:
    """Admit what the end of a run moves a share of its time."""
    ends = [runs.outcome == Outcome.ALIGNED, runs.outcome == Outcome.HORIZON_REACHED]
    return np.select(ends, [by_error(runs) + 1e-8, SHARE_AT_HORIZON], SHARE_SETTLED)


def equal_if_aligned(runs: Compared) -> Array:
    """Admit no difference between runs that align."""
    return np.where(runs.outcome == Outcome.ALIGNED, 0.0, np.inf)
