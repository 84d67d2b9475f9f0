"""heyoka's batch Taylor integrator with terminal events, one trajectory a vector lane.

The mode of a lane is in its runtime parameters, which callbacks of the events change. A lane whose
trajectory has ended takes the next one.
"""

from collections.abc import Sequence
from time import process_time
from typing import Any

import heyoka as hy
import llvmlite.binding as ll
import numpy as np

from verification.bench.equations import (
    ALIGNED,
    DEVICE_SIZE,
    MODES,
    STATE_SIZE,
    Device,
    Mode,
    device,
    equations,
    first_mode,
    jit,
    next_mode,
    start,
)
from verification.bench.methods.base import Method, NotReachedError
from verification.bench.problems import Problem, Solution
from vibralign import Parameters

_BATCH = 1024  # trajectories in a call: few lanes are empty at the end
_WIDEST = 8  # numbers in a vector of 512 bits
# Added to event functions: heyoka misses a root in a step that starts exactly on zero.
_LIFT = 1e-14
_COEFFICIENTS = np.array(MODES)  # runtime parameters of a lane, after those of the device


def _system() -> tuple[list[tuple[Any, Any]], list[Any]]:
    """Return the equations and the event functions, with modes as parameters."""
    y = hy.make_vars("x", "y", "tilt", "x_rate", "y_rate", "tilt_rate")
    p = Device(*(hy.par[i] for i in range(DEVICE_SIZE)))
    mode = Mode(*(hy.par[DEVICE_SIZE + i] for i in range(len(Mode._fields))))
    own = equations(hy.sin, hy.cos)
    rates = own.rates(hy.time, y, p, mode)
    return list(zip(y, rates, strict=True)), list(own.event_functions(hy.time, y, p, mode))


@jit
def _change_mode(t, state, pars, modes, lane, which):
    """Apply an event to a lane; return its new mode."""
    y = state[:, lane].copy()
    mode = next_mode(t, y, pars[:DEVICE_SIZE, lane].copy(), modes[lane], which)
    state[:, lane] = y
    modes[lane] = mode
    pars[DEVICE_SIZE:, lane] = _COEFFICIENTS[mode]
    return mode


class _Lanes:
    """A batch integrator, and the modes of its lanes."""

    def __init__(self, tolerance: float, width: int) -> None:
        system, events = _system()
        self.modes = np.zeros(width, dtype=np.int64)
        self.aligned: list[tuple[int, float]] = []

        def callback(which: int) -> Any:
            def switched(_: Any, __: int, lane: int) -> bool:
                t = self.times[lane]
                mode = _change_mode(t, self.state, self.pars, self.modes, lane, which)
                if mode == ALIGNED:
                    self.aligned.append((lane, float(t)))
                return True

            return switched

        self.integrator = hy.taylor_adaptive_batch(
            system,
            np.zeros((STATE_SIZE, width)),
            tol=max(tolerance, 1e-16),
            pars=np.ones((DEVICE_SIZE + len(Mode._fields), width)),
            force_avx512=width == _WIDEST,
            t_events=[
                hy.t_event_batch(
                    event + _LIFT, callback=callback(which), direction=hy.event_direction.negative
                )
                for which, event in enumerate(events)
            ],
        )
        self.state, self.pars = self.integrator.state, self.integrator.pars
        self.times = self.integrator.time
        self.width = width

    def fill(self, lane: int, case: Parameters) -> None:
        """Start a case in a lane."""
        y, p = start(case), np.array(device(case))
        self.state[:, lane], self.pars[:DEVICE_SIZE, lane] = y, p
        self.modes[lane] = first_mode(0.0, y, p)
        self.pars[DEVICE_SIZE:, lane] = MODES[self.modes[lane]]
        times = self.integrator.time.copy()
        times[lane] = 0.0
        self.integrator.set_time(times)
        self.integrator.reset_cooldowns(lane)


class HeyokaBatch(Method):
    """heyoka with one trajectory a vector lane."""

    name = "heyoka batch"

    def __init__(self) -> None:
        # heyoka recommends 256 bits also on machines with 512, which are up to 1.6 times faster.
        wide = ll.get_host_cpu_features().get("avx512f", False)
        self.width = _WIDEST if wide else hy.recommended_simd_size()
        self.batch = _BATCH
        self._lanes: dict[float, _Lanes] = {}

    def warm(self, problem: Problem, tolerance: float) -> None:
        """As ``Method.warm``; each tolerance is compiled anew."""
        super().warm(problem, tolerance)
        self._at(tolerance)

    def _at(self, tolerance: float) -> _Lanes:
        if tolerance not in self._lanes:
            self._lanes[tolerance] = _Lanes(tolerance, self.width)
        return self._lanes[tolerance]

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""
        lanes = self._at(tolerance)
        if problem.checkpoints:
            return self._to_checkpoints(lanes, problem, cases, deadline)
        return self._to_alignment(lanes, problem, cases, deadline)

    def _to_checkpoints(
        self, lanes: _Lanes, problem: Problem, cases: Sequence[Parameters], deadline: float
    ) -> Solution:
        answers = []
        for first in range(0, len(cases), lanes.width):
            part = list(cases[first : first + lanes.width])
            for lane in range(lanes.width):
                lanes.fill(lane, part[lane % len(part)])
            states = []
            for stop in problem.checkpoints:
                lanes.integrator.propagate_until(stop)
                if any(lanes.aligned) or process_time() > deadline:
                    lanes.aligned.clear()
                    raise NotReachedError("aligned where nothing aligns, or out of time")
                states.append(lanes.state[:, : len(part)].T.copy())
            answers.append(np.concatenate(states, axis=1))
        return problem.solution(np.concatenate(answers), None)

    def _to_alignment(
        self, lanes: _Lanes, problem: Problem, cases: Sequence[Parameters], deadline: float
    ) -> Solution:
        answers = np.full((len(cases), 1), np.nan)
        running = [lane if lane < len(cases) else None for lane in range(lanes.width)]
        for lane in range(lanes.width):
            lanes.fill(lane, cases[lane % len(cases)])
        waiting, steps = iter(range(lanes.width, len(cases))), 0
        while any(case is not None for case in running):
            lanes.integrator.step()
            steps += 1
            if steps % 256 == 0:
                if process_time() > deadline:
                    raise NotReachedError("out of time")
                late = np.flatnonzero(lanes.times > problem.settings.horizon).tolist()
                lanes.aligned += [(lane, np.nan) for lane in late if running[lane] is not None]
            while lanes.aligned:
                lane, time = lanes.aligned.pop()
                if (done := running[lane]) is not None:
                    answers[done, 0] = time
                running[lane] = next(waiting, None)
                if (following := running[lane]) is not None:
                    lanes.fill(lane, cases[following])
        return problem.solution(answers, None)
