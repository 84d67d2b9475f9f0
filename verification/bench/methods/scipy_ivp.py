"""scipy's ``solve_ivp`` with compiled right-hand side and events, restarted at every event."""

import importlib
import math
from collections.abc import Sequence
from time import process_time
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from verification.bench.equations import (
    ALIGNED,
    EVENTS,
    device,
    event_in,
    first_mode,
    next_mode,
    rates_in,
    start,
)
from verification.bench.methods.base import Method, NotReachedError
from verification.bench.problems import Problem, Solution
from vibralign import Parameters

_MOST_EVENTS = 20_000  # of one trajectory; W3 has about 1,000
_AT_ONCE = 1e-12  # events closer than this are taken as simultaneous
_FIRST = (0.0, 1e-3, 1e-5, 1e-7)  # first steps to try, after such events; 0: the method's own


class ScipyIvp(Method):
    """One of scipy's methods."""

    def __init__(self, name: str) -> None:
        importlib.import_module("numba")  # else the right-hand sides would be Python
        self.name, self.method = f"scipy {name}", name
        self._rates = {mode: rates_in(mode) for mode in EVENTS}
        self._events = {
            mode: [_Event(event_in(mode, which)) for which in EVENTS[mode]] for mode in EVENTS
        }

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``: one case after the other, integrated up to each event and restarted.

        A mode starts on a zero of one of its functions. If this function rises and falls again
        within the first step, scipy, which compares signs, finds the event at the start once more.
        The step is then repeated with smaller first steps.
        """
        answers, evaluations = [], 0
        for case in cases:
            p, y, t = np.array(device(case)), start(case), 0.0
            mode, events, aligned = first_mode(t, y, p), 0, np.nan
            # In flight, steps longer than an eighth of the excitation's period could go across a
            # whole contact.
            longest = 0.25 * math.pi / case.frequency
            states: list[Any] = []
            for stop in problem.stops:
                while t < stop and mode != ALIGNED:
                    for first in _FIRST:
                        limits = {"first_step": min(first, stop - t) or None, "max_step": longest}
                        end, y_end, which, counted = self._segment(
                            mode, t, y, p, stop, tolerance, limits
                        )
                        evaluations += counted
                        if which is None or end - t > _AT_ONCE:
                            break
                    t, y = end, y_end
                    if which is not None:
                        mode = next_mode(t, y, p, mode, which)
                        events += 1
                    if events > _MOST_EVENTS:
                        raise NotReachedError("endless events")
                    if process_time() > deadline:
                        raise NotReachedError("out of time")
                if mode == ALIGNED:
                    aligned = t
                    break
                states.append(y.copy())
            if not problem.checkpoints:
                answers.append(np.array([aligned]))
            elif len(states) == len(problem.checkpoints):
                answers.append(np.concatenate(states))
            else:  # it aligned where nothing aligns
                answers.append(np.full(len(problem.checkpoints) * 6, np.nan))
        return problem.solution(np.array(answers), evaluations)

    def _segment(
        self, mode: int, t: float, y: Any, p: Any, stop: float, tolerance: float, limits: Any
    ) -> tuple[float, Any, int | None, int]:
        """Integrate in a mode from t up to a stop, under limits on the steps.

        Return (t, y, the event function that ended it or None, right-hand sides evaluated).
        """
        try:
            run = solve_ivp(
                self._rates[mode], (t, stop), y, method=self.method, args=(p,),
                events=self._events[mode], rtol=max(tolerance, 3e-14), atol=tolerance, **limits,
            )  # fmt: skip
        except ValueError as error:  # LSODA's dense output has no change of sign after all
            if "different signs" not in str(error):
                raise
            if 0.0 < (limits["first_step"] or 0.0) <= _FIRST[-1]:
                raise NotReachedError("an event was seen and not found") from None
            return t, y, EVENTS[mode][0], 0  # as an event at the start: tried again
        if run.status < 0:
            raise NotReachedError(run.message)
        if run.status == 0:
            return stop, run.y[:, -1].copy(), None, run.nfev
        which = next(k for k, times in enumerate(run.t_events) if times.size)
        return float(run.t[-1]), run.y[:, -1].copy(), EVENTS[mode][which], run.nfev


class _Event:
    """An event function for scipy: it ends the run where it crosses zero downwards."""

    terminal = 1
    direction = -1

    def __init__(self, function: Any) -> None:
        self.function = function

    def __call__(self, t: float, y: Any, p: Any) -> float:
        """Return the value of the function."""
        return float(self.function(t, y, p))
