"""Event functions, and the quantities of which they are functions.

An event function is positive while a mode holds; its event is its down-crossing of zero. It takes
the quantities of one source (positions of edges and corners, or depth, load and place of one
contact) and is a constant plus multiples of them, or of the absolute value of one: a form that the
batch engine can bound and search. It does not branch on the mode; where the form depends on the
mode, the table states several cases.

A condition on several quantities at once is the largest of them, each negative where its own
condition is met. Such a function is not smooth and may be negative for an instant between two
samples. The index of the largest quantity is therefore sampled with it: where the index changes,
the event location searches every quantity.
"""

from collections.abc import Callable
from math import pi
from typing import Any, NamedTuple

from model.compile.kernels import inlined_kernel
from model.physics.contacts import (
    contact_load,
    corner_on_flat,
    corner_on_wall,
    edge_on_side,
    support_on_face,
)
from model.physics.geometry import bottom_corner, edge_place, tips_depth
from model.physics.modes import OPEN
from model.physics.motion import is_beside, is_supported, motion, never_sticks
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

NEVER = 1e300  # value of an event function that does not apply
ABSENT = -1e300  # in place of quantities, where a condition has fewer than four
ON_AN_EVENT = 1e-8  # an event function below this counts as zero
FLAT = 1e-8  # a part tilted by less is flat: it rests on its edge
LARGEST_TILT = 0.5 * pi - 1e-3  # just below 90 degrees, where the paper's arm q has its pole


def on_both_sides(function: Callable[..., Any]) -> tuple[Any, Any]:
    """Make the kernels that call ``function`` with RIGHT_EDGE and with LEFT_EDGE in front."""

    def on(edge: float) -> Any:
        @inlined_kernel
        def of_edge(*arguments):
            return function(edge, *arguments)

        return of_edge

    return on(RIGHT_EDGE), on(LEFT_EDGE)


@inlined_kernel
def largest(quantities):
    """Return (largest of four, its index)."""
    a, b, c, d = quantities
    value, place = a, 0.0
    if b > value:
        value, place = b, 1.0
    if c > value:
        value, place = c, 2.0
    if d > value:
        value, place = d, 3.0
    return value, place


# -------------------------------------------------------------------------------------- quantities


class CornerPositions(NamedTuple):
    """Positions of the edges in the frame of the part, and of the bottom corners in the base's.

    ``along_face`` and ``along_axis`` as in ``EdgePlace``, the depth of A2 behind the left side in
    the selected variant, (X, Y) of the corners, the tilt, and dY/dτ of the corners. ``tips_depth``
    is that of a round part's tips over A1, and its negative that of the tips over A2.
    """

    right_along_face: float
    right_along_axis: float
    left_along_face: float
    left_along_axis: float
    left_behind_side: float
    right_corner_x: float
    right_corner_y: float
    left_corner_x: float
    left_corner_y: float
    tilt: float
    right_corner_rise: float
    left_corner_rise: float
    tips_depth: float


class ContactState(NamedTuple):
    """One contact: its depth, its load, and its place along the touched face or the base."""

    depth: float
    load: float
    along: float


@inlined_kernel
def corner_positions(q, p):
    """The ``CornerPositions`` for the state ``q``."""
    right = edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    left = edge_place(LEFT_EDGE, q.x, q.y, q.tilt, p)
    behind_side = left.along_face + p.half_width
    if p.printed_side_gap != 0.0:
        behind_side = edge_on_side(LEFT_EDGE, q, p).depth
    right_x, right_y = bottom_corner(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    left_x, left_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    return CornerPositions(
        right.along_face, right.along_axis, left.along_face, left.along_axis, behind_side,
        right_x, right_y, left_x, left_y, q.tilt,
        q.y_rate + q.tilt_rate * (right_x - q.x), q.y_rate + q.tilt_rate * (left_x - q.x),
        tips_depth(q.x, q.y, q.tilt, p) if p.is_round else 0.0,
    )  # fmt: skip


@inlined_kernel
def places(_time, q, p, _mode):
    """The ``CornerPositions``, as a source of event functions."""
    return corner_positions(q, p)


@inlined_kernel
def face_state(_time, q, p, mode):
    """``ContactState`` of the supporting edge, or of a round part's tips, on the bottom face.

    Tips end where the edge on their side does: ``along`` is the edge's.
    """
    face = support_on_face(mode.edge, q, p)
    load = contact_load(face.depth, face.closing_rate, q, p)
    if p.is_round:
        edge = edge_place(mode.edge, q.x, q.y, q.tilt, p)
        return ContactState(mode.edge * tips_depth(q.x, q.y, q.tilt, p), load, edge.along_face)
    return ContactState(face.depth, load, face.along)


@inlined_kernel
def _side_state(edge, _time, q, p, _mode):
    side = edge_on_side(edge, q, p)
    load = contact_load(side.depth, side.closing_rate, q, p)
    return ContactState(side.depth, load, edge_place(edge, q.x, q.y, q.tilt, p).along_axis)


# ``ContactState`` of A1 on the right side face, of A2 on the left one.
right_side_state, side_state = on_both_sides(_side_state)


@inlined_kernel
def corner_state(_time, q, p, mode):
    """``ContactState`` of the corner on the supporting side on the flat base."""
    corner = corner_on_flat(mode.edge, q, p)
    depth = corner.depth - mode.corner_offset
    load = contact_load(depth, corner.closing_rate, q, p)
    return ContactState(depth, load, -corner.along)


@inlined_kernel
def _wall_state(side, _time, q, p, _mode):
    corner = corner_on_wall(side, q, p)
    load = contact_load(corner.depth, corner.closing_rate, q, p)
    return ContactState(corner.depth, load, side * corner.along)


# ``ContactState`` of B1 on the right wall, of B2 on the left one.
right_wall_state, left_wall_state = on_both_sides(_wall_state)


# ------------------------------------------------------------- modes in which the quantities exist


@inlined_kernel
def always(_p, _mode):
    """Return True: positions exist in every mode."""
    return True


@inlined_kernel
def on_face(_p, mode):
    """Return whether the bottom face and an edge overlap."""
    return mode.face != OPEN and not mode.in_slot


@inlined_kernel
def on_left_side(_p, mode):
    """Return whether the left side face and A2 overlap."""
    return mode.side != OPEN


@inlined_kernel
def on_corner(_p, mode):
    """Return whether a bottom corner and the flat base overlap."""
    return mode.corner != OPEN and not mode.in_slot


@inlined_kernel
def rubs(p, mode):
    """Return whether a contact presses, and friction states may change."""
    return not never_sticks(p) and (is_supported(mode) or is_beside(mode))


@inlined_kernel
def forces(time, q, p, mode):
    """The ``Motion``, for slips, loads and friction forces."""
    return motion(time, q, p, mode)


# ---------------------------------------------------------------------------------- event functions


@inlined_kernel
def not_fallen_in(at, p, _mode):
    """Negative once s >= a, X_B2 >= -l and Y_B2 < 0: A1 past B1, B2 in the slot (R8)."""
    past = p.half_width - at.right_along_face
    return past, -at.left_corner_x - p.slot_half_width, at.left_corner_y, ABSENT


@inlined_kernel
def corners_outside(at, p, _mode):
    """Negative once X_B1 <= l, X_B2 >= -l, Y_B1 < 0 and Y_B2 < 0 (paper, sect. 2)."""
    right, left = at.right_corner_x - p.slot_half_width, -at.left_corner_x - p.slot_half_width
    return right, left, at.right_corner_y, at.left_corner_y


@inlined_kernel
def not_inserted(at, p, _mode):
    """Negative once both bottom corners are deeper than the insertion depth."""
    depth = p.insertion_depth
    return at.right_corner_y + depth, at.left_corner_y + depth, ABSENT, ABSENT


@inlined_kernel
def _corner(side, at):
    """(X counted outward, Y, dY/dτ) of the bottom corner on a side."""
    if side == RIGHT_EDGE:
        return at.right_corner_x, at.right_corner_y, at.right_corner_rise
    return -at.left_corner_x, at.left_corner_y, at.left_corner_rise


@inlined_kernel
def corner_in_slot(side, at, p, _mode):
    """Negative once a corner has come behind its wall, less far than it is below the plane."""
    x, y, _ = _corner(side, at)
    beside = x - p.slot_half_width
    return -beside, beside + y, ABSENT, ABSENT


@inlined_kernel
def corner_above(side, at, p, _mode):
    """Negative once a corner presses on the flat base beside the slot.

    It is then below the plane, the lower corner, and moving down. Otherwise the edge carries the
    bottom face.
    """
    x, y, rise = _corner(side, at)
    return p.slot_half_width - x, y, side * at.tilt + FLAT, rise


@inlined_kernel
def corner_over_flat(side, at, p, mode):
    """``corner_above``, but only where the corner is less far below the plane than in the wall."""
    beside, below, tilt, rise = corner_above(side, at, p, mode)
    return beside - below, below, tilt, rise


@inlined_kernel
def corner_off_wall(side, at, p, _mode):
    """Negative once a corner, not being the lower one, has run into the slot's wall from inside.

    Also negative once the whole part has come down beside the slot; in any other pose the part
    meets the edge before this corner.
    """
    x, y, _ = _corner(side, at)
    return p.slot_half_width - x, y, -side * at.tilt - FLAT, ABSENT


@inlined_kernel
def edge_inside(edge, at, p):
    """Depths of an edge in the part: (through bottom, left, right, top), all positive inside.

    For the left edge, the depth behind the left side is that of the selected variant.
    """
    if edge == RIGHT_EDGE:
        face, axis = at.right_along_face, at.right_along_axis
        return p.half_height + axis, face + p.half_width, p.half_width - face, p.half_height - axis
    face, axis = at.left_along_face, at.left_along_axis
    return p.half_height + axis, at.left_behind_side, p.half_width - face, p.half_height - axis


@inlined_kernel
def edge_outside(edge, at, p, _mode):
    """Negative once an edge has entered the part."""
    bottom, left, right, top = edge_inside(edge, at, p)
    return -bottom, -left, -right, -top


@inlined_kernel
def edge_off_side(edge, at, p, _mode):
    """Negative once an edge has entered the part, less far through its side than its bottom."""
    bottom, left, right, top = edge_inside(edge, at, p)
    beside = right if edge == RIGHT_EDGE else left
    return -beside, beside - bottom, -top, ABSENT


@inlined_kernel
def tips_outside(edge, at, p, _mode):
    """Negative once the tips over an edge have met the bottom face of a round part (T9).

    They are behind it, less far than the edge behind the side, not past the other end of the face,
    and the face's middle is on their side of the hole.
    """
    depth, middle = edge * at.tips_depth, 0.5 * edge * (at.right_corner_x + at.left_corner_x)
    along = at.right_along_face if edge == RIGHT_EDGE else -at.left_along_face
    return -depth, depth + along - p.half_width, -along - p.half_width, -middle


right_corner_in_slot, left_corner_in_slot = on_both_sides(corner_in_slot)
right_corner_above, left_corner_above = on_both_sides(corner_above)
right_corner_over_flat, left_corner_over_flat = on_both_sides(corner_over_flat)
right_corner_off_wall, left_corner_off_wall = on_both_sides(corner_off_wall)
right_edge_outside, left_edge_outside = on_both_sides(edge_outside)
right_edge_off_side, left_edge_off_side = on_both_sides(edge_off_side)
right_tips_outside, left_tips_outside = on_both_sides(tips_outside)


@inlined_kernel
def load(at, _p, _mode):
    """Negative where the base would have to pull."""
    return at.load


@inlined_kernel
def missing_load(at, _p, _mode):
    """Negative once the base presses again."""
    return -at.load


@inlined_kernel
def depth(at, _p, _mode):
    """Negative once a gap has opened."""
    return at.depth


@inlined_kernel
def before_face_end(at, p, mode):
    """Negative once the edge has passed the corner on its own side: A1 B1, or A2 B2."""
    return p.half_width - mode.edge * at.along


@inlined_kernel
def before_far_end(at, p, mode):
    """Negative once the edge has passed the corner on the other side: A1 B2, or A2 B1."""
    return p.half_width + mode.edge * at.along


@inlined_kernel
def before_side_end(at, p, _mode):
    """Negative once the edge has passed an end of the side face."""
    return p.half_height - abs(at.along)


@inlined_kernel
def beside_slot(at, p, mode):
    """Negative once the corner has slid into the slot."""
    return mode.edge * at.along - p.slot_half_width


@inlined_kernel
def below_plane(at, _p, _mode):
    """Negative once a corner on a wall has risen above the plane."""
    return -at.along


@inlined_kernel
def support_slip(at, _p, mode):
    """Slip of the support in the direction of sliding."""
    return mode.support_slip * at.support_slip


@inlined_kernel
def support_reserve(at, p, _mode):
    """Friction force that a sticking support has left up to its limit, μ n - |T|."""
    return p.friction * at.support_load - abs(at.support_friction)


@inlined_kernel
def side_slip(at, _p, mode):
    """Slip on the left side in the direction of sliding."""
    return mode.side_slip * at.side_slip


@inlined_kernel
def side_reserve(at, p, _mode):
    """Friction force that a sticking left side has left up to its limit."""
    return p.friction * at.side_load - abs(at.side_friction)


@inlined_kernel
def upright(at, _p, _mode):
    """Negative once the tilt is 90 degrees."""
    return LARGEST_TILT - abs(at.tilt)
