"""The peers' modes and events: right-hand sides, event functions and what follows an event.

A mode is a smooth vector field. It ends at a down-crossing of one of its event functions;
``next_mode`` gives the mode that follows. scipy calls these kernels through the interpreter; heyoka
takes the same equations as expressions.
"""

import math

import numba
import numpy as np

from benchmarks.equations import DEVICE_SIZE, Device, equations

# In flight with A1 under the bottom face, or beyond B1; overlapping without load; pressing.
OPEN, BEYOND, RELEASED, SLIDE_POSITIVE, SLIDE_NEGATIVE, STICK, ALIGNED = range(7)
MODES = (OPEN, BEYOND, RELEASED, SLIDE_POSITIVE, SLIDE_NEGATIVE, STICK)

# Event functions. LOAD: the load vanishes; released, it returns; open, the edge touches.
# FRICTION: the slip vanishes; sticking, the friction limit is reached; released, the gap opens.
# FACE_END: A1 passes the corner B1; beyond it, it comes back.
LOAD, FRICTION, FACE_END = range(3)
EVENTS = {
    OPEN: (LOAD, FACE_END),
    BEYOND: (FACE_END,),
    RELEASED: (LOAD, FRICTION, FACE_END),
    SLIDE_POSITIVE: (LOAD, FRICTION, FACE_END),
    SLIDE_NEGATIVE: (LOAD, FRICTION, FACE_END),
    STICK: (LOAD, FRICTION, FACE_END),
}
EVENT_COUNT = 3
STATE_SIZE = 6
_MOMENT = 1e-5

jit = numba.njit(error_model="numpy", nogil=True)
EQUATIONS = equations(math.sin, math.cos, jit)
_touch, _accelerations, _slip_acceleration, _sticking_friction, _left_corner = EQUATIONS


@jit
def device_of(p):
    """``Device`` from the array ``p`` of its values."""
    return Device(
        p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13],
        p[14], p[15], p[16], p[17],
    )  # fmt: skip


@jit
def rates(t, y, p, mode, out):
    """Write dy/dt in ``mode`` into ``out``, shape (6,)."""
    q = device_of(p)
    at = _touch(y, q)
    load, friction = 0.0, 0.0
    if mode >= SLIDE_POSITIVE:
        load = at.load
        if mode == STICK:
            friction = _sticking_friction(t, y, q, at)
        else:
            friction = (-load if mode == SLIDE_POSITIVE else load) * q.friction
    out[0], out[1], out[2] = y[3], y[4], y[5]
    out[3], out[4], out[5] = _accelerations(t, y, q, at, load, friction)


@jit
def event_functions(t, y, p, mode, out):
    """Write the event functions of ``mode`` into ``out``, shape (3,); 1 where there is none."""
    q = device_of(p)
    at = _touch(y, q)
    out[FACE_END] = q.half_width - at.along_face
    if mode == OPEN:
        out[LOAD], out[FRICTION] = -at.depth, 1.0
    elif mode == BEYOND:
        out[LOAD], out[FRICTION], out[FACE_END] = 1.0, 1.0, -out[FACE_END]
    elif mode == RELEASED:
        out[LOAD], out[FRICTION] = -at.load, at.depth
    elif mode == STICK:
        out[LOAD] = at.load
        out[FRICTION] = q.friction * at.load - abs(_sticking_friction(t, y, q, at))
    else:
        out[LOAD] = at.load
        out[FRICTION] = at.slip if mode == SLIDE_POSITIVE else -at.slip


@jit
def _sliding(slip):
    return SLIDE_NEGATIVE if slip < 0.0 else SLIDE_POSITIVE


@jit
def first_mode(t, y, p):
    """At rest on the edge without load: it slides as it would without friction, or lifts off."""
    q = device_of(p)
    at = _touch(y, q)
    ahead = y.copy()
    rates(t, y, p, OPEN, ahead)
    if _touch(y + _MOMENT * ahead, q).load <= 0.0:
        return OPEN
    return _sliding(_slip_acceleration(t, y, q, at, 0.0, 0.0))


@jit
def _aligned(y, q):
    """Return whether B2 is inside the slot; the caller knows that A1 is beyond B1."""
    x, height = _left_corner(y, q)
    return x >= -q.slot_half_width and height < 0.0


@jit
def _stop_slip(y, q, at):
    """Take the slip left by the location of an event out of ``y``, by a friction impulse."""
    impulse = -at.slip / (1.0 + at.along_axis * at.along_axis / q.inertia)
    y[3] += impulse * at.cos
    y[4] += impulse * at.sin
    y[5] -= impulse * at.along_axis / q.inertia


@jit
def next_mode(t, y, p, mode, which):
    """The mode after ``which`` of ``mode`` has fallen; a slip that ends is taken out of ``y``."""
    q = device_of(p)
    at = _touch(y, q)
    if mode == BEYOND:
        return OPEN
    if which == FACE_END:
        return ALIGNED if _aligned(y, q) else BEYOND
    if mode == OPEN:
        return _sliding(at.slip)
    if mode == RELEASED:
        return OPEN if which == FRICTION else _sliding(at.slip)
    if which == LOAD:
        return RELEASED if at.depth > 0.0 else OPEN
    friction = _sticking_friction(t, y, q, at)
    if mode == STICK:
        return _sliding(-friction)
    _stop_slip(y, q, at)
    if abs(friction) <= q.friction * at.load:
        return STICK
    return _sliding(_slip_acceleration(t, y, q, at, at.load, 0.0))


def start(parameters) -> np.ndarray:
    """State (6,) at τ = 0: at rest, the bottom face touching A1 without pressing."""
    x, tilt = parameters.misalignment, parameters.initial_tilt
    r_x = parameters.slot_half_width - x
    y = (parameters.half_height - r_x * math.sin(tilt)) / math.cos(tilt)
    return np.array([x, y, tilt, 0.0, 0.0, 0.0])


def rates_in(mode: int):
    """``f(t, y, p) -> dy/dt`` in ``mode``, compiled."""

    @numba.njit(
        ["f8[::1](f8, f8[::1], f8[::1])", "f8[::1](f8, f8[:], f8[::1])"], error_model="numpy"
    )
    def rates_of_mode(t, y, p):
        out = np.empty(STATE_SIZE)
        rates(t, y, p, mode, out)
        return out

    return rates_of_mode


def event_in(mode: int, which: int):
    """``g(t, y, p) -> float``, the event function ``which`` of ``mode``, compiled."""

    @numba.njit(["f8(f8, f8[::1], f8[::1])", "f8(f8, f8[:], f8[::1])"], error_model="numpy")
    def event_of_mode(t, y, p):
        out = np.empty(EVENT_COUNT)
        event_functions(t, y, p, mode, out)
        return out[which]

    return event_of_mode


assert DEVICE_SIZE == 18  # noqa: S101 - device_of names each of them
