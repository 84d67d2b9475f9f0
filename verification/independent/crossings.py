"""Search for events on the dense output of a step, which is sampled at many times."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from verification.independent.motion import State

Function = Callable[[Any, State], Any]

ON_ZERO = 1e-9  # an event function below this at the beginning of a mode begins on its zero
_NODES = np.concatenate([[0.0, 1e-4, 1e-3, 1e-2], np.linspace(1 / 24, 1.0, 24)])


def first_event(
    functions: Mapping[str, Function], sol: Any, start: float, end: float, muted: str
) -> tuple[str, float] | None:
    """Return (name, time) of the earliest event on the dense output ``sol`` between two times.

    The ``muted`` event began the mode and changed nothing: it counts only after its function has
    been positive.
    """
    times = start + _NODES * (end - start)
    states = sol(times)
    earliest: tuple[str, float] | None = None
    for name, function in functions.items():
        values = function(times, states)
        found = _crossing(partial(_at, function, sol), times, values, name == muted)
        if found is not None and (earliest is None or found < earliest[1]):
            earliest = name, found
    return earliest


def _at(function: Function, sol: Any, time: float) -> float:
    return float(function(time, sol(time)))


def _crossing(
    function: Callable[[float], float], times: State, values: State, muted: bool
) -> float | None:
    """Return the time of the first down-crossing of a sampled function, or None."""
    first = 0
    if values[0] <= ON_ZERO:  # a mode may begin on a zero of its own functions, or beyond it
        if not muted and values[1] < min(values[0], 0.0) and values[2] < values[1]:
            return float(times[0])
        above = np.flatnonzero(values > 0.0)
        if not above.size:
            return None
        first = int(above[0])
    for i in range(first, len(times) - 1):
        low, high = times[i], times[i + 1]
        if values[i + 1] < 0.0:
            return float(brentq(function, low, high, xtol=1e-15, rtol=1e-15))
        if i == first:
            continue
        drop, rise = values[i - 1] - values[i], values[i + 1] - values[i]
        dips = drop >= 0.0 and rise >= 0.0 and values[i] < drop + rise
        # A dip between the last two samples shows only where the last drop would go on below zero.
        if dips or (i == len(times) - 2 and values[i] < drop):
            lowest = minimize_scalar(
                function, bounds=(times[i - dips], high), method="bounded",
                options={"xatol": 1e-3 * (high - low)},
            )  # fmt: skip
            if lowest.fun < 0.0:
                return float(brentq(function, times[i - dips], lowest.x, xtol=1e-15, rtol=1e-15))
    return None
