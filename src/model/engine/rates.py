"""Rates of the state, states moved along them, and a short step of the classical method."""

from math import isfinite

import numpy as np

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.physics.motion import motion
from model.physics.notation import State

STILL = State(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

# The classical Runge-Kutta method of order 4: nodes and weights.
_NODES, _WEIGHTS = np.array([0.0, 0.5, 0.5, 1.0]), np.array([1.0, 2.0, 2.0, 1.0]) / 6.0


@inlined_kernel
def is_too_short(h, time):
    """Return whether a step is below the resolution of time."""
    return h <= 1e-14 * max(1.0, time)


@inlined_kernel
def rates_of(time, q, p, mode):
    """Return dy/dτ as a ``State``."""
    at = motion(time, q, p, mode)
    return State(q.x_rate, q.y_rate, q.tilt_rate, at.x, at.y, at.tilt)


@separate_kernel
def rates_at(time, q, p, mode):
    """Return ``rates_of`` by a call: for code that runs once an event, so that it stays small."""
    return rates_of(time, q, p, mode)


@kernel
def are_finite(rates):
    """Return whether no rate is infinite or not a number."""
    return isfinite(rates.x + rates.y + rates.tilt + rates.x_rate + rates.y_rate + rates.tilt_rate)


@inlined_kernel
def moved(q, h, rates):
    """Return the state ``q`` + h ``rates``."""
    return State(*(value + h * rate for value, rate in zip(q, rates, strict=True)))


@kernel
def short_step(time, h, q, p, mode):
    """Return the state after a short step ``h`` of the classical Runge-Kutta method of order 4."""
    rates, end = STILL, q
    for stage in range(len(_NODES)):
        ahead = _NODES[stage] * h
        rates = rates_at(time + ahead, moved(q, ahead, rates), p, mode)
        end = moved(end, _WEIGHTS[stage] * h, rates)
    return end
