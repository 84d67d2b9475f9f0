"""heyoka's Taylor integrators with terminal events, one trajectory at a time or in vector lanes.

Scalar: an integrator for every mode, handed the state at each event. Batch: one integrator whose
mode is a set of runtime parameters of each lane, changed in the events' callbacks; a lane that is
done is refilled, as long as there are trajectories.
"""

from collections.abc import Sequence
from dataclasses import replace
from time import process_time
from typing import Any

import heyoka as hy
import llvmlite.binding as ll
import numpy as np

from benchmarks.equations import DEVICE_SIZE, Device, device, equations
from benchmarks.methods.base import Method, NotReachedError
from benchmarks.methods.restarts import BATCH, Limits, drive
from benchmarks.modes import (
    ALIGNED,
    BEYOND,
    FACE_END,
    FRICTION,
    LOAD,
    MODES,
    OPEN,
    RELEASED,
    SLIDE_POSITIVE,
    STATE_SIZE,
    STICK,
    first_mode,
    jit,
    next_mode,
    start,
)
from benchmarks.problems import Problem, Solution
from model import Parameters

_Y = hy.make_vars("x", "y", "tilt", "x_rate", "y_rate", "tilt_rate")
_P = Device(*(hy.par[i] for i in range(DEVICE_SIZE)))
_EQUATIONS = equations(hy.sin, hy.cos)
_AT = _EQUATIONS.touch(_Y, _P)
_WIDEST = 8  # numbers in a vector of 512 bits
_FALLING = hy.event_direction.negative
# A function that is exactly zero at a step's start hides a root in that step from heyoka.
_LIFT = 1e-14
_STICKING_FRICTION = _EQUATIONS.sticking_friction(hy.time, _Y, _P, _AT)


def _system(load: Any, friction: Any) -> list[tuple[Any, Any]]:
    accelerations = _EQUATIONS.accelerations(hy.time, _Y, _P, _AT, load, friction)
    return list(zip(_Y, (*_Y[3:], *accelerations), strict=True))


def _mode_system(mode: int) -> tuple[list[Any], list[tuple[int, Any]]]:
    """Equations of a mode, and its event functions with their names in ``modes``."""
    load, friction = hy.expression(0.0), hy.expression(0.0)
    end = _P.half_width - _AT.along_face
    if mode == OPEN:
        return _system(load, friction), [(LOAD, -_AT.depth), (FACE_END, end)]
    if mode == BEYOND:
        return _system(load, friction), [(FACE_END, -end)]
    if mode == RELEASED:
        events = [(LOAD, -_AT.load), (FRICTION, _AT.depth), (FACE_END, end)]
        return _system(load, friction), events
    if mode == STICK:
        limit = _P.friction * _AT.load
        events = [
            (LOAD, _AT.load),
            (FRICTION, limit - _STICKING_FRICTION),
            (FRICTION, limit + _STICKING_FRICTION),
            (FACE_END, end),
        ]
        return _system(_AT.load, _STICKING_FRICTION), events
    sign = 1.0 if mode == SLIDE_POSITIVE else -1.0
    events = [(LOAD, _AT.load), (FRICTION, sign * _AT.slip), (FACE_END, end)]
    return _system(_AT.load, -sign * _P.friction * _AT.load), events


class HeyokaScalar(Method):
    """One trajectory at a time."""

    name = "heyoka scalar"
    package = "heyoka"
    formulation = "an integrator for each mode, terminal events"
    ladder_step = 2  # every tolerance is compiled anew

    def __init__(self) -> None:
        self._integrators: dict[float, dict[int, tuple[Any, list[int]]]] = {}

    def warm(self, problem: Problem, tolerance: float) -> None:
        """As ``Method.warm``: every tolerance is compiled."""
        super().warm(problem, tolerance)
        self._at(tolerance)

    def _at(self, tolerance: float) -> dict[int, tuple[Any, list[int]]]:
        if tolerance not in self._integrators:
            self._integrators[tolerance] = {
                mode: self._integrator(mode, tolerance) for mode in MODES
            }
        return self._integrators[tolerance]

    def _integrator(self, mode: int, tolerance: float) -> tuple[Any, list[int]]:
        system, events = _mode_system(mode)
        integrator = hy.taylor_adaptive(
            system,
            [0.0] * STATE_SIZE,
            tol=max(tolerance, 1e-16),
            pars=[1.0] * DEVICE_SIZE,
            t_events=[hy.t_event(event + _LIFT, direction=_FALLING) for _, event in events],
        )
        return integrator, [which for which, _ in events]

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""
        integrators = self._at(tolerance)

        def segment(mode: int, t: float, y: Any, p: Any, stop: float, _: Limits) -> Any:
            integrator, which = integrators[mode]
            integrator.time = t
            integrator.state[:] = y
            integrator.pars[:] = p
            integrator.reset_cooldowns()
            outcome = int(integrator.propagate_until(stop)[0])
            y = integrator.state.copy()
            if outcome == int(hy.taylor_outcome.time_limit):
                return stop, y, None, 0
            if not -len(which) <= outcome < 0:
                raise NotReachedError(str(hy.taylor_outcome(outcome)))
            return float(integrator.time), y, which[-outcome - 1], 0

        return replace(drive(segment, problem, cases, deadline), evaluations=None)


# Runtime parameters of a lane behind those of the device: what multiplies load, sliding and
# sticking friction, then the coefficients of the event functions.
_F = [hy.par[DEVICE_SIZE + i] for i in range(12)]
_LANE_SIZE = DEVICE_SIZE + len(_F)


def _lane_system() -> tuple[list[Any], list[tuple[int, Any]]]:
    """The equations and event functions of every mode at once."""
    load, limit = _AT.load, _P.friction * _AT.load
    friction = _F[1] * limit + _F[2] * _STICKING_FRICTION
    opening = _F[8] * _AT.depth
    events = [
        (LOAD, _F[3] * load + _F[4] * _AT.depth + _F[5]),
        (FRICTION, _F[6] * _AT.slip + _F[7] * (limit - _STICKING_FRICTION) + opening + _F[9]),
        (FRICTION, _F[7] * (limit + _STICKING_FRICTION) + _F[10]),
        (FACE_END, _F[11] * (_P.half_width - _AT.along_face)),
    ]
    return _system(_F[0] * load, friction), events


@jit
def _set_mode(mode, out):
    """Write the lane's parameters for ``mode``; what starts at zero is lifted off it."""
    out[:] = 0.0
    out[5], out[9] = _LIFT, _LIFT
    out[10], out[11] = 1.0, 1.0
    if mode == OPEN:
        out[4], out[9] = -1.0, 1.0
    elif mode == RELEASED:
        out[3], out[8] = -1.0, 1.0
    elif mode == BEYOND or mode == ALIGNED:
        out[5], out[9], out[11] = 1.0, 1.0, -1.0
    else:
        out[0], out[3] = 1.0, 1.0
        if mode == STICK:
            out[2], out[7], out[10] = 1.0, 1.0, _LIFT
        else:
            sign = 1.0 if mode == SLIDE_POSITIVE else -1.0
            out[1], out[6] = -sign, sign


@jit
def _change_mode(t, state, pars, modes, lane, which):
    """Apply an event to a lane; return its new mode."""
    y = state[:, lane].copy()
    mode = next_mode(t, y, pars[:DEVICE_SIZE, lane].copy(), modes[lane], which)
    state[:, lane] = y
    modes[lane] = mode
    _set_mode(mode, pars[DEVICE_SIZE:, lane])
    return mode


class _Lanes:
    """A batch integrator, and the modes of its lanes."""

    def __init__(self, tolerance: float, width: int) -> None:
        system, events = _lane_system()
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
            pars=np.ones((_LANE_SIZE, width)),
            force_avx512=width == _WIDEST,
            t_events=[
                hy.t_event_batch(event, callback=callback(which), direction=_FALLING)
                for which, event in events
            ],
        )
        self.state, self.pars = self.integrator.state, self.integrator.pars
        self.times = self.integrator.time
        self.width = width

    def fill(self, lane: int, case: Parameters) -> None:
        """Start ``case`` in ``lane``."""
        y, p = start(case), np.array(device(case))
        self.state[:, lane], self.pars[:DEVICE_SIZE, lane] = y, p
        self.modes[lane] = first_mode(0.0, y, p)
        _set_mode(self.modes[lane], self.pars[DEVICE_SIZE:, lane])
        times = self.integrator.time.copy()
        times[lane] = 0.0
        self.integrator.set_time(times)
        self.integrator.reset_cooldowns(lane)


class HeyokaBatch(Method):
    """A trajectory in each vector lane of the machine."""

    name = "heyoka batch"
    package = "heyoka"
    ladder_step = 2

    def __init__(self) -> None:
        # heyoka recommends 256 bits where there are 512 too; these are up to 1.6 times faster.
        wide = ll.get_host_cpu_features().get("avx512f", False)
        self.width = _WIDEST if wide else hy.recommended_simd_size()
        self.batch = BATCH
        self.formulation = f"{self.width} lanes, modes as parameters, terminal events, refilled"
        self._lanes: dict[float, _Lanes] = {}

    def warm(self, problem: Problem, tolerance: float) -> None:
        """As ``Method.warm``: every tolerance is compiled."""
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
