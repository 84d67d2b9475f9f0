"""Runs of the independent solution in the slot, after alignment, until the part is inserted.

It shares no code with ``model`` but the class ``Parameters``. motion.py has the contacts in the
slot. A part is wedged if the line between its two contacts lies within the friction angle of both
normal forces.
"""

import cmath
import math
from dataclasses import replace
from typing import Any

import numpy as np

from model.physics.parameters import Parameters
from verification.independent.crossings import ON_ZERO, Function
from verification.independent.motion import LEFT, RIGHT, Body, Device, Mode, State, body, highest
from verification.independent.solution import FLAT, SMALLEST_TOLERANCE, Run, Solution


def _stands_on(mode: Mode, edge: int) -> bool:
    return mode.edge == edge and (mode.face != "off" or mode.corner != "off")


class _Insertion(Run):
    """A run that is continued after alignment, in the slot."""

    def __init__(self, device: Device, tolerance: float, depth: float, start: str) -> None:
        super().__init__(device, tolerance, start)
        self.insertion_depth = depth

    def functions(self, mode: Mode) -> dict[str, Function]:
        """Return the event functions of the mode by name, positive while it holds."""
        found = super().functions(mode)
        if not mode.dropped:
            return found
        d = self.device
        for name in ("aligned", "right lands", "left lands", "right wall", "left wall"):
            found.pop(name, None)
        if mode.right_side != "off":
            del found["right enters"]

        def add(name: str, function: Any) -> None:
            found[name] = lambda _time, z: function(z, body(z))

        def inserted(_z: State, at: Body) -> Any:
            return self.insertion_depth + highest(*(d.corner(s, at).imag for s in (RIGHT, LEFT)))

        add("inserted", inserted)
        if mode.right_side != "off":
            add("right_side end", lambda _z, at: np.minimum(*d.depths(RIGHT, at)[::3]))
        for wall, side in (("right_wall", RIGHT), ("left_wall", LEFT)):
            if getattr(mode, wall) != "off":
                add(f"{wall} end", lambda _z, at, side=side: -d.corner(side, at).imag)
            elif not _stands_on(mode, side):
                add(f"{wall} touches", lambda _z, at, side=side: self._off_wall(side, at))
        free = {
            RIGHT: not (mode.edge == RIGHT and mode.corner != "off")
            and mode.right_side == mode.right_wall == "off",
            LEFT: not (mode.edge == LEFT and mode.corner != "off") and mode.side == "off",
        }
        for side, name in ((RIGHT, "right"), (LEFT, "left")):
            if free[side]:

                def lands(z: State, at: Body, side: int = side) -> Any:
                    corner = d.corner(side, at)
                    place = complex(side * d.a, -d.b) * at.along
                    rising = (at.velocity + 1j * at.turn * place).imag
                    nearer = d.l - side * corner.real - corner.imag
                    return highest(nearer, corner.imag, side * z[2] + FLAT, rising)

                add(f"{name} lands", lands)
        return found

    def after(self, name: str, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode that follows an event, or the name of the end."""
        if name == "inserted":
            return name
        if name == "right enters" and not mode.dropped and self._side_meets(z, mode):
            return "aligned"
        found = self._in_slot(name, time, z, mode) if mode.dropped else None
        found = found or super().after(name, time, z, mode)
        return found if isinstance(found, str) else self.pressed(time, z, found)

    def pressed(self, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode with contacts for corners that are behind a wall already.

        When A1 passes B1 under load, the tilted part has B1 behind the wall.
        """
        for wall, side in (("right_wall", RIGHT), ("left_wall", LEFT)):
            free = getattr(mode, wall) == "off" and not _stands_on(mode, side)
            if mode.dropped and free and self._off_wall(side, body(z)) < -ON_ZERO:
                met = self._touches(wall, time, z, mode)
                return met if isinstance(met, str) else self.pressed(time, z, met)
        return mode

    def _off_wall(self, side: int, at: Body) -> Any:
        """Return a level < 0 for a corner that is behind its wall, and farther below the plane."""
        corner = self.device.corner(side, at)
        behind = side * corner.real - self.device.l
        return highest(-behind, behind + corner.imag)

    def _touches(self, wall: str, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode after a corner has touched its wall."""
        touch = self.device.touch(wall, mode, body(z))
        pulls = touch.load <= 0.0 and self.device.p.contact_damping > 0.0
        changes: dict[str, Any] = {wall: "released" if pulls else "on"}
        if wall == "right_wall":
            if _stands_on(mode, LEFT):
                return "both sides"
            changes |= {"edge": RIGHT, "face": "off", "corner": "off"}
        return self._next(time, z, mode, replace(mode, **changes))

    def _in_slot(self, name: str, time: float, z: State, mode: Mode) -> Mode | str | None:
        """Return the mode or ending after an event that only the slot has; None for others."""
        what, _, event = name.partition(" ")
        at = body(z)
        if event == "touches":
            return self._touches(what, time, z, mode)
        if event in ("enters", "lands"):
            return self._meets(event, RIGHT if what == "right" else LEFT, time, z, mode)
        bottom, _, _, top = self.device.depths(RIGHT, at)
        if name == "right_side end" and top < bottom:
            return "other face"
        return None

    def _meets(self, event: str, side: int, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode after an edge enters the part, or after a corner lands on the plane."""
        depths = self.device.depths(side, body(z))
        against_right = mode.right_side != "off" or mode.right_wall != "off"
        if event == "enters" and depths[0] > min(depths[1:]):
            if side == LEFT or depths[2] > min(depths[1], depths[3]):
                return self._after_meeting(event, side, time, z, mode)
            if _stands_on(mode, LEFT):
                return "both sides"
            met = replace(mode, edge=RIGHT, face="off", corner="off", right_side="on")
            return self._next(time, z, mode, met)
        if side == LEFT and against_right:
            return "both sides"
        off_right = replace(mode, right_side="off", right_wall="off")
        return self._after_meeting(event, side, time, z, off_right)

    def continued(self, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode after the fall into the slot, or the ending."""
        fallen: Mode | str = replace(mode, dropped=True, face="off")
        if self._side_meets(z, mode):
            fallen = self._meets("enters", RIGHT, time, z, replace(mode, dropped=True))
        return fallen if isinstance(fallen, str) else self.pressed(time, z, fallen)

    def _side_meets(self, z: State, mode: Mode) -> bool:
        """Return whether the right side meets A1, with B1 in the slot and B2 over it."""
        at = body(z)
        bottom, left, right, top = self.device.depths(RIGHT, at)
        over = self.device.corner(LEFT, at)
        stands = mode.face != "off" or mode.corner != "off"
        return (
            not stands
            and right < min(bottom, left, top)
            and over.real >= -self.device.l
            and over.imag > 0.0
        )

    def end_at_horizon(self, z: State, mode: Mode) -> str:
        """Return the ending of a part that is neither inserted nor out of the slot."""
        if not mode.dropped:
            return "horizon"
        d, at = self.device, body(z)
        right, left = d.corner(RIGHT, at), d.corner(LEFT, at)
        is_out = max(right.imag, left.imag) > 0.0
        if is_out or _stands_on(mode, RIGHT) or _stands_on(mode, LEFT):
            return "climbed out"
        against_right = "on" in (mode.right_side, mode.right_wall)
        held = against_right and mode.beside and mode.slides == mode.side_slides == 0
        if not held:
            return "horizon"
        first = right if mode.right_wall == "on" else complex(d.l)
        second = left if mode.left_wall == "on" else complex(-d.l)
        groups, cone = d.rates(0.0, z, mode)[2], math.atan(d.p.friction)
        pushes = [sum(touch.load * touch.normal for touch in group[0]) for group in groups]
        across = second - first
        angles = cmath.phase(across / pushes[0]), cmath.phase(-across / pushes[1])
        return "wedged" if max(map(abs, angles)) <= cone else "lack of force"


def insert(
    parameters: Parameters, horizon: float, depth: float, tolerance: float = SMALLEST_TOLERANCE,
    start: str = "simultaneous",
) -> Solution:  # fmt: skip
    """Solve for one parameter set until both bottom corners are at a depth (dimensionless).

    The ending is "inserted"; "wedged" or "lack of force" if the part sticks at two points at the
    horizon; "climbed out"; "horizon"; or the event at which the part left the scene. ``tau`` is the
    alignment time, at which the horizon begins anew.

    Raises:
        ArithmeticError, ValueError: as ``solve``.
    """
    return _Insertion(Device(parameters), tolerance, depth, start).run(horizon)
