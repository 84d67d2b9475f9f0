"""The peers' own statement of the physics: equations of motion, event functions and modes.

It shares no code with the package but the class ``Parameters``. The functions of
``equations(sin, cos)`` take what ``sin`` and ``cos`` take: floats in a numba kernel, or heyoka's
expressions. The contacts are those of the chosen problems: the edge A1 under the bottom face, or
none. Notation as in ``model.physics.notation``; all quantities are dimensionless.

A mode is a smooth vector field. It ends when one of its event functions crosses zero downwards;
``next_mode`` gives the mode that follows. All modes have the same equations, and differ in the
coefficients ``Mode``.
"""

import importlib
import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from vibralign import Parameters

try:
    numba: Any = importlib.import_module("numba")
except ImportError:  # in the environment of the study
    numba = None

STATE_SIZE = 6
_MOMENT = 1e-5

# --- Parameters and modes -----------------------------------------------------------------------


class Device(NamedTuple):
    """Constants of a trajectory, in the order in which peers take them as an array."""

    half_width: Any
    half_height: Any
    slot_half_width: Any
    inertia: Any
    lateral_stiffness: Any
    tilt_stiffness: Any
    lateral_damping: Any
    axial_damping: Any
    tilt_damping: Any
    contact_stiffness: Any
    contact_damping: Any
    friction: Any
    press_force: Any
    frequency: Any
    phase: Any
    rest_x: Any
    rest_y: Any
    rest_tilt: Any


DEVICE_SIZE = len(Device._fields)


def device(parameters: Parameters) -> tuple[float, ...]:
    """Return the constants of a device, in the order of ``Device``."""
    values = parameters.given() | {"slot_half_width": parameters.slot_half_width}
    if parameters.rest_x is None:
        values["rest_x"] = parameters.misalignment
    if parameters.rest_y is None:
        values["rest_y"] = parameters.half_height
    return tuple(float(values[name] or 0.0) for name in Device._fields)


class Mode(NamedTuple):
    """Coefficients of the equations: of the forces, and of the event functions.

    An event function without coefficients equals its offset, 1, and never crosses zero.
    """

    load: Any = 0.0
    sliding_friction: Any = 0.0  # times the friction limit
    sticking_friction: Any = 0.0
    # LOAD: the load vanishes; released, it returns; open, the edge touches.
    load_by_load: Any = 0.0
    load_by_depth: Any = 0.0
    load_offset: Any = 0.0
    # FRICTION: the slip vanishes; sticking, its upper limit is reached; released, the gap opens.
    friction_by_slip: Any = 0.0
    friction_by_limit: Any = 0.0
    friction_by_depth: Any = 0.0
    friction_offset: Any = 0.0
    # OTHER_FRICTION: sticking, the lower limit of friction is reached.
    other_offset: Any = 1.0
    # FACE_END: A1 passes the corner B1; beyond it, it comes back.
    face_end: Any = 1.0


# In flight with A1 under the bottom face, or beyond B1; overlapping without load; pressing.
OPEN, BEYOND, RELEASED, SLIDE_POSITIVE, SLIDE_NEGATIVE, STICK, ALIGNED = range(7)
LOAD, FRICTION, OTHER_FRICTION, FACE_END = range(4)
EVENTS = {
    OPEN: (LOAD, FACE_END),
    BEYOND: (FACE_END,),
    RELEASED: (LOAD, FRICTION, FACE_END),
    SLIDE_POSITIVE: (LOAD, FRICTION, FACE_END),
    SLIDE_NEGATIVE: (LOAD, FRICTION, FACE_END),
    STICK: (LOAD, FRICTION, OTHER_FRICTION, FACE_END),
}
_BEYOND = Mode(load_offset=1.0, friction_offset=1.0, face_end=-1.0)
_PRESSING = Mode(load=1.0, load_by_load=1.0)
MODES = (
    Mode(load_by_depth=-1.0, friction_offset=1.0),
    _BEYOND,
    Mode(load_by_load=-1.0, friction_by_depth=1.0),
    _PRESSING._replace(sliding_friction=-1.0, friction_by_slip=1.0),
    _PRESSING._replace(sliding_friction=1.0, friction_by_slip=-1.0),
    _PRESSING._replace(sticking_friction=1.0, friction_by_limit=1.0, other_offset=0.0),
    _BEYOND,
)

# --- Equations ----------------------------------------------------------------------------------


class Touch(NamedTuple):
    """The contact at the edge A1, in the frame of the part.

    ``along_face`` is s and ``along_axis`` r·e_n; ``slip_drift`` is the part of the slip
    acceleration that depends on velocities only.
    """

    along_face: Any
    along_axis: Any
    depth: Any
    load: Any
    slip: Any
    slip_drift: Any
    cos: Any
    sin: Any


class Equations(NamedTuple):
    """Functions of time ``t``, state ``y`` (6,), ``Device`` ``p`` and ``Mode`` ``m``.

    ``sticking_friction(t, y, p, touch)`` is the friction force that keeps the slip constant, and
    ``slip_acceleration(t, y, p, touch, load, friction)`` the slip acceleration under a load and a
    friction force. ``left_corner(y, p)`` is (X, Y) of the corner B2.
    """

    touch: Callable[..., Any]
    slip_acceleration: Callable[..., Any]
    sticking_friction: Callable[..., Any]
    left_corner: Callable[..., Any]
    rates: Callable[..., Any]
    event_functions: Callable[..., Any]


def equations(
    sin: Callable[[Any], Any],
    cos: Callable[[Any], Any],
    compiled: Callable[[Any], Any] = lambda function: function,
) -> Equations:
    """Return the equations with these ``sin`` and ``cos``; ``compiled`` decorates each function."""

    @compiled
    def touch(y, p):
        c, s = cos(y[2]), sin(y[2])
        r_x = p.slot_half_width - y[0]
        along_face = r_x * c - y[1] * s
        along_axis = -r_x * s - y[1] * c
        across = y[4] * c - y[3] * s
        closing = -(across + y[5] * along_face)
        depth = p.half_height + along_axis
        load = p.contact_stiffness * depth + p.contact_damping * closing
        slip = y[3] * c + y[4] * s - y[5] * along_axis
        drift = y[5] * (across - closing)
        return Touch(along_face, along_axis, depth, load, slip, drift, c, s)

    @compiled
    def accelerations(t, y, p, at, load, friction):
        x = friction * at.cos - load * at.sin
        x = x - p.lateral_damping * y[3] - p.lateral_stiffness * (y[0] - p.rest_x)
        up = load * at.cos + friction * at.sin - p.axial_damping * y[4] - (y[1] - p.rest_y)
        up = up - p.press_force - sin(p.frequency * t + p.phase)
        moment = load * at.along_face - friction * at.along_axis
        moment = moment - p.tilt_damping * y[5] - p.tilt_stiffness * (y[2] - p.rest_tilt)
        return x, up, moment / p.inertia

    @compiled
    def slip_acceleration(t, y, p, at, load, friction):
        x, up, turn = accelerations(t, y, p, at, load, friction)
        return at.cos * x + at.sin * up - at.along_axis * turn + at.slip_drift

    @compiled
    def sticking_friction(t, y, p, at):
        drive = slip_acceleration(t, y, p, at, at.load, 0.0)
        return -drive / (1.0 + at.along_axis * at.along_axis / p.inertia)

    @compiled
    def left_corner(y, p):
        c, s = cos(y[2]), sin(y[2])
        return (
            y[0] - p.half_width * c + p.half_height * s,
            y[1] - p.half_width * s - p.half_height * c,
        )

    @compiled
    def rates(t, y, p, m):
        at = touch(y, p)
        friction = m.sliding_friction * p.friction * at.load
        friction = friction + m.sticking_friction * sticking_friction(t, y, p, at)
        x, up, turn = accelerations(t, y, p, at, m.load * at.load, friction)
        return y[3], y[4], y[5], x, up, turn

    @compiled
    def event_functions(t, y, p, m):
        at = touch(y, p)
        limit, needed = p.friction * at.load, sticking_friction(t, y, p, at)
        opening = m.friction_by_depth * at.depth + m.friction_offset
        return (
            m.load_by_load * at.load + m.load_by_depth * at.depth + m.load_offset,
            m.friction_by_slip * at.slip + m.friction_by_limit * (limit - needed) + opening,
            m.friction_by_limit * (limit + needed) + m.other_offset,
            m.face_end * (p.half_width - at.along_face),
        )

    return Equations(
        touch, slip_acceleration, sticking_friction, left_corner, rates, event_functions
    )


# --- For numbers --------------------------------------------------------------------------------


def _compiled(*signatures: Any, **options: Any) -> Any:
    """Return numba's decorator; without numba one that changes nothing, for the tests."""
    if numba is None:
        return lambda function: function
    return numba.njit(*signatures, error_model="numpy", **options)


jit = _compiled(nogil=True)
(
    _touch, _slip_acceleration, _sticking_friction, _left_corner, _rates, _event_functions,
) = equations(math.sin, math.cos, jit)  # fmt: skip
_OPEN = MODES[OPEN]


def start(parameters: Parameters) -> Any:
    """Return the state (6,) at τ = 0: at rest, the bottom face on A1 without load."""
    x, tilt = parameters.misalignment, parameters.initial_tilt
    r_x = parameters.slot_half_width - x
    y = (parameters.half_height - r_x * math.sin(tilt)) / math.cos(tilt)
    return np.array([x, y, tilt, 0.0, 0.0, 0.0])


@jit
def _device_of(p):
    """``Device`` from the array ``p`` of its values."""
    return Device(
        p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13],
        p[14], p[15], p[16], p[17],
    )  # fmt: skip


@cache
def rates_in(mode: int):
    """Return a compiled ``f(t, y, p) -> dy/dt`` for a mode."""
    coefficients = MODES[mode]

    @_compiled(["f8[::1](f8, f8[::1], f8[::1])", "f8[::1](f8, f8[:], f8[::1])"])
    def rates_of_mode(t, y, p):
        return np.array(_rates(t, y, _device_of(p), coefficients))

    return rates_of_mode


@cache
def event_in(mode: int, which: int):
    """Return a compiled ``g(t, y, p) -> float``, the event function ``which`` of a mode."""
    coefficients = MODES[mode]

    @_compiled(["f8(f8, f8[::1], f8[::1])", "f8(f8, f8[:], f8[::1])"])
    def event_of_mode(t, y, p):
        return _event_functions(t, y, _device_of(p), coefficients)[which]

    return event_of_mode


@jit
def _sliding(slip):
    return SLIDE_NEGATIVE if slip < 0.0 else SLIDE_POSITIVE


@jit
def first_mode(t, y, p):
    """Return the first mode, at rest without load: it slides as without friction, or flies."""
    q = _device_of(p)
    at = _touch(y, q)
    ahead = y + _MOMENT * np.array(_rates(t, y, q, _OPEN))
    if _touch(ahead, q).load <= 0.0:
        return OPEN
    return _sliding(_slip_acceleration(t, y, q, at, 0.0, 0.0))


@jit
def _aligned(y, q):
    """Return whether B2 is inside the slot, for a part with A1 beyond B1."""
    x, height = _left_corner(y, q)
    return x >= -q.slot_half_width and height < 0.0


@jit
def _stop_slip(y, q, at):
    """Remove from ``y`` the slip that the located event has left, by a friction impulse."""
    impulse = -at.slip / (1.0 + at.along_axis * at.along_axis / q.inertia)
    y[3] += impulse * at.cos
    y[4] += impulse * at.sin
    y[5] -= impulse * at.along_axis / q.inertia


@jit
def next_mode(t, y, p, mode, which):
    """Return the mode after the event ``which``; where a slip ends, set it to zero in ``y``."""
    q = _device_of(p)
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


assert DEVICE_SIZE == 18  # noqa: S101 - _device_of names each of them
