"""scipy's ``solve_ivp`` with the right-hand side without modes; its only event is the fall.

scipy looks for changes of sign. So a part that has fallen in at the start is told from the start,
and an exact zero of the event function, a corner beside the edge, is given as not fallen yet.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from model.compile.entries import bound
from model.physics.notation import STATE_SIZE
from model.physics.parameters import Batch, Parameters
from verification.bench.methods.base import Method
from verification.bench.methods.by_hand import outside_of, solve_by_hand, write_rates
from verification.bench.problems import Floats, Problem, Solution, Verdict

_NOT_YET = float(np.finfo(float).tiny)


class _TooManyEvaluationsError(Exception):
    pass


class ScipyUnlocated(Method):
    """One of scipy's methods, with a compiled right-hand side."""

    interpreted = True
    located = False

    def __init__(self, solver: str) -> None:
        self.name, self.solver = f"scipy {solver}", solver

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``; the absolute tolerance is the relative one, as in the package."""
        found = [self._solve_one(problem, case, resolution) for case in cases]
        failures = [each.failure for each in found if each.failure is not None]
        return Solution(
            np.concatenate([each.tau_align for each in found]),
            np.concatenate([each.states for each in found]),
            sum(each.evaluations or 0 for each in found),
            failures[0] if failures else None,
        )

    def _solve_one(self, problem: Problem, parameters: Parameters, resolution: float) -> Solution:
        row = Batch.stack([parameters]).constants(problem.settings.readings)[0]
        # With one evaluation allowed RK4 makes no step, and returns the start.
        at_once = replace(problem.settings, max_evaluations=1)
        begun = solve_by_hand(Batch.stack([parameters]), "rk4", 1.0, at_once).states[0, 0]
        evaluations, at, out = 0, np.empty(1 + STATE_SIZE), np.empty(STATE_SIZE)
        write, fall_of = bound(write_rates, at, row, out), bound(outside_of, at, row)

        def rates_at(moment: float, y: Floats) -> Floats:
            nonlocal evaluations
            evaluations += 1
            if evaluations > problem.interpreted_evaluations:
                raise _TooManyEvaluationsError
            at[0], at[1:] = moment, y
            write()
            return out.copy()

        def level(moment: float, y: Floats) -> float:
            at[0], at[1:] = moment, y
            return fall_of()

        def fall(moment: float, y: Floats) -> float:
            return level(moment, y) or _NOT_YET

        def ended(tau: float, state: Floats, failure: Verdict | None) -> Solution:
            return Solution(np.array([tau]), state.reshape(1, 1, 6), evaluations, failure)

        fall.terminal, fall.direction = True, -1.0  # type: ignore[attr-defined]
        if level(0.0, begun) < 0.0:
            return ended(0.0, begun, None)
        try:
            # A solver that steps across a contact may overflow: its verdict shows it.
            with np.errstate(all="ignore"):
                run = solve_ivp(
                    rates_at, (0.0, problem.settings.horizon), begun, method=self.solver,
                    rtol=resolution, atol=resolution, events=fall,
                )  # fmt: skip
        except _TooManyEvaluationsError:
            return ended(math.nan, begun, Verdict.TOO_MANY_EVALUATIONS)
        falls = run.t_events[0]
        tau_align = float(falls[0]) if falls.size else math.nan
        return ended(tau_align, run.y[:, -1], Verdict.FAILED if run.status < 0 else None)
