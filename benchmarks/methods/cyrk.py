"""CyRK's ``pysolve_ivp``: compiled right-hand side and events, restarted at each event.

Its numba interface ``nbsolve2_ivp`` has no events; its Cython interface needs a compiler at hand.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numba
import numpy as np
from CyRK import pysolve_ivp

from benchmarks.methods.base import Limits, drive, events_of_modes
from benchmarks.modes import EVENTS, MODES, rates
from model import Parameters
from verification.methods import Method, NotReachedError
from verification.problems import Problem, Solution


def _rates_in(mode: int) -> Any:
    @numba.njit(error_model="numpy")
    def rates_of_mode(out, t, y, p):
        rates(t, y, p, mode, out)

    return rates_of_mode


class Cyrk(Method):
    """One of CyRK's methods."""

    package = "CyRK"
    formulation = "pysolve_ivp, numba right-hand side and events, restart at each event"

    def __init__(self, name: str) -> None:
        self.name, self.method = f"CyRK {name}", name
        self._rates = {mode: _rates_in(mode) for mode in MODES}
        self._events = events_of_modes()

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""

        def segment(mode: int, t: float, y: Any, p: Any, stop: float, limits: Limits) -> Any:
            run = pysolve_ivp(
                self._rates[mode], (t, stop), y, method=self.method, args=(p,),
                events=self._events[mode], rtol=max(tolerance, 3e-14), atol=tolerance,
                first_step=limits.first, max_step=limits.longest, pass_dy_as_arg=True,
            )  # fmt: skip
            if not run.success:
                raise NotReachedError(run.message)
            if not run.event_terminated:
                return stop, run.y[:, -1].copy(), None, 0
            which = run.event_terminate_index
            end = float(run.t_events[which][-1])
            return end, np.array(run.y_events[which][:, -1]), EVENTS[mode][which], 0

        return replace(drive(segment, problem, cases, deadline), evaluations=None)
