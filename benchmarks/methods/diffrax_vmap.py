"""diffrax under ``vmap``, in double precision and compiled: every lane restarts at its switches.

A lane that waits at its switch or has come to its end waits for the slowest one of the batch.
"""

import math
import os
from collections.abc import Sequence
from typing import Any

os.environ.setdefault("EQX_ON_ERROR", "nan")  # one lane's failed root search must not end them all

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import optimistix

from benchmarks.equations import Device, device, equations
from benchmarks.methods.base import Method, NotReachedError, Solution, cpu_seconds, longest_step
from benchmarks.modes import (
    ALIGNED,
    BEYOND,
    FACE_END,
    FRICTION,
    LOAD,
    OPEN,
    RELEASED,
    SLIDE_NEGATIVE,
    SLIDE_POSITIVE,
    STICK,
    first_mode,
    start,
)
from benchmarks.problems import Problem
from model import Parameters

jax.config.update("jax_enable_x64", True)

_MOST_SWITCHES = 1_500
_LIFT = 1e-12
_EQUATIONS = equations(jnp.sin, jnp.cos)


def _sign(mode: Any) -> Any:
    return jnp.where(mode == SLIDE_POSITIVE, 1.0, -1.0)


def _rates(t: Any, y: Any, arguments: Any) -> Any:
    p, mode, _ = arguments
    p = Device(*p)
    at = _EQUATIONS.touch(y, p)
    load = jnp.where(mode >= SLIDE_POSITIVE, at.load, 0.0)
    sticking = _EQUATIONS.sticking_friction(t, y, p, at)
    friction = jnp.where(mode == STICK, sticking, -_sign(mode) * p.friction * load)
    return jnp.stack([*y[3:], *_EQUATIONS.accelerations(t, y, p, at, load, friction)])


def _switch(which: int) -> Any:
    """A switching function as diffrax takes it; 1 where the mode has none."""

    def function(t: Any, y: Any, args: Any, **_: Any) -> Any:
        p, mode, _ = args
        p = Device(*p)
        at = _EQUATIONS.touch(y, p)
        if which == LOAD:
            value = jnp.select(
                [mode == OPEN, mode == BEYOND, mode == RELEASED],
                [-at.depth, 1.0, -at.load],
                at.load,
            )
        elif which == FRICTION:
            limit = p.friction * at.load - jnp.abs(_EQUATIONS.sticking_friction(t, y, p, at))
            value = jnp.select(
                [mode <= BEYOND, mode == RELEASED, mode == STICK],
                [1.0, at.depth, limit],
                _sign(mode) * at.slip,
            )
        else:
            end = p.half_width - at.along_face
            value = jnp.where(mode == BEYOND, -end, end)
        return value + _LIFT

    return function


_SWITCHES = tuple(_switch(which) for which in (LOAD, FRICTION, FACE_END))


def _switches(t: Any, y: Any, args: Any) -> Any:
    return jnp.stack([function(t, y, args) for function in _SWITCHES])


def _first_switch(t: Any, y: Any, args: Any, **_: Any) -> Any:
    """The smallest function: of several events in a step diffrax does not tell the earliest."""
    return _switches(t, y, args).min()


def _next_mode(t: Any, y: Any, p: Any, mode: Any, which: Any) -> tuple[Any, Any]:
    """(mode, state) after a switch, as ``modes.next_mode``."""
    p = Device(*p)
    at = _EQUATIONS.touch(y, p)
    corner_x, corner_y = _EQUATIONS.left_corner(y, p)
    aligned = (corner_x >= -p.slot_half_width) & (corner_y < 0.0)
    friction = _EQUATIONS.sticking_friction(t, y, p, at)
    free = _EQUATIONS.slip_acceleration(t, y, p, at, at.load, 0.0)

    def sliding(slip: Any) -> Any:
        return jnp.where(slip < 0.0, SLIDE_NEGATIVE, SLIDE_POSITIVE)

    rest = jnp.where(jnp.abs(friction) <= p.friction * at.load, STICK, sliding(free))
    mode_after = jnp.select(
        [
            mode == BEYOND,
            which == FACE_END,
            mode == OPEN,
            mode == RELEASED,
            which == LOAD,
            mode == STICK,
        ],
        [
            OPEN,
            jnp.where(aligned, ALIGNED, BEYOND),
            sliding(at.slip),
            jnp.where(which == FRICTION, OPEN, sliding(at.slip)),
            jnp.where(at.depth > 0.0, RELEASED, OPEN),
            sliding(-friction),
        ],
        rest,
    )
    stops = (which == FRICTION) & ((mode == SLIDE_POSITIVE) | (mode == SLIDE_NEGATIVE))
    impulse = -at.slip / (1.0 + at.along_axis**2 / p.inertia)
    change = jnp.stack([at.cos, at.sin, -at.along_axis / p.inertia]) * impulse
    return mode_after, jnp.where(stops, y.at[3:].add(change), y)


def _trajectory(y: Any, p: Any, mode: Any, stops: Any, tolerance: Any, longest: Any) -> Any:
    """(time of alignment or of the last stop, whether aligned, states at the stops)."""
    root_finder = optimistix.Bisection(rtol=1e-14, atol=1e-14, flip="detect")
    event = diffrax.Event(_first_switch, root_finder, direction=False)
    controller = diffrax.PIDController(rtol=tolerance, atol=tolerance, dtmax=longest)

    def segment(carry: Any) -> Any:
        t, y, mode, stop_index, states, switched = carry
        stop = stops[stop_index]
        run = diffrax.diffeqsolve(
            diffrax.ODETerm(_rates), diffrax.Dopri8(), t, stop,
            jnp.minimum(1e-3, stop - t), y, (p, mode, 0.0), event=event,
            saveat=diffrax.SaveAt(t1=True), stepsize_controller=controller,
            max_steps=None, throw=False,
        )  # fmt: skip
        t, y = run.ts[-1], run.ys[-1]
        hit, which = run.event_mask, jnp.argmin(_switches(t, y, (p, mode, 0.0)))
        after, y_after = _next_mode(t, y, p, mode, which)
        mode, y = jnp.where(hit, after, mode), jnp.where(hit, y_after, y)
        states = jnp.where(hit, states, states.at[stop_index].set(y))
        stop_index = stop_index + jnp.where(hit, 0, 1)
        return t, y, mode, stop_index, states, switched + 1

    def goes_on(carry: Any) -> Any:
        t, _, mode, stop_index, _, switched = carry
        unfinished = (mode != ALIGNED) & (stop_index < stops.size)
        return unfinished & (switched < _MOST_SWITCHES) & jnp.isfinite(t)

    states = jnp.full((stops.size, 6), jnp.nan)
    t, _, mode, _, states, _ = jax.lax.while_loop(
        goes_on, segment, (jnp.zeros(()), y, mode, jnp.zeros((), int), states, 0)
    )
    return t, mode == ALIGNED, states


_run = jax.jit(jax.vmap(_trajectory, in_axes=(0, 0, 0, None, None, 0)))


class DiffraxVmap(Method):
    """Dopri8 on a batch."""

    name = "diffrax Dopri8"
    package = "diffrax"
    formulation = "64 lanes by vmap, jit, double precision, restart at each switch"
    batch = 64

    def __init__(self) -> None:
        self._compiled: set[int] = set()

    def warm(self, problem: Problem, tolerance: float) -> None:
        """As ``Method.warm``: every number of stops is compiled."""
        if len(problem.checkpoints) not in self._compiled:
            self._compiled.add(len(problem.checkpoints))
            stops = tuple(1e-3 * time for time in problem.checkpoints)
            short = Problem("short", problem.cases[:1], 1e-3, stops)
            self.solve(short, short.cases, tolerance, math.inf)

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``; batches are filled up so that one shape is compiled."""
        stops = jnp.array(problem.checkpoints or (problem.horizon,))
        answers: list[Any] = []
        for first in range(0, len(cases), self.batch):
            part = list(cases[first : first + self.batch])
            filled = [part[lane % len(part)] for lane in range(self.batch)]
            y = np.array([start(case) for case in filled])
            p = np.array([device(case) for case in filled])
            modes = np.array([first_mode(0.0, y[lane], p[lane]) for lane in range(self.batch)])
            longest = np.array([longest_step(case) for case in filled])
            t, aligned, states = _run(y, p, modes, stops, tolerance, longest)
            if cpu_seconds() > deadline:
                raise NotReachedError("out of time")
            if problem.checkpoints:
                answers.extend(np.asarray(states)[: len(part)].reshape(len(part), -1))
            else:
                times = np.where(np.asarray(aligned), np.asarray(t), np.nan)
                answers.extend(times[: len(part), np.newaxis])
        return Solution(np.array(answers), None)
