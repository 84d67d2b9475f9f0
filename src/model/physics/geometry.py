"""Positions of the part's corners and the slot's edges; dimensionless, angles in radians."""

from typing import NamedTuple

from model.compile.kernels import inlined_kernel
from model.physics.parameters import Constants
from model.physics.trigonometry import sine_cosine


class EdgePlace(NamedTuple):
    """Position of an edge A of the slot in the frame of the part, and that frame's direction.

    With r = A - C: ``along_face`` = s = r·e_t, ``along_axis`` = r·e_n, and ``cos``, ``sin`` of φ.
    """

    along_face: float
    along_axis: float
    cos: float
    sin: float


@inlined_kernel
def edge_place(side, x, y, tilt, p):
    """Return the ``EdgePlace`` of edge A1 (``side`` = +1) or A2 (-1) for the mass centre (x, y)."""
    s, c = sine_cosine(tilt)
    r_x = side * p.slot_half_width - x
    return EdgePlace(r_x * c - y * s, -r_x * s - y * c, c, s)


@inlined_kernel
def bottom_corner(side, x, y, tilt, p):
    """Return (X, Y) of the bottom corner B1 (``side`` = +1) or B2 (-1): C ± a e_t - b e_n."""
    s, c = sine_cosine(tilt)
    a, b = side * p.half_width, p.half_height
    return x + a * c + b * s, y + a * s - b * c


@inlined_kernel
def face_coordinate(side, x, tilt, p):
    """Return the paper's q of A1 or A2: its coordinate along the face if it lies exactly on it.

    q = (±l - x)/cos φ - b tan φ, from the paper's list of dimensionless parameters; A2 has -l.
    """
    s, c = sine_cosine(tilt)
    return (side * p.slot_half_width - x - p.half_height * s) / c


@inlined_kernel
def resting_height(p: Constants):
    """Return y at the start, where the bottom face touches A1: b - (l - x) sin φ - y cos φ = 0."""
    r_x = p.slot_half_width - p.misalignment
    s, c = sine_cosine(p.initial_tilt)
    return (p.half_height - r_x * s) / c
