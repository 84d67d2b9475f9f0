"""The independent solution with readings of the equations as the paper prints them: R1 to R9.

R7 has no printed reading that runs.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from model.physics.parameters import Parameters
from verification.independent.crossings import Function
from verification.independent.motion import (
    LEFT,
    RIGHT,
    Body,
    Device,
    Mode,
    State,
    Touch,
    body,
    highest,
)
from verification.independent.solution import SMALLEST_TOLERANCE, Run, Solution

READINGS = (
    "normal_sign", "friction_law", "contact_damping_law", "side_gap", "side_force", "preload",
    "moment_arms",
)  # fmt: skip
"""R1 to R6 and R9, as ``Variants`` names them."""
CRITERION = "alignment_criterion"  # R8: all corner conditions, not only the fall into the slot


def _mirrored(direction: Any) -> Any:
    """Return a direction whose horizontal component has the other sign."""
    return -direction.conjugate()


def _moment(place: Any, force: Any) -> Any:
    return (place.conjugate() * force).imag


class PrintedDevice(Device):
    """The device with some readings as printed, ``READINGS``."""

    def __init__(self, p: Parameters, printed: Iterable[str]) -> None:
        super().__init__(p)
        self.printed = frozenset(printed)
        known = *READINGS, CRITERION
        if unknown := self.printed - {*known}:
            raise ValueError(f"printed = {sorted(unknown)}: must be of {', '.join(known)}")
        if "preload" in self.printed:  # R6: the axial spring is relaxed at y = 0
            self.rest = complex(self.rest.real)

    def load(self, depth: Any, closing: Any, at: Body) -> Any:
        """Return the normal force; of R3, the damping takes the speed of the mass centre."""
        if "contact_damping_law" in self.printed:
            closing = -abs(at.velocity)
        return super().load(depth, closing, at)

    def edge_on_face(self, side: int, at: Body) -> Touch:
        """Return the contact of an edge with the bottom face, with the arms and sign of U1."""
        touch = super().edge_on_face(side, at)
        return self._as_printed(touch, side, at, arms="moment_arms" in self.printed)

    def _as_printed(self, touch: Touch, side: int, at: Body, *, arms: bool) -> Touch:
        """Return a contact with the face with the printed sign of U1 (R1) and ``arms`` (R9)."""
        place, normal, tangent = touch.place, touch.normal, touch.tangent
        lever, friction_lever = _moment(place, normal), _moment(place, tangent)
        if arms:  # q and b, of a part that is not pressed in
            tangent_of_tilt = at.along.imag / at.along.real
            lever = (side * self.l - at.centre.real) / at.along.real - self.b * tangent_of_tilt
            friction_lever = self.b + 0.0 * lever
        if "normal_sign" in self.printed:
            normal, tangent = _mirrored(normal), _mirrored(tangent)
        return touch._replace(
            normal=normal, tangent=tangent, way=touch.tangent,
            couple=lever - _moment(place, normal), twist=friction_lever - _moment(place, tangent),
        )  # fmt: skip

    def edge_on_side(self, side: int, at: Body) -> Touch:
        """Return the contact of an edge with the side face; of A2, as of R4 and R5."""
        touch = super().edge_on_side(side, at)
        if side != LEFT:
            return touch
        if "side_gap" in self.printed:
            depth, closing = self._behind(at)
            touch = touch._replace(depth=depth, load=self.load(depth, closing, at))
        if "side_force" in self.printed:  # at A2 like at A1, with the arms q and b
            face = self._as_printed(super().edge_on_face(LEFT, at), LEFT, at, arms=True)
            touch = face._replace(depth=touch.depth, load=touch.load)
        return touch

    def _behind(self, at: Body) -> tuple[Any, Any]:
        """Return the depth -D2 cos φ of A2, which mixes x and y, and its rate."""
        corner = self.corner(LEFT, at)
        of_corner = at.velocity + 1j * at.turn * (corner - at.centre)
        gap, gap_rate = corner.real + self.l - corner.imag, of_corner.real - of_corner.imag
        return -gap * at.along.real, gap * at.along.imag * at.turn - gap_rate * at.along.real

    def depths(self, side: int, at: Body) -> tuple[Any, Any, Any, Any]:
        """Return the depths of an edge; that of A2 behind the left side as it is printed (R4)."""
        bottom, left, right, top = super().depths(side, at)
        if side == LEFT and "side_gap" in self.printed:
            left = self._behind(at)[0]
        return bottom, left, right, top


class _PrintedRun(Run):
    """A run that ends, of R8, once all four corner conditions hold after the fall."""

    def functions(self, mode: Mode) -> dict[str, Function]:
        """Return the event functions of the mode by name, positive while it holds."""
        found, d = super().functions(mode), self.device
        if mode.dropped and "aligned" in found:
            del found["aligned"], found["right wall"]

            def inside(_time: Any, z: State) -> Any:
                right, left = (d.corner(side, body(z)) for side in (RIGHT, LEFT))
                return highest(right.real - d.l, -left.real - d.l, right.imag, left.imag)

            found["inside"] = inside
        return found

    def after(self, name: str, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode that follows an event, or the ending."""
        found = "aligned" if name == "inside" else super().after(name, time, z, mode)
        if found == "aligned" and name != "inside" and CRITERION in self.device.printed:
            return replace(mode, dropped=True, face="off")
        return found


def solve_printed(
    parameters: Parameters,
    horizon: float,
    printed: Iterable[str],
    tolerance: float = SMALLEST_TOLERANCE,
) -> Solution:
    """Solve the alignment scene with some readings as ``printed``; as ``solve``.

    Raises:
        ValueError: a name that is none of ``READINGS`` and not ``CRITERION``.
    """
    return _PrintedRun(PrintedDevice(parameters, printed), tolerance).run(horizon)
