"""scipy's ``solve_ivp``: compiled right-hand side and events, restarted at every event."""

from collections.abc import Sequence
from typing import Any

from scipy.integrate import solve_ivp

from benchmarks.methods.base import Method, NotReachedError
from benchmarks.methods.restarts import CAREFUL, Limits, drive, events_of_modes
from benchmarks.modes import EVENTS, MODES, rates_in
from benchmarks.problems import Problem, Solution
from model import Parameters


class ScipyIvp(Method):
    """One of scipy's methods."""

    package = "scipy"
    formulation = "numba right-hand side and events, restart at each event"

    def __init__(self, name: str) -> None:
        self.name, self.method = f"scipy {name}", name
        self._rates = {mode: rates_in(mode) for mode in MODES}
        self._events = events_of_modes()

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""

        def segment(mode: int, t: float, y: Any, p: Any, stop: float, limits: Limits) -> Any:
            try:
                run = solve_ivp(
                    self._rates[mode], (t, stop), y, method=self.method, args=(p,),
                    events=self._events[mode], rtol=max(tolerance, 3e-14), atol=tolerance,
                    first_step=limits.first or None, max_step=limits.longest,
                )  # fmt: skip
            except ValueError as error:  # LSODA's dense output denies the change of sign it saw
                if "different signs" not in str(error):
                    raise
                if 0.0 < limits.first <= CAREFUL[-1]:
                    raise NotReachedError("an event was seen and not found") from None
                return t, y, EVENTS[mode][0], 0  # as if at once: to be tried again
            if run.status < 0:
                raise NotReachedError(run.message)
            if run.status == 0:
                return stop, run.y[:, -1].copy(), None, run.nfev
            which = next(k for k, times in enumerate(run.t_events) if times.size)
            return float(run.t[-1]), run.y[:, -1].copy(), EVENTS[mode][which], run.nfev

        return drive(segment, problem, cases, deadline)
