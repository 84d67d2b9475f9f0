"""numbalsoda's DOP853 with events; the whole trajectory, restarts included, in compiled code.

Its LSODA has no events. It locates events to 1e-8 of time, whichever way they cross, and of several
in one step not the earliest but that of the lowest index. A step along the tangent mends the first;
functions that start on their zero are lifted off it, for the second; and where another function is
found to have fallen already the stretch is repeated up to there, for the third.
"""

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from numba import carray  # type: ignore[attr-defined]
from numbalsoda import lsoda_sig, solve_ivp

from benchmarks.equations import DEVICE_SIZE, device
from benchmarks.methods.base import Method, NotReachedError, Solution, cpu_seconds, longest_step
from benchmarks.modes import (
    ALIGNED,
    STATE_SIZE,
    SWITCH_COUNT,
    first_mode,
    jit,
    next_mode,
    rates,
    start,
    switches,
)
from benchmarks.problems import Problem
from model import Parameters

_MOST_SWITCHES = 20_000
_LIFT = 1e-14
_DATA_SIZE = DEVICE_SIZE + 1 + SWITCH_COUNT  # the device, the mode, lifts of the functions


@numba.cfunc(lsoda_sig)
def _rates(t, y_, out_, data_):
    data = carray(data_, (_DATA_SIZE,))
    y, out = carray(y_, (STATE_SIZE,)), carray(out_, (STATE_SIZE,))
    rates(t, y, data, int(data[DEVICE_SIZE]), out)


@numba.cfunc(lsoda_sig)
def _switches(t, y_, out_, data_):
    data = carray(data_, (_DATA_SIZE,))
    y, out = carray(y_, (STATE_SIZE,)), carray(out_, (SWITCH_COUNT,))
    switches(t, y, data, int(data[DEVICE_SIZE]), out)
    for i in range(SWITCH_COUNT):
        out[i] += data[DEVICE_SIZE + 1 + i]


_RATES, _SWITCHES = _rates.address, _switches.address


@jit
def _lift(t, y, data, mode):
    """Put ``mode`` into ``data``, and what lifts a function that starts at zero off it."""
    now = np.empty(SWITCH_COUNT)
    switches(t, y, data, mode, now)
    data[DEVICE_SIZE] = mode
    for i in range(SWITCH_COUNT):
        data[DEVICE_SIZE + 1 + i] = _LIFT - now[i] if abs(now[i]) < 1e-7 else 0.0


@jit
def _another_fell(t, y, data, mode, which):
    """Whether at the switch of ``which`` another function of ``mode`` has already fallen."""
    now = np.empty(SWITCH_COUNT)
    switches(t, y, data, mode, now)
    now[which] = 0.0
    return now.min() < -1e-7


@jit
def _land(t, y, data, mode, which):
    """Time of a switch after one step along the tangent, which is also taken in ``y``."""
    dy, now, ahead = np.empty(STATE_SIZE), np.empty(SWITCH_COUNT), np.empty(SWITCH_COUNT)
    rates(t, y, data, mode, dy)
    switches(t, y, data, mode, now)
    small = 1e-6
    switches(t + small, y + small * dy, data, mode, ahead)
    slope = (ahead[which] - now[which]) / small
    correction = -now[which] / slope if slope < 0.0 else 0.0
    if abs(correction) > 1e-6:
        return t
    y += correction * dy
    return t + correction


@jit
def _trajectory(y, data, stops, tolerance, longest, answers):
    """(time of alignment or NaN, evaluations, whether it came through)."""
    t, evaluations, switched, aligned = 0.0, 0, 0, np.nan
    mode = first_mode(t, y, data)
    for row in range(stops.size):
        stop = stops[row]
        while t < stop:
            _lift(t, y, data, mode)
            first_step, until = 0.0, stop
            for attempt in range(6):
                span, end = np.array([t, until]), np.array([until])
                run = solve_ivp(
                    _RATES, span, y, end, "DOP853", SWITCH_COUNT, _SWITCHES,
                    data.ctypes.data, first_step, longest, max(tolerance, 3e-14), tolerance,
                )  # fmt: skip
                evaluations += run.nfev
                if not run.event_found:
                    break
                if run.t_event <= t + 1e-12:
                    first_step = min(1e-3 * 0.1**attempt, until - t)
                elif _another_fell(run.t_event, run.y_event, data, mode, run.ind_event):
                    until = run.t_event - 2e-8
                else:
                    break
            if not run.success:
                return aligned, evaluations, False
            if not run.event_found:
                t = until
                y[:] = run.y[0]
                continue
            y[:] = run.y_event
            which = run.ind_event
            t = _land(run.t_event, y, data, mode, which)
            mode = next_mode(t, y, data, mode, which)
            switched += 1
            if mode == ALIGNED:
                return t, evaluations, True
            if switched > _MOST_SWITCHES:
                return aligned, evaluations, False
        answers[row] = y
    return aligned, evaluations, True


class NumbalsodaDop853(Method):
    """DOP853 of Hairer and Wanner behind numba."""

    name = "numbalsoda DOP853"
    package = "numbalsoda"
    formulation = "numba throughout, restart at each switch"

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""
        stops = np.array(problem.checkpoints or (problem.horizon,))
        answers: list[Any] = []
        evaluations = 0
        for case in cases:
            states = np.full((stops.size, STATE_SIZE), np.nan)
            data = np.zeros(_DATA_SIZE)
            data[:DEVICE_SIZE] = device(case)
            aligned, counted, through = _trajectory(
                start(case), data, stops, tolerance, longest_step(case), states
            )
            if not through:
                raise NotReachedError("endless switching, or the step became too small")
            if cpu_seconds() > deadline:
                raise NotReachedError("out of time")
            evaluations += counted
            answers.append(states.ravel() if problem.checkpoints else np.array([aligned]))
        return Solution(np.array(answers), evaluations)
