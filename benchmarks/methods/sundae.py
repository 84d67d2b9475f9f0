"""scikit-sundae's CVODE: compiled right-hand side and root functions, restarted at each event."""

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from sksundae.cvode import CVODE

from benchmarks.methods.base import Limits, drive
from benchmarks.modes import EVENTS, MODES, event_functions, rates
from model import Parameters
from verification.methods import Method, NotReachedError
from verification.problems import Problem, Solution


def _rates_in(mode: int) -> Any:
    @numba.njit(error_model="numpy")
    def rates_of_mode(t, y, out, data):
        rates(t, y, data[0], mode, out)

    return rates_of_mode


class _Events:
    """The event functions of a mode as CVODE takes them, all falling, all terminal."""

    def __init__(self, mode: int) -> None:
        count = len(EVENTS[mode])
        self.terminal, self.direction = [True] * count, [-1] * count
        wanted = np.array(EVENTS[mode])

        @numba.njit(error_model="numpy")
        def events_of_mode(t, y, out, data):
            every = np.empty(3)
            event_functions(t, y, data[0], mode, every)
            for i in range(wanted.size):
                out[i] = every[wanted[i]]

        self.function = events_of_mode

    def __call__(self, t: float, y: Any, out: Any, data: Any) -> None:
        self.function(t, y, out, data)


class Sundae(Method):
    """CVODE with one of its multistep families."""

    package = "scikit-sundae"
    formulation = "numba right-hand side and roots, restart at each event"

    def __init__(self, family: str) -> None:
        self.name, self.family = f"scikit-sundae CVODE {family}", family
        self._rates = {mode: _rates_in(mode) for mode in MODES}
        self._events = {mode: _Events(mode) for mode in MODES}

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""

        def segment(mode: int, t: float, y: Any, p: Any, stop: float, limits: Limits) -> Any:
            solver = CVODE(
                self._rates[mode], method=self.family, rtol=max(tolerance, 1e-15), atol=tolerance,
                eventsfn=self._events[mode], num_events=len(EVENTS[mode]), userdata=(p,),
                first_step=limits.first, max_step=limits.longest, max_num_steps=100_000,
            )  # fmt: skip
            run = solver.solve(np.array([t, stop]), y)
            if run.status < 0:
                raise NotReachedError(run.message)
            if run.i_events is None or len(run.i_events) == 0:
                return stop, run.y[-1].copy(), None, run.nfev
            which = int(np.flatnonzero(run.i_events[-1])[0])
            return float(run.t[-1]), run.y[-1].copy(), EVENTS[mode][which], run.nfev

        return drive(segment, problem, cases, deadline)
