"""Event functions.

An event function is positive while a mode holds; its event is its down-crossing of zero. It takes
the quantities of one source (``sources``) and is a constant plus multiples of them, or of the
absolute value of one: a form that the engine can bound and search. It does not branch on the
mode; where the form depends on the mode, the table states several cases.

A condition on several quantities at once is the largest of them, each negative where its own
condition is met. Such a function is not smooth and may be negative for an instant between two
samples. The index of the largest quantity is therefore sampled with it: where the index changes,
the event location searches every quantity.
"""

from math import pi

from model.compile.kernels import inlined_kernel
from model.events.sources import on_both_sides
from model.physics.notation import RIGHT_EDGE

NEVER = 1e300  # value of an event function that does not apply
ABSENT = -1e300  # in place of quantities, where a condition has fewer than four
ON_AN_EVENT = 1e-8  # an event function below this counts as zero
FLAT = 1e-8  # a part tilted by less is flat: it rests on its edge
LARGEST_TILT = 0.5 * pi - 1e-3  # just below 90 degrees, where the paper's arm q has its pole


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
