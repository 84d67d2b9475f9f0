"""Where a mode ends: one scalar function for each switch, positive while the mode holds.

A switch happens where its function falls through zero. Functions that do not apply in a mode are
``NEVER``. What follows a switch stands in transitions.py.

A condition that several quantities must meet at once is the largest of them, each negative where
its part is met. Such a function is not smooth, and may be negative for an instant only, between two
samples; which quantity is the largest is therefore sampled with it, so that locate.py can look
where that changes.
"""

from math import pi

from model.physics.compiled import inlined_kernel, kernel
from model.physics.contacts import contact_load, corner_on_flat, edge_on_face, edge_on_side
from model.physics.geometry import bottom_corner, edge_place
from model.physics.motion import is_supported, motion, never_sticks
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.scenes import CLOSED, OPEN, RELEASED, STICKING

NEVER = 1e300
LARGEST_TILT = 0.5 * pi - 1e-3  # just below 90 degrees, where the paper's arm q has its pole
_NOTHING = -1e300  # a quantity that a condition does not have

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
def _largest(a, b, c, d):
    """(largest of four, its place)."""
    value, place = a, 0.0
    if b > value:
        value, place = b, 1.0
    if c > value:
        value, place = c, 2.0
    if d > value:
        value, place = d, 3.0
    return value, place


@inlined_kernel
def not_fallen_in(q, p):
    """Falls through zero once s >= a, X_B2 >= -l and Y_B2 < 0: A1 past B1, B2 in the slot (R8)."""
    place = edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    corner_x, corner_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    return _largest(
        p.half_width - place.along_face, -corner_x - p.slot_half_width, corner_y, _NOTHING
    )


@inlined_kernel
def corners_outside(q, p):
    """Falls through zero once X_B1 <= l, X_B2 >= -l, Y_B1 < 0 and Y_B2 < 0 (paper, sect. 2)."""
    right_x, right_y = bottom_corner(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    left_x, left_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    return _largest(right_x - p.slot_half_width, -left_x - p.slot_half_width, right_y, left_y)


@inlined_kernel
def edge_inside(edge, q, p):
    """How far an edge is inside the part: (through bottom, left, right, top), all positive inside.

    On the left edge the depth behind the left side is that of the reading in force.
    """
    place = edge_place(edge, q.x, q.y, q.tilt, p)
    left = place.along_face + p.half_width
    if edge == LEFT_EDGE and p.printed_side_gap != 0.0:
        left = edge_on_side(q, p).depth
    return (
        p.half_height + place.along_axis,
        left,
        p.half_width - place.along_face,
        p.half_height - place.along_axis,
    )


@inlined_kernel
def edge_outside(edge, q, p):
    """Falls through zero as an edge enters the part."""
    bottom, left, right, top = edge_inside(edge, q, p)
    return _largest(-bottom, -left, -right, -top)


@inlined_kernel
def corner_above(side, q, p):
    """Falls through zero as a bottom corner starts to press on the flat beside the slot.

    It must stand beside the slot, below the plane, be the lower corner of the bottom face (else
    the edge carries the face) and move down.
    """
    corner_x, corner_y = bottom_corner(side, q.x, q.y, q.tilt, p)
    closing_rate = -(q.y_rate + q.tilt_rate * (corner_x - q.x))
    return _largest(p.slot_half_width - side * corner_x, corner_y, side * q.tilt, -closing_rate)


@inlined_kernel
def corner_off_wall(side, q, p):
    """Falls through zero as a bottom corner runs against the slot's wall from inside."""
    corner_x, corner_y = bottom_corner(side, q.x, q.y, q.tilt, p)
    return _largest(p.slot_half_width - side * corner_x, corner_y, -side * q.tilt, _NOTHING)


@inlined_kernel
def friction_margin(sticks, slip_sign, slip, friction, load, p):
    """Sliding: slip in its direction. Sticking: what is left of the friction limit."""
    if sticks:
        return p.friction * load - abs(friction)
    return slip_sign * slip


@inlined_kernel
def _contact_switches(state, depth, load, base, out):
    """Load, gap and reload functions of one contact at ``base``, ``base + 1``, ``base + 2``."""
    if state == CLOSED:
        out[base] = load
    elif state == RELEASED:
        out[base + 1] = depth
        out[base + 2] = -load


@inlined_kernel
def _face_switches(q, p, mode, out):
    if mode.face == OPEN:
        return
    face = edge_on_face(mode.edge, q, p)
    load = contact_load(face.depth, face.closing_rate, q, p)
    _contact_switches(mode.face, face.depth, load, FACE_LOAD, out)
    along = mode.edge * edge_place(mode.edge, q.x, q.y, q.tilt, p).along_face
    out[FACE_END] = p.half_width - along
    out[FACE_FAR_END] = p.half_width + along


@inlined_kernel
def _side_switches(q, p, mode, out):
    if mode.side == OPEN:
        return
    side = edge_on_side(q, p)
    load = contact_load(side.depth, side.closing_rate, q, p)
    _contact_switches(mode.side, side.depth, load, SIDE_LOAD, out)
    along = edge_place(LEFT_EDGE, q.x, q.y, q.tilt, p).along_axis
    out[SIDE_END] = p.half_height - abs(along)


@inlined_kernel
def _corner_switches(q, p, mode, out):
    if mode.corner == OPEN:
        return
    corner = corner_on_flat(mode.edge, q, p)
    depth = corner.depth - mode.corner_offset
    load = contact_load(depth, corner.closing_rate, q, p)
    _contact_switches(mode.corner, depth, load, CORNER_LOAD, out)
    corner_x, _ = bottom_corner(mode.edge, q.x, q.y, q.tilt, p)
    out[CORNER_END] = mode.edge * corner_x - p.slot_half_width


@inlined_kernel
def _friction_switches(time, q, p, mode, out):
    supported = is_supported(mode)
    if never_sticks(p) or not (supported or mode.side == CLOSED):
        return
    at = motion(time, q, p, mode)
    if supported:
        sticks = mode.support_slip == STICKING
        out[SUPPORT_SLIP] = friction_margin(
            sticks, mode.support_slip, at.support_slip, at.support_friction, at.support_load, p
        )
    if mode.side == CLOSED:
        sticks = mode.side_slip == STICKING
        out[SIDE_SLIP] = friction_margin(
            sticks, mode.side_slip, at.side_slip, at.side_friction, at.side_load, p
        )


@inlined_kernel
def _combined(which, largest, out):
    out[which], out[SWITCH_COUNT + which] = largest


@kernel
def switching_functions(time, q, p, mode, out):
    """Write a sample for the state ``q`` in ``mode`` into ``out``, shape (SAMPLE_SIZE,).

    The switching functions, and behind them which quantity is the largest in the combined ones.
    """
    out[:] = NEVER
    right_face = mode.edge == RIGHT_EDGE and mode.face != OPEN
    left_face = mode.edge == LEFT_EDGE and mode.face != OPEN
    right_corner = mode.edge == RIGHT_EDGE and mode.corner != OPEN
    left_corner = mode.edge == LEFT_EDGE and mode.corner != OPEN
    _face_switches(q, p, mode, out)
    _side_switches(q, p, mode, out)
    _corner_switches(q, p, mode, out)
    _friction_switches(time, q, p, mode, out)
    if not right_face:
        _combined(RIGHT_EDGE_ENTERS, edge_outside(RIGHT_EDGE, q, p), out)
        if mode.dropped:
            _combined(CORNERS_INSIDE, corners_outside(q, p), out)
        else:
            _combined(ALIGNED, not_fallen_in(q, p), out)
    if not left_face and mode.side == OPEN:
        _combined(LEFT_EDGE_ENTERS, edge_outside(LEFT_EDGE, q, p), out)
    if not right_corner:
        _combined(RIGHT_CORNER_LANDS, corner_above(RIGHT_EDGE, q, p), out)
        if not right_face and not mode.dropped:
            _combined(RIGHT_WALL, corner_off_wall(RIGHT_EDGE, q, p), out)
    if not left_corner:
        _combined(LEFT_CORNER_LANDS, corner_above(LEFT_EDGE, q, p), out)
        if not left_face:
            _combined(LEFT_WALL, corner_off_wall(LEFT_EDGE, q, p), out)
    out[OVERTURNED] = LARGEST_TILT - abs(q.tilt)
