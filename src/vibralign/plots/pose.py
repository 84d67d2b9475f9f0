"""Pose of the part by the model's geometry, and the resting pose that Figs. 1 to 4 draw."""

from dataclasses import dataclass
from math import asin, atan2, hypot

import numpy as np
from numpy.typing import ArrayLike, NDArray

from model.physics import geometry
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Batch, Constants, Parameters
from model.physics.variants import Variants

Point = NDArray[np.float64]


def xy(x: float, y: float) -> Point:
    """Return a point or a vector."""
    return np.array([x, y], dtype=float)


def towards(angle: ArrayLike) -> Point:
    """Return the unit vectors at angles (radians) from X, along a last axis."""
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@dataclass(frozen=True)
class Pose:
    """A part in the frame of the slot: mass centre (x, y), ``tilt``, and the model's constants."""

    x: float
    y: float
    tilt: float
    constants: Constants

    @property
    def centre(self) -> Point:
        """The mass centre C."""
        return xy(self.x, self.y)

    @property
    def axes(self) -> Point:
        """The unit vectors e_t and e_n as rows."""
        return towards([self.tilt, self.tilt + np.pi / 2])

    def at(self, face: float, axis: float) -> Point:
        """Return the point C + face e_t + axis e_n."""
        return self.centre + [face, axis] @ self.axes

    def centimetre(self, height: float) -> float:
        """Return the length of a centimetre for a part ``height`` cm high, 3.4 wide at most."""
        return max(2 * self.constants.half_height / height, 2 * self.constants.half_width / 3.4)

    def corners(self) -> Point:
        """Return B1, D1, D2, B2 as rows; D1 and D2 by point symmetry about C."""
        place = self.x, self.y, self.tilt, self.constants
        right, left = (
            np.array(geometry.bottom_corner(side, *place)) for side in (RIGHT_EDGE, LEFT_EDGE)
        )
        return np.array([right, 2 * self.centre - left, 2 * self.centre - right, left])

    @property
    def top(self) -> float:
        """The height of the highest corner."""
        return float(self.corners()[:, 1].max())

    def edge(self, side: float) -> Point:
        """Return A1 or A2."""
        return xy(side * self.constants.slot_half_width, 0.0)

    def edge_place(self, side: float) -> geometry.EdgePlace:
        """Return where A1 or A2 is in the frame of the part."""
        place = geometry.edge_place(side, self.x, self.y, self.tilt, self.constants)
        return geometry.EdgePlace(*place)

    def with_edge_at(self, side: float, face: float, axis: float) -> "Pose":
        """Move the part until the edge A1 or A2 is at face e_t + axis e_n from C."""
        x, y = self.edge(side) - (self.at(face, axis) - self.centre)
        return Pose(float(x), float(y), self.tilt, self.constants)


def resting_pose(parameters: Parameters) -> Pose:
    """Return the start of the model at a tilt that can be seen: the bottom face touches A1, d = 0.

    Under an upright part A1 is at l - x along the face. With s a quarter of the way from there to
    the corner B2, φ solves b sin φ + s cos φ = l - x. For a short part the tilt is 0.2.
    """
    reach = parameters.slot_half_width - parameters.misalignment
    face, b = reach - 0.25 * (reach + parameters.half_width), parameters.half_height
    tilt = min(asin(min(reach / hypot(b, face), 1.0)) - atan2(face, b), 0.2)
    batch = Batch.stack([parameters.replace(initial_tilt=tilt)])
    constants = Constants(*(float(value) for value in batch.constants(Variants.consistent())[0]))
    return Pose(parameters.misalignment, geometry.resting_height(constants), tilt, constants)
