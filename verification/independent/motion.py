"""Second statement of the model, to verify the package: contacts, forces, friction.

It shares no code with ``model`` but the class ``Parameters``. Vectors of the plane are complex
numbers. A contact is a place with a tangent and a normal, and the moment of a force is r × F. All
quantities are dimensionless. The paper's printed readings are in printed.py.
"""

import cmath
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Parameters

State = NDArray[np.float64]
RIGHT, LEFT = 1, -1
CLEARS = 1e-3  # height over the base at which a descent begins, besides the swing
# The contacts of the two groups, as fields of ``Mode``, edges before corners.
SUPPORT, SIDE = ("face", "right_side", "corner", "right_wall"), ("side", "left_wall")


@dataclass(frozen=True)
class Mode:
    """States of the contacts, "on", "off" or "released", and signs of the slips (0: sticks).

    ``right_side`` is A1 on the right side face; ``right_wall`` and ``left_wall`` are B1 and B2 on
    the walls of the slot. Contacts of the right side replace the support; its slip is then theirs.
    """

    edge: int = RIGHT
    face: str = "on"
    corner: str = "off"
    offset: float = 0.0
    slip_at_corner: bool = False
    slides: int = 0
    side: str = "off"
    side_slides: int = 0
    dropped: bool = False
    right_side: str = "off"
    right_wall: str = "off"
    left_wall: str = "off"
    slip_at_wall: bool = False

    @property
    def supported(self) -> bool:
        """True if a contact of the support presses."""
        return "on" in (self.face, self.corner, self.right_side, self.right_wall)

    @property
    def beside(self) -> bool:
        """True if a contact of the left side presses."""
        return "on" in (self.side, self.left_wall)


class Body(NamedTuple):
    """Mass centre, direction e_t of the bottom face, velocity, and rate of the tilt.

    Complex numbers (``turn`` real), or arrays of them.
    """

    centre: Any
    along: Any
    velocity: Any
    turn: Any


class Touch(NamedTuple):
    """A contact; ``place`` is relative to the mass centre.

    ``drift`` is the part of the slip acceleration that depends on velocities only. ``couple`` and
    ``twist`` are moments of a unit load and of a unit friction force besides r × F. The contact
    slips along ``way``, or along its tangent.
    """

    place: Any
    tangent: Any
    normal: Any
    depth: Any
    load: Any
    slip: Any
    drift: Any
    couple: Any = 0.0
    twist: Any = 0.0
    way: Any = None


class Drive(NamedTuple):
    """Force along the axis by which the holder drives the part: press and vibration.

    The press grows from ``press`` at the rate ``speed``, up to ``most``.
    """

    press: float
    speed: float
    most: float
    size: float
    frequency: float
    phase: float

    @property
    def reaches(self) -> float:
        """Time at which the press is ``most``."""
        return (self.most - self.press) / self.speed if self.press < self.most else 0.0

    def force(self, time: Any) -> Any:
        """Return the force, downward."""
        press = np.minimum(self.press + self.speed * time, self.most)
        return press + self.size * np.sin(self.frequency * time + self.phase)

    def later(self, time: float) -> "Drive":
        """Return the drive as time counts from ``time`` on."""
        press = min(self.press + self.speed * time, self.most)
        return self._replace(press=press, phase=self.phase + self.frequency * time)


def dot(a: Any, b: Any) -> Any:
    """Return the scalar product of two vectors."""
    return (a * b.conjugate()).real


def body(z: State) -> Body:
    """Return the ``Body`` of a state, shape (6,), or of many, shape (6, n)."""
    if z.ndim == 1:
        x, y, tilt, x_rate, y_rate, turn = z.tolist()
        return Body(complex(x, y), cmath.exp(1j * tilt), complex(x_rate, y_rate), turn)
    return Body(z[0] + 1j * z[1], np.exp(1j * z[2]), z[3] + 1j * z[4], z[5])


def highest(*values: Any) -> Any:
    """Return the largest of the values, element by element."""
    return np.maximum.reduce(values)


def _group(touches: list[Touch], slides: int, reverse: bool) -> tuple[Any, ...]:
    """Return (contacts, shares of the friction, sign of the slip, load).

    The slip of the first contact decides; ``reverse`` makes the last one the first.
    """
    total = sum(touch.load for touch in touches)
    shares = [touch.load / total if len(touches) > 1 else 1.0 for touch in touches]
    if reverse:
        touches, shares = touches[::-1], shares[::-1]
    return touches, shares, slides, total


class Device:
    """The device and its equations of motion, for one parameter set."""

    printed: frozenset[str] = frozenset()  # names of the readings that are as printed

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.a, self.b, self.l = p.half_width, p.half_height, p.slot_half_width
        self.drive = Drive(p.press_force, 0.0, p.press_force, 1.0, p.frequency, p.phase)
        self.rest = complex(
            p.misalignment if p.rest_x is None else p.rest_x,
            p.half_height if p.rest_y is None else p.rest_y,
        )

    def height(self, tilt: float) -> float:
        """Return the height of the mass centre of a part at x(0) that touches the base."""
        x, sine, cosine = self.p.misalignment, np.sin(tilt), np.cos(tilt)
        if tilt < 0.0 and x + self.a * cosine + self.b * sine > self.l:  # on the corner B1
            return float(self.b * cosine - self.a * sine)
        return float((self.b - (self.l - x) * sine) / cosine)

    def edge_on_face(self, side: int, at: Body) -> Touch:
        """Return the contact of an edge with the bottom face."""
        place = side * self.l - at.centre
        return self._touch(at, place, at.along, 1j * at.along, self.b, fixed_to_base=True)

    def edge_on_side(self, side: int, at: Body) -> Touch:
        """Return the contact of an edge with the side face on its side."""
        place, normal = side * self.l - at.centre, -side * at.along
        return self._touch(at, place, 1j * at.along, normal, self.a, fixed_to_base=True)

    def corner_on_wall(self, side: int, at: Body) -> Touch:
        """Return the contact of a bottom corner with the slot's wall on its side."""
        place, normal = complex(side * self.a, -self.b) * at.along, complex(-side)
        reach = side * at.centre.real - self.l
        return self._touch(at, place, 1j, normal, reach, fixed_to_base=False)

    def corner_on_flat(self, side: int, at: Body, offset: float) -> Touch:
        """Return the contact of a bottom corner with the flat base, lowered by ``offset``."""
        place = complex(side * self.a, -self.b) * at.along
        depth = -at.centre.imag - offset
        return self._touch(at, place, 1.0 + 0.0j, 1.0j, depth, fixed_to_base=False)

    def touch(self, name: str, mode: Mode, at: Body) -> Touch:
        """Return the contact of that name, one of ``SUPPORT`` and ``SIDE``."""
        if name == "face":
            return self.edge_on_face(mode.edge, at)
        if name == "corner":
            return self.corner_on_flat(mode.edge, at, mode.offset)
        side = RIGHT if name.startswith("right") else LEFT
        of_side = self.corner_on_wall if name.endswith("wall") else self.edge_on_side
        return of_side(side, at)

    def _touch(
        self, at: Body, place: Any, tangent: Any, normal: Any, reach: Any, *, fixed_to_base: bool
    ) -> Touch:
        """Return a contact; an edge is ``fixed_to_base``, a corner to the part."""
        of_part = at.velocity + 1j * at.turn * place
        depth = reach + dot(place, normal) if fixed_to_base else reach - dot(place, normal)
        load = self.load(depth, -dot(of_part, normal), at)
        if fixed_to_base:
            drift = at.turn * (dot(of_part, 1j * tangent) - dot(1j * at.velocity, tangent))
        else:
            drift = -at.turn * at.turn * dot(place, tangent)
        return Touch(place, tangent, normal, depth, load, dot(of_part, tangent), drift)

    def load(self, depth: Any, closing: Any, at: Body) -> Any:  # noqa: ARG002 - printed.py uses it
        """Return the normal force of a contact."""
        return self.p.contact_stiffness * depth + self.p.contact_damping * closing

    def corner(self, side: int, at: Body) -> Any:
        """Return the place of a bottom corner."""
        return at.centre + complex(side * self.a, -self.b) * at.along

    def depths(self, side: int, at: Body) -> tuple[Any, Any, Any, Any]:
        """Return the depths of an edge behind the bottom, left, right and top face of the part."""
        place = (side * self.l - at.centre) * at.along.conjugate()
        return self.b + place.imag, self.a + place.real, self.a - place.real, self.b - place.imag

    def not_aligned(self, at: Body) -> Any:
        """Return a level that is negative when A1 is beyond B1, and B2 in the slot."""
        corner = self.corner(LEFT, at)
        return highest(self.depths(RIGHT, at)[2], -corner.real - self.l, corner.imag)

    def rates(self, time: Any, z: State, mode: Mode) -> tuple[Any, ...]:
        """Return (acceleration, angular acceleration, groups, frictions, slip accelerations).

        The two groups of contacts, support and side, are as from ``_group``.
        """
        p, at = self.p, body(z)
        support, side = (
            [self.touch(name, mode, at) for name in group if getattr(mode, name) == "on"]
            for group in (SUPPORT, SIDE)
        )
        groups = [
            _group(support, mode.slides, mode.slip_at_corner),
            _group(side, mode.side_slides, mode.slip_at_wall),
        ]

        spring = self.rest - at.centre
        force = (
            p.lateral_stiffness * spring.real
            - p.lateral_damping * at.velocity.real
            + 1j * (spring.imag - p.axial_damping * at.velocity.imag - self.drive.force(time))
        )
        moment = p.tilt_stiffness * (p.rest_tilt - z[2]) - p.tilt_damping * at.turn
        frictions: list[Any] = [0.0, 0.0]
        for i, (touches, weights, slides, load) in enumerate(groups):
            frictions[i] = -slides * p.friction * load
            for touch, weight in zip(touches, weights, strict=True):
                push = touch.load * touch.normal + frictions[i] * weight * touch.tangent
                force = force + push
                moment = moment + (touch.place.conjugate() * push).imag
                moment = moment + touch.load * touch.couple + frictions[i] * weight * touch.twist

        def slip_rate(i: int, force: Any, moment: Any) -> Any:
            first = groups[i][0][0]
            way = first.tangent if first.way is None else first.way
            return dot(force + 1j * first.place * moment / p.inertia, way)

        def unit(i: int) -> tuple[Any, Any]:
            touches, weights = groups[i][0], groups[i][1]
            pairs = list(zip(touches, weights, strict=True))
            return (
                sum(weight * touch.tangent for touch, weight in pairs),
                sum(weight * ((touch.place.conjugate() * touch.tangent).imag + touch.twist)
                    for touch, weight in pairs),
            )  # fmt: skip

        stuck = [i for i in (0, 1) if groups[i][0] and groups[i][2] == 0 and p.friction > 0.0]
        drives = {i: slip_rate(i, force, moment) + groups[i][0][0].drift
                  for i in (0, 1) if groups[i][0]}  # fmt: skip
        if len(stuck) == 1:
            (i,) = stuck
            extra = {i: -drives[i] / slip_rate(i, *unit(i))}
        elif stuck:
            g00, g01 = slip_rate(0, *unit(0)), slip_rate(0, *unit(1))
            g10, g11 = slip_rate(1, *unit(0)), slip_rate(1, *unit(1))
            det = g00 * g11 - g01 * g10
            extra = {
                0: (g01 * drives[1] - g11 * drives[0]) / det,
                1: (g10 * drives[0] - g00 * drives[1]) / det,
            }
        else:
            extra = {}
        for i, friction in extra.items():
            one_force, one_moment = unit(i)
            force = force + friction * one_force
            moment = moment + friction * one_moment
            frictions[i] = frictions[i] + friction
        drives = {i: slip_rate(i, force, moment) + groups[i][0][0].drift for i in drives}
        return force, moment / p.inertia, groups, frictions, drives

    def derivative(self, time: float, z: State, mode: Mode) -> State:
        """Return dz/dτ, shape (6,)."""
        force, turn, *_ = self.rates(time, z, mode)
        return np.array([z[3], z[4], z[5], force.real, force.imag, turn])


def descend(device: Device, vibrates: bool) -> tuple[float, float]:
    """Set the drive of a holder that comes down, and return height and speed of the part.

    In the frame of the holder the part hangs from spring and grounded damper; both drives of it,
    the steady motion and the vibration, are solved as complex amplitudes.
    """
    p, speed = device.p, device.p.approach_speed
    assert speed is not None  # noqa: S101 - the caller chooses the start
    response = 1.0 / complex(1.0 - p.frequency**2, p.axial_damping * p.frequency)
    size = float(vibrates)
    swing = size * response * cmath.exp(1j * p.phase)
    lag = p.axial_damping * speed
    hangs = device.rest.imag - p.press_force + lag  # as the ramp ends, the swing aside
    clears = device.height(p.rest_tilt) + size * abs(response) + CLEARS
    press = p.press_force - max(clears - hangs, 0.0)
    device.drive = Drive(press, speed, p.press_force, size, p.frequency, p.phase)
    height = device.rest.imag - press + lag - swing.imag
    return height, -speed - (1j * p.frequency * swing).imag
