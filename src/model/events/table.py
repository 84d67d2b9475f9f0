"""Where a mode ends: one scalar function for each switch, positive while the mode holds.

A switch happens where its function falls through zero. Functions that do not apply in a mode are
``NEVER``. What follows a switch stands in transitions.py.

A condition that several quantities must meet at once is the largest of them, each negative where
its part is met. Such a function is not smooth, and may be negative for an instant only, between two
samples; which quantity is the largest is therefore sampled with it, so that locate.py can look
at each of them where that changes.
"""

from math import pi
from typing import NamedTuple

from model.physics.compiled import inlined_kernel, kernel
from model.physics.contacts import contact_load, corner_on_flat, edge_on_face, edge_on_side
from model.physics.geometry import bottom_corner, edge_place
from model.physics.motion import is_supported, motion, never_sticks
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.scenes import CLOSED, OPEN, RELEASED, STICKING

NEVER = 1e300
ON_A_SWITCH = 1e-8  # a switching function below this is on its switch
FLAT = 1e-8  # a part tilted by less is flat: it stands on its edge
LARGEST_TILT = 0.5 * pi - 1e-3  # just below 90 degrees, where the paper's arm q has its pole
NOTHING = -1e300  # a quantity that a condition does not have

# Index of each switching function.
(
    ALIGNED,  # in flight: A1 beyond B1, B2 inside the slot
    CORNERS_INSIDE,  # the paper's four corner conditions
    RIGHT_EDGE_ENTERS,  # A1 enters the part
    LEFT_EDGE_ENTERS,  # A2 enters the part
    RIGHT_CORNER_LANDS,  # B1 on the flat base
    LEFT_CORNER_LANDS,  # B2 on the flat base
    RIGHT_WALL,  # B1 against the slot's wall from inside
    LEFT_WALL,  # B2 against the slot's wall from inside
    FACE_LOAD,  # the edge under the bottom face carries no load any more
    FACE_GAP,  # the gap under the bottom face opens
    FACE_RELOAD,  # the load returns before the gap has opened
    FACE_END,  # the edge passes the face's end toward the slot
    FACE_FAR_END,  # the edge passes the face's other end
    SIDE_LOAD,
    SIDE_GAP,
    SIDE_RELOAD,
    SIDE_END,  # A2 passes an end of the side face
    CORNER_LOAD,
    CORNER_GAP,
    CORNER_RELOAD,
    CORNER_END,  # the corner slides into the slot
    SUPPORT_SLIP,  # slip reaches zero, or friction its limit, at the support
    SIDE_SLIP,  # the same at the side face
    OVERTURNED,  # tilt to 90 degrees
) = range(24)
SWITCH_COUNT = 24
COMBINED_COUNT = 8  # the first ones are the largest of several quantities; which one, stands behind
SAMPLE_SIZE = SWITCH_COUNT + COMBINED_COUNT


@inlined_kernel
def largest(quantities):
    """(largest of four, its place)."""
    a, b, c, d = quantities
    value, place = a, 0.0
    if b > value:
        value, place = b, 1.0
    if c > value:
        value, place = c, 2.0
    if d > value:
        value, place = d, 3.0
    return value, place


class Outline(NamedTuple):
    """Where the edges stand in the frame of the part, and the bottom corners beside the slot.

    ``along_face`` and ``along_axis`` as in ``EdgePlace``, (X, Y) of the corners, and how deep A2 is
    behind the left side, in the reading in force.
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


@inlined_kernel
def outline(q, p):
    """The ``Outline`` for the state ``q``."""
    right = edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    left = edge_place(LEFT_EDGE, q.x, q.y, q.tilt, p)
    behind_side = left.along_face + p.half_width
    if p.printed_side_gap != 0.0:
        behind_side = edge_on_side(q, p).depth
    right_x, right_y = bottom_corner(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    left_x, left_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    return Outline(
        right.along_face, right.along_axis, left.along_face, left.along_axis, behind_side,
        right_x, right_y, left_x, left_y,
    )  # fmt: skip


@inlined_kernel
def _corner(side, at):
    """(X, Y) of a bottom corner."""
    if side == RIGHT_EDGE:
        return at.right_corner_x, at.right_corner_y
    return at.left_corner_x, at.left_corner_y


@inlined_kernel
def not_fallen_in(at, p):
    """Negative once s >= a, X_B2 >= -l and Y_B2 < 0: A1 past B1, B2 in the slot (R8)."""
    past = p.half_width - at.right_along_face
    return past, -at.left_corner_x - p.slot_half_width, at.left_corner_y, NOTHING


@inlined_kernel
def corners_outside(at, p):
    """Negative once X_B1 <= l, X_B2 >= -l, Y_B1 < 0 and Y_B2 < 0 (paper, sect. 2)."""
    right, left = at.right_corner_x - p.slot_half_width, -at.left_corner_x - p.slot_half_width
    return right, left, at.right_corner_y, at.left_corner_y


@inlined_kernel
def edge_inside(edge, at, p):
    """How far an edge is inside the part: (through bottom, left, right, top), all positive inside.

    On the left edge the depth behind the left side is that of the reading in force.
    """
    if edge == RIGHT_EDGE:
        face, axis = at.right_along_face, at.right_along_axis
        return p.half_height + axis, face + p.half_width, p.half_width - face, p.half_height - axis
    face, axis = at.left_along_face, at.left_along_axis
    return p.half_height + axis, at.left_behind_side, p.half_width - face, p.half_height - axis


@inlined_kernel
def edge_outside(edge, at, p):
    """Negative once an edge has entered the part."""
    bottom, left, right, top = edge_inside(edge, at, p)
    return -bottom, -left, -right, -top


@inlined_kernel
def corner_below(side, at, tilt, p):
    """Negative where a bottom corner stands beside the slot, below the plane, and is the lower one.

    Else the edge carries the bottom face.
    """
    corner_x, corner_y = _corner(side, at)
    return p.slot_half_width - side * corner_x, corner_y, side * tilt + FLAT, NOTHING


@inlined_kernel
def corner_above(side, at, q, p):
    """Negative once a bottom corner presses on the flat beside the slot.

    It stands as in ``corner_below`` and moves down: it presses from the depth where it starts to.
    """
    corner_x, _ = _corner(side, at)
    beside, height, lower, _ = corner_below(side, at, q.tilt, p)
    return beside, height, lower, q.y_rate + q.tilt_rate * (corner_x - q.x)


@inlined_kernel
def corner_off_wall(side, at, tilt, p):
    """Negative once a bottom corner, not the lower one, has run into the slot's wall from inside.

    Or has come down beside the slot, with all of the part beside it. Otherwise an edge is in front
    of a corner that comes down there, and carries the part.
    """
    corner_x, corner_y = _corner(side, at)
    return p.slot_half_width - side * corner_x, corner_y, -side * tilt - FLAT, NOTHING


@inlined_kernel
def edge_of_wall(which):
    """The edge above the wall that a function is about."""
    return RIGHT_EDGE if which == RIGHT_WALL else LEFT_EDGE


@inlined_kernel
def quantities_at(which, at, tilt, p):
    """As ``quantities``, but a corner's does not ask whether it moves down: all it needs is places.

    ``at`` is an ``Outline``. Each quantity is a constant plus multiples of what it is made of.
    """
    if which == ALIGNED:
        return not_fallen_in(at, p)
    if which == CORNERS_INSIDE:
        return corners_outside(at, p)
    if which == RIGHT_EDGE_ENTERS:
        return edge_outside(RIGHT_EDGE, at, p)
    if which == LEFT_EDGE_ENTERS:
        return edge_outside(LEFT_EDGE, at, p)
    if which == RIGHT_CORNER_LANDS:
        return corner_below(RIGHT_EDGE, at, tilt, p)
    if which == LEFT_CORNER_LANDS:
        return corner_below(LEFT_EDGE, at, tilt, p)
    return corner_off_wall(edge_of_wall(which), at, tilt, p)


@kernel
def quantities(which, q, p):
    """The four quantities whose largest is the combined function ``which``."""
    at = outline(q, p)
    if which == RIGHT_CORNER_LANDS:
        return corner_above(RIGHT_EDGE, at, q, p)
    if which == LEFT_CORNER_LANDS:
        return corner_above(LEFT_EDGE, at, q, p)
    return quantities_at(which, at, q.tilt, p)


@inlined_kernel
def is_wall(which):
    """Whether a function is that of a corner against the wall.

    A corner that an edge lets go stands behind the wall, as the edge pressed, and comes out.
    """
    return which == RIGHT_WALL or which == LEFT_WALL


@inlined_kernel
def friction_margin(sticks, slip_sign, slip, friction_size, load, p):
    """Sliding: slip in its direction. Sticking: what |friction| leaves of its limit."""
    if sticks:
        return p.friction * load - friction_size
    return slip_sign * slip


@inlined_kernel
def _contact_switches(state, depth, load):
    """(load, gap, reload) functions of one contact."""
    if state == CLOSED:
        return load, NEVER, NEVER
    if state == RELEASED:
        return NEVER, depth, -load
    return NEVER, NEVER, NEVER


@inlined_kernel
def face_switches(depth, load, along_face, p, mode):
    """(load, gap, reload, end, far end) of the edge on the bottom face."""
    load, gap, reload = _contact_switches(mode.face, depth, load)
    along = mode.edge * along_face
    return load, gap, reload, p.half_width - along, p.half_width + along


@inlined_kernel
def _face_switches(q, p, mode):
    if mode.face == OPEN:
        return NEVER, NEVER, NEVER, NEVER, NEVER
    face = edge_on_face(mode.edge, q, p)
    load = contact_load(face.depth, face.closing_rate, q, p)
    along_face = edge_place(mode.edge, q.x, q.y, q.tilt, p).along_face
    return face_switches(face.depth, load, along_face, p, mode)


@inlined_kernel
def side_switches(depth, load, size_along_axis, p, mode):
    """(load, gap, reload, end) of A2 on the left side face."""
    load, gap, reload = _contact_switches(mode.side, depth, load)
    return load, gap, reload, p.half_height - size_along_axis


@inlined_kernel
def _side_switches(q, p, mode):
    if mode.side == OPEN:
        return NEVER, NEVER, NEVER, NEVER
    side = edge_on_side(q, p)
    load = contact_load(side.depth, side.closing_rate, q, p)
    along_axis = edge_place(LEFT_EDGE, q.x, q.y, q.tilt, p).along_axis
    return side_switches(side.depth, load, abs(along_axis), p, mode)


@inlined_kernel
def _corner_switches(q, p, mode):
    """(load, gap, reload, end) of the supporting side's corner on the flat base."""
    if mode.corner == OPEN:
        return NEVER, NEVER, NEVER, NEVER
    corner = corner_on_flat(mode.edge, q, p)
    depth = corner.depth - mode.corner_offset
    load = contact_load(depth, corner.closing_rate, q, p)
    load, gap, reload = _contact_switches(mode.corner, depth, load)
    corner_x, _ = bottom_corner(mode.edge, q.x, q.y, q.tilt, p)
    return load, gap, reload, mode.edge * corner_x - p.slot_half_width


@inlined_kernel
def _friction_switches(time, q, p, mode):
    """(support, side): the friction margins of what presses."""
    supported, beside = is_supported(mode), mode.side == CLOSED
    if never_sticks(p) or not (supported or beside):
        return NEVER, NEVER
    at = motion(time, q, p, mode)
    support = friction_margin(
        mode.support_slip == STICKING, mode.support_slip,
        at.support_slip, abs(at.support_friction), at.support_load, p,
    )  # fmt: skip
    side = friction_margin(
        mode.side_slip == STICKING, mode.side_slip,
        at.side_slip, abs(at.side_friction), at.side_load, p,
    )  # fmt: skip
    return support if supported else NEVER, side if beside else NEVER


class Applies(NamedTuple):
    """Which combined functions apply in a mode, in the order of their indices."""

    aligned: bool
    corners_inside: bool
    right_edge_enters: bool
    left_edge_enters: bool
    right_corner_lands: bool
    left_corner_lands: bool
    right_wall: bool
    left_wall: bool


@inlined_kernel
def applies_in(mode):
    """``Applies`` for ``mode``."""
    right, left = mode.edge == RIGHT_EDGE, mode.edge == LEFT_EDGE
    no_right_face = not (right and mode.face != OPEN)
    no_left_face = not (left and mode.face != OPEN)
    no_right_corner = not (right and mode.corner != OPEN)
    no_left_corner = not (left and mode.corner != OPEN)
    no_side = mode.side == OPEN
    return Applies(
        no_right_face and not mode.dropped,
        no_right_face and mode.dropped,
        no_right_face,
        no_left_face and no_side,
        no_right_corner,
        # While A2 is behind the side face, B2 beside the slot has come through its wall.
        no_left_corner and no_side,
        no_right_corner and no_right_face and not mode.dropped,
        no_left_corner and no_left_face,
    )


@inlined_kernel
def _only_if(applies, quantities):
    """The largest of four and its place where the condition applies, else (NEVER, NEVER)."""
    return largest(quantities) if applies else (NEVER, NEVER)


@inlined_kernel
def switching_sample(time, q, p, mode):
    """The switching functions for the state ``q`` in ``mode``, as SAMPLE_SIZE numbers.

    In the order of their indices, and behind them which quantity is the largest in the combined
    ones.
    """
    at, applies = outline(q, p), applies_in(mode)
    aligned = _only_if(applies.aligned, not_fallen_in(at, p))
    inside = _only_if(applies.corners_inside, corners_outside(at, p))
    right_edge = _only_if(applies.right_edge_enters, edge_outside(RIGHT_EDGE, at, p))
    left_edge = _only_if(applies.left_edge_enters, edge_outside(LEFT_EDGE, at, p))
    right_corner = _only_if(applies.right_corner_lands, corner_above(RIGHT_EDGE, at, q, p))
    left_corner = _only_if(applies.left_corner_lands, corner_above(LEFT_EDGE, at, q, p))
    right_wall = _only_if(applies.right_wall, corner_off_wall(RIGHT_EDGE, at, q.tilt, p))
    left_wall = _only_if(applies.left_wall, corner_off_wall(LEFT_EDGE, at, q.tilt, p))
    face_load, face_gap, face_reload, face_end, face_far_end = _face_switches(q, p, mode)
    side_load, side_gap, side_reload, side_end = _side_switches(q, p, mode)
    corner_load, corner_gap, corner_reload, corner_end = _corner_switches(q, p, mode)
    support_slip, side_slip = _friction_switches(time, q, p, mode)
    return (
        aligned[0], inside[0], right_edge[0], left_edge[0],
        right_corner[0], left_corner[0], right_wall[0], left_wall[0],
        face_load, face_gap, face_reload, face_end, face_far_end,
        side_load, side_gap, side_reload, side_end,
        corner_load, corner_gap, corner_reload, corner_end,
        support_slip, side_slip, LARGEST_TILT - abs(q.tilt),
        aligned[1], inside[1], right_edge[1], left_edge[1],
        right_corner[1], left_corner[1], right_wall[1], left_wall[1],
    )  # fmt: skip


@kernel
def switching_functions(time, q, p, mode, out):
    """Write ``switching_sample`` into ``out``, shape (SAMPLE_SIZE,)."""
    sample = switching_sample(time, q, p, mode)
    for i in range(SAMPLE_SIZE):
        out[i] = sample[i]


@kernel
def switching_function(which, time, q, p, mode):
    """One of ``switching_sample``, that applies in ``mode``, without the others."""
    if which < COMBINED_COUNT:
        return largest(quantities(which, q, p))[0]
    if which <= FACE_FAR_END:
        return _face_switches(q, p, mode)[which - FACE_LOAD]
    if which <= SIDE_END:
        return _side_switches(q, p, mode)[which - SIDE_LOAD]
    if which <= CORNER_END:
        return _corner_switches(q, p, mode)[which - CORNER_LOAD]
    if which <= SIDE_SLIP:
        return _friction_switches(time, q, p, mode)[which - SUPPORT_SLIP]
    return LARGEST_TILT - abs(q.tilt)
