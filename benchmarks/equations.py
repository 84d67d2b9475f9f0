"""The peers' own statement of the physics, written once for numbers and for expressions.

``Equations(sin, cos)`` works on the operands of these two: floats in a numba kernel, or heyoka's
expressions. It shares no code with the package that it is compared to, and models the contacts of
the chosen problems: the edge A1 under the bottom face, and flight. Notation as in
``model.physics.notation``; everything dimensionless.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from model import Parameters


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
    """The constants of ``parameters``, in the order of ``Device``."""
    values = parameters.given() | {"slot_half_width": parameters.slot_half_width}
    values["rest_x"] = _or(values["rest_x"], parameters.misalignment)
    values["rest_y"] = _or(values["rest_y"], parameters.half_height)
    return tuple(float(values[name] or 0.0) for name in Device._fields)


def _or(value: float | None, default: float) -> float:
    return default if value is None else value


class Touch(NamedTuple):
    """The edge A1 in the frame of the part.

    Where it stands along the face (s) and along the axis (r·e_n), how deep and how fast it goes in,
    the slip, and the part of the slip's acceleration that no force makes.
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
    """``touch(y, p)``, ``accelerations(t, y, p, touch, load, friction)`` and what sticking takes.

    ``sticking_friction(t, y, p, touch)`` is the friction force that keeps the slip constant, and
    ``slip_acceleration(t, y, p, touch, load, friction)`` how the slip changes under a friction
    force. ``left_corner(y, p)`` is (X, Y) of the corner B2.
    """

    touch: Callable[..., Any]
    accelerations: Callable[..., Any]
    slip_acceleration: Callable[..., Any]
    sticking_friction: Callable[..., Any]
    left_corner: Callable[..., Any]


def equations(
    sin: Callable[[Any], Any],
    cos: Callable[[Any], Any],
    compiled: Callable[[Any], Any] = lambda function: function,
) -> Equations:
    """The equations on top of ``sin`` and ``cos``, each function passed through ``compiled``."""

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

    return Equations(touch, accelerations, slip_acceleration, sticking_friction, left_corner)
