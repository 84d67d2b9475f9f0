"""The independent solution of a round part in a round hole, until it aligns.

The bottom face rests on two tips, where its rim and that of the hole cross; by symmetry one of them
stands for both. Their penetration along the common normal of the rims is a function of the pose.
Its gradient, by complex steps, is the row of the normal force; the row of the slip is the tangent,
across the normal in the plane. Side and lowest point of the rim touch as those of a plane part.
"""

import cmath
import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from model.physics.parameters import Parameters
from verification.independent.crossings import ON_ZERO, Function
from verification.independent.motion import (
    LEFT,
    RIGHT,
    Body,
    Device,
    Mode,
    State,
    Touch,
    body,
    dot,
    highest,
)
from verification.independent.solution import SMALLEST_TOLERANCE, Run, Solution

_STEP = 1e-40  # along the imaginary axis, for derivatives without cancellation


class _Tips:
    """Tips over A1 at a pose: centre (x, y), cosine and sine of the tilt; arrays, or complex."""

    def __init__(self, d: Device, x: Any, y: Any, c: Any, s: Any) -> None:
        self.x, self.y, self.c, self.s = x, y, c, s
        self.middle = x * c + y * s  # of the face, from the axis of the hole, along the face
        square = self.middle**2 + d.l**2 - d.a**2
        root = np.sqrt((c * self.middle) ** 2 + square * s * s)
        below = c * self.middle + root  # 0 on the far side of a flat part, which has no tips there
        self.across = square / np.where(below == 0.0, _STEP, below)  # abscissa X of the tips
        self.along = self.across * c - self.middle
        self.behind = d.b - (self.across - x) * s - y * c
        # The rims' common normal is along (-X s, p, Z s), with X² + Z² = l².
        self.depth = self.behind * root / np.sqrt(self.middle**2 + (d.l * s) ** 2)

    @property
    def tangent(self) -> Any:
        """Return the tangent in the plane, the place relative to the centre, as a row."""
        x, y = self.middle, self.across * self.s
        size = np.sqrt(x * x + y * y)
        x, y = x / size, y / size
        return x, y, (self.across - self.x) * y + self.y * x


class RoundDevice(Device):
    """A round part: half-widths are radii."""

    def tips(self, side: int, at: Body, moved: tuple[Any, Any, Any] | None = None) -> _Tips:
        """Return the tips on a side; of a part that is moved by a complex step. Left: mirrored."""
        x, y, c, s = at.centre.real, at.centre.imag, at.along.real, at.along.imag
        if moved is not None:
            step = 1j * _STEP
            c, s = c - step * moved[2] * s, s + step * moved[2] * c
            x, y = x + step * moved[0], y + step * moved[1]
        return _Tips(self, side * x, y, c, side * s)

    def edge_on_face(self, side: int, at: Body) -> Touch:
        """Return the contact of the bottom face with the tips on a side."""
        tips = self.tips(side, at)
        normal = [
            -self.tips(side, at, unit).depth.imag / _STEP
            for unit in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        ]
        velocity = at.velocity.real, at.velocity.imag, at.turn
        tangent, moved = tips.tangent, self.tips(side, at, velocity).tangent
        row = tangent[0], side * tangent[1], tangent[2]
        rates = moved[0].imag, side * moved[1].imag, moved[2].imag
        closing = -sum(n * v for n, v in zip(normal, velocity, strict=True))
        push = normal[0] + 1j * normal[1]
        place = side * tips.across - at.centre.real - 1j * at.centre.imag
        return Touch(
            place=place,
            tangent=row[0] + 1j * row[1],
            normal=push,
            depth=tips.depth,
            load=self.load(tips.depth, closing, at),
            slip=sum(t * v for t, v in zip(row, velocity, strict=True)),
            drift=sum(t * v for t, v in zip(rates, velocity, strict=True)) / _STEP,
            couple=normal[2] - dot(1j * place, push),
        )

    def beside(self, side: int, at: Body) -> Any:
        """Return a function that is negative while the edge on a side is inside the part's side."""
        bottom, left, right, top = self.depths(side, at)
        here = left if side == LEFT else right
        return highest(-here, here - bottom, -top)

    def height(self, tilt: float) -> float:
        """Return the height of the mass centre of a part at x(0) that touches the base."""
        if tilt <= 0.0:
            return super().height(tilt)
        along, y, reached = cmath.exp(1j * tilt), self.b, math.inf
        while abs(y - reached) > 1e-14 * self.b:  # a contraction, for small tilts
            across = self.tips(RIGHT, Body(complex(self.p.misalignment, y), along, 0j, 0.0)).across
            reached, y = y, (self.b - (across - self.p.misalignment) * along.imag) / along.real
        return float(y)


class RoundRun(Run):
    """A run of a round part."""

    device: RoundDevice

    def functions(self, mode: Mode) -> dict[str, Function]:
        """Return the event functions of the mode by name, positive while it holds."""
        of_plane, d = super().functions(mode), self.device
        found: dict[str, Function] = {}

        def add(name: str, function: Any) -> None:
            found[name] = lambda _time, z: function(body(z))

        for side, name in ((RIGHT, "right"), (LEFT, "left")):
            if f"{name} enters" not in of_plane:
                continue
            del of_plane[f"{name} enters"]

            def meets(at: Body, side: int = side) -> Any:
                tips = d.tips(side, at)
                return highest(
                    -tips.behind, tips.along - d.a + np.maximum(tips.behind, 0.0),
                    -tips.along - d.a, -tips.middle,
                )  # fmt: skip

            add(f"{name} tips", meets)
            if side == LEFT or not (mode.edge == RIGHT and mode.corner != "off"):
                add(f"{name} enters", partial(d.beside, side))
        if mode.face != "off":
            add("face end", lambda at: d.a - d.tips(mode.edge, at).along)
            add("face far", lambda at: d.a + d.tips(mode.edge, at).along)
        return {**found, **{n: each for n, each in of_plane.items() if n not in found}}

    def after(self, name: str, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode that follows an event, or the ending."""
        what, _, event = name.partition(" ")
        side = RIGHT if what == "right" else LEFT
        if event == "tips":
            if mode.edge != side and (mode.face != "off" or mode.corner != "off"):
                return "both sides"
            return self._next(time, z, mode, replace(mode, edge=side, face="on"))
        if name == "left enters":
            return self._next(time, z, mode, replace(mode, side="on"))
        # A corner pressed into the flat may pass the edge while the edge is inside the side.
        passed = name == "corner end" and mode.edge == RIGHT and mode.face == "off"
        if name == "right enters" or (passed and self.device.beside(RIGHT, body(z)) < -ON_ZERO):
            return "other face"
        return super().after(name, time, z, mode)


def solve_round(
    parameters: Parameters, horizon: float, tolerance: float = SMALLEST_TOLERANCE,
    start: str = "simultaneous",
) -> Solution:  # fmt: skip
    """Solve the alignment scene of a round part; as ``solve``."""
    return RoundRun(RoundDevice(parameters), tolerance, start).run(horizon)
