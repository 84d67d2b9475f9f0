"""Positions of the part's corners and the slot's edges; dimensionless, angles in radians."""

import math
from math import sqrt
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from model.compile.kernels import inlined_kernel
from model.physics.parameters import Constants, Shape
from model.physics.trigonometry import sine_cosine, square_root

Length = TypeVar("Length", float, NDArray[np.float64])


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


class Crescent(NamedTuple):
    """Place of the tips of the crescent by which the face of a round part covers the base.

    ``offset`` p and ``reach`` R as in (T1); ``rim_x`` is X, ``behind`` the depth d_f behind the
    face.
    """

    offset: float
    rim_x: float
    reach: float
    behind: float


@inlined_kernel
def _gap(p):
    """Return g² = l² - a²."""
    return p.slot_half_width * p.slot_half_width - p.half_width * p.half_width


@inlined_kernel
def crescent(x, y, s, c, p):
    """Return the ``Crescent`` on the right, from position and sine and cosine of the tilt.

    The rims cross at (X, ±Z) of the hole's rim, X² + Z² = l², and at ξ = X c - p along the face
    (T1). For φ > 0 no other point of the hole's rim is as deep behind the face.
    """
    offset, height = x * c + y * s, y * c - x * s
    gap = _gap(p)
    reach = square_root(offset * offset + gap * (s * s))
    rim_x = (offset * offset + gap) / (reach + c * offset)
    return Crescent(offset, rim_x, reach, p.half_height - height - rim_x * s)


@inlined_kernel
def tips_depth(x, y, tilt, p):
    """Return Q/2a of (T9): it has the sign of the tips' depth d_f, wherever there are tips.

    A polynomial of sine, cosine and position, without the roots of ``crescent``; in flight, too.
    """
    s, c = sine_cosine(tilt)
    offset, behind = x * c + y * s, p.half_height - y * c + x * s
    square = behind * behind - offset * offset - _gap(p)
    return (2.0 * (c * (offset * behind)) + s * square) * (0.5 / p.half_width)


@inlined_kernel
def resting_height(p: Constants):
    """Return y at the start, where the bottom face touches A1, or the tips of a round part.

    From d = b - (X - x) sin φ - y cos φ = 0, with X = l at A1.
    """
    s, c = sine_cosine(p.initial_tilt)
    rim_x = p.slot_half_width
    if p.is_round:
        along = first_touch(p.initial_tilt, p)
        if along < p.half_width:
            rim_x = place_on_rim(along, p)
    return (p.half_height - (rim_x - p.misalignment) * s) / c


@inlined_kernel
def first_touch(tilt, p):
    """Return where along the face a part at x(0) first touches A1, or the tips of a round part.

    At tips X = x_m + ξ c and X² = g² + ξ², with the abscissa x_m of the face's middle: a quadratic
    equation for ξ. Half the width, where tips end, if there are none.
    """
    s, c = sine_cosine(tilt)
    if not p.is_round:
        return (p.slot_half_width - p.misalignment - p.half_height * s) / c
    middle, gap = p.misalignment + p.half_height * s, _gap(p)
    root = middle * middle - gap * (s * s)
    if middle <= 0.0 or root <= 0.0:
        return p.half_width
    return (gap - middle * middle) / (middle * c + sqrt(root))


@inlined_kernel
def place_on_rim(along, p):
    """Return X of the tips at ξ = ``along`` of the face: X² = g² + ξ²."""
    return sqrt(_gap(p) + along * along)


def press_lever(p: Constants) -> float:
    """Return the lever of the press about the contact at the start, X - x (T7)."""
    along = first_touch(p.initial_tilt, p)
    rim_x = place_on_rim(along, p) if p.is_round and along < p.half_width else p.slot_half_width
    return float(rim_x - p.misalignment)


def lever_if_flat(half_width: Length, hole: Length, misalignment: Length, shape: Shape) -> Length:
    """Return the lever of the press on a part that touches down flat (T7).

    Lengths in any one unit, numbers or arrays; ``hole`` is the half width, or radius, of the hole.
    """
    if shape == "square":
        return hole - misalignment
    return (hole**2 - half_width**2 - misalignment**2) / (2.0 * misalignment)


def farthest_tilted(p: Constants) -> float:
    """Return x(0) up to which the press tilts a part towards the hole.

    Of a round part (T8); one that is tilted away stands flat first, with its face where it was.
    """
    if not p.is_round:
        return float(p.slot_half_width)
    flat, tilt = sqrt(_gap(p)), p.initial_tilt
    if tilt < 0.0:
        return flat - p.half_height * math.sin(tilt)
    return math.hypot(flat, p.half_height * math.tan(tilt))


def lever_doubt(p: Constants) -> float:
    """Return by what share the lever of a round part grows if the rims themselves yield (T10)."""
    middle = p.misalignment + p.half_height * math.sin(p.initial_tilt)
    rest = _gap(p) - middle**2
    force = p.press_force + 1.0
    return 2.0 * p.half_width * force / (p.contact_stiffness * rest) if rest > 0.0 else math.inf
