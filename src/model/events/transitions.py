"""What follows a switch: the next mode, or the end of the run."""

from model.events.outcomes import Outcome, Reason
from model.events.table import (
    ALIGNED,
    CORNER_END,
    CORNER_LOAD,
    CORNER_RELOAD,
    CORNERS_INSIDE,
    FACE_END,
    FACE_FAR_END,
    FACE_GAP,
    FACE_LOAD,
    FACE_RELOAD,
    LEFT_CORNER_LANDS,
    LEFT_EDGE_ENTERS,
    OVERTURNED,
    RIGHT_CORNER_LANDS,
    RIGHT_EDGE_ENTERS,
    SIDE_END,
    SIDE_GAP,
    SIDE_LOAD,
    SIDE_RELOAD,
    SIDE_SLIP,
    SUPPORT_SLIP,
    edge_inside,
    edge_of_wall,
    is_wall,
    outline,
)
from model.physics.compiled import inlined_kernel, kernel
from model.physics.contacts import contact_load, corner_on_flat, edge_on_face, edge_on_side
from model.physics.geometry import bottom_corner, edge_place
from model.physics.motion import (
    forces_without_friction,
    is_supported,
    mobility,
    motion,
    never_sticks,
    side_contact,
    sticking_friction,
    support_contact,
    turning,
    under_friction,
)
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.scenes import CLOSED, OPEN, RELEASED, STICKING, Mode

# Plain integers for kernels; CONTINUES means the run goes on in the mode returned.
CONTINUES = -1
_ALIGNED = int(Outcome.ALIGNED)
_LEFT_SCENE = int(Outcome.LEFT_SCENE)
_FAILED = int(Outcome.FAILED)
_NONE = int(Reason.NONE)
_MOVED_AWAY = int(Reason.MOVED_AWAY)
_OVERSHOT = int(Reason.OVERSHOT)
_CORNER_ON_WALL = int(Reason.CORNER_ON_WALL)
_EDGE_ON_OTHER_FACE = int(Reason.EDGE_ON_OTHER_FACE)
_BOTH_SIDES = int(Reason.BOTH_SIDES)
_OVERTURNED = int(Reason.OVERTURNED)
_UNDECLARED_CONTACT = int(Reason.UNDECLARED_CONTACT)
_NO_FRICTION_SOLUTION = int(Reason.NO_FRICTION_SOLUTION)

# A slip below this is no slip: rounding of velocities of order one, with room.
REST_SLIP = 1e-12
# A load below this is none, and so is what rounding of lengths makes of one on a hard base; how far
# to look ahead then.
NO_LOAD = 1e-12
_ROUNDING = 4e-16
_MOMENT = 1e-5


@kernel
def with_face(mode, edge, state):
    """The mode with another normal state of ``edge`` on the bottom face."""
    return Mode(
        edge, state, mode.corner, mode.corner_offset, mode.slip_at_corner, mode.support_slip,
        mode.side, mode.side_slip, mode.dropped,
    )  # fmt: skip


@kernel
def with_corner(mode, edge, state, offset):
    """The mode with another normal state of the corner on the side of ``edge``."""
    return Mode(
        edge, mode.face, state, offset, mode.slip_at_corner, mode.support_slip, mode.side,
        mode.side_slip, mode.dropped,
    )  # fmt: skip


@kernel
def _with_side(mode, state):
    return Mode(
        mode.edge, mode.face, mode.corner, mode.corner_offset, mode.slip_at_corner,
        mode.support_slip, state, mode.side_slip, mode.dropped,
    )  # fmt: skip


@kernel
def _with_friction(mode, support_slip, side_slip):
    return Mode(
        mode.edge, mode.face, mode.corner, mode.corner_offset, mode.slip_at_corner, support_slip,
        mode.side, side_slip, mode.dropped,
    )  # fmt: skip


@kernel
def _with_drop(mode):
    return Mode(
        mode.edge, OPEN, mode.corner, mode.corner_offset, mode.slip_at_corner, mode.support_slip,
        mode.side, mode.side_slip, True,
    )  # fmt: skip


@kernel
def _with_slip_place(mode):
    """The mode whose slip is that of a contact that presses: the one that counted, if it does."""
    at_corner = mode.corner == CLOSED and (mode.slip_at_corner or mode.face != CLOSED)
    return Mode(
        mode.edge, mode.face, mode.corner, mode.corner_offset, at_corner, mode.support_slip,
        mode.side, mode.side_slip, mode.dropped,
    )  # fmt: skip


@kernel
def _friction_holds(slip_state, friction, load, drive, p):
    """Whether a friction state at zero slip is consistent with what it causes."""
    if slip_state == STICKING:
        return load > 0.0 and abs(friction) <= p.friction * load
    return drive * slip_state >= 0.0


@kernel
def _may_begin(slip_state, friction, drive, least):
    """Whether a contact at rest that carries no load may begin so: it holds nothing.

    ``drive`` is that without friction: a state against it would end at once, and come back.
    """
    if slip_state == STICKING:
        return abs(friction) <= least
    return drive * slip_state >= 0.0


@kernel
def _sign(value):
    return -1 if value < 0.0 else 1


@kernel
def _advanced(q, at):
    """The state a moment later, under the accelerations of ``at``."""
    return State(
        q.x + _MOMENT * (q.x_rate + 0.5 * _MOMENT * at.x),
        q.y + _MOMENT * (q.y_rate + 0.5 * _MOMENT * at.y),
        q.tilt + _MOMENT * (q.tilt_rate + 0.5 * _MOMENT * at.tilt),
        q.x_rate + _MOMENT * at.x,
        q.y_rate + _MOMENT * at.y,
        q.tilt_rate + _MOMENT * at.tilt,
    )


@kernel
def decide_friction(time, q, p, mode, support_at_rest, side_at_rest):
    """The mode with friction states that fit the slips, and whether there are any.

    A contact that slips keeps the sign of its slip. For a contact at rest every state is tried,
    sticking first, and the first set of states that is consistent with its own accelerations holds.
    Where a contact at rest carries no load yet, nothing decides at this instant: the states are
    tried on what follows a moment later, and on how they may begin.
    """
    mode = _with_slip_place(mode)
    if never_sticks(p):
        return _with_friction(mode, -1, -1), True
    forces = forces_without_friction(time, q, p, mode)
    now = under_friction(forces, p, mode)
    supported = is_supported(mode)
    beside = mode.side == CLOSED
    support_at_rest = supported and (support_at_rest or abs(now.support_slip) <= REST_SLIP)
    side_at_rest = beside and (side_at_rest or abs(now.side_slip) <= REST_SLIP)
    lengths = p.half_width + p.half_height + abs(q.x) + abs(q.y)
    least = NO_LOAD + _ROUNDING * p.contact_stiffness * lengths
    support_unloaded = support_at_rest and now.support_load <= least
    side_unloaded = side_at_rest and now.side_load <= least
    no_load = support_unloaded or side_unloaded
    begins = now  # as slip begins: without friction where there is no load
    if no_load:
        support_begins = -1 if support_at_rest else _sign(now.support_slip)
        side_begins = -1 if side_at_rest else _sign(now.side_slip)
        begins = under_friction(forces, p, _with_friction(mode, support_begins, side_begins))
    for i in range(3 if support_at_rest else 1):
        support = (STICKING, -1, 1)[i] if support_at_rest else _sign(now.support_slip)
        for j in range(3 if side_at_rest else 1):
            side = (STICKING, -1, 1)[j] if side_at_rest else _sign(now.side_slip)
            trial = _with_friction(mode, support, side)
            at = under_friction(forces, p, trial)
            holds = True
            if support_unloaded:
                holds = _may_begin(support, at.support_friction, begins.support_drive, least)
            if side_unloaded:
                holds = holds and _may_begin(side, at.side_friction, begins.side_drive, least)
            if no_load:
                at = motion(time + _MOMENT, _advanced(q, at), p, trial)
            if support_at_rest:
                holds = holds and _friction_holds(
                    support, at.support_friction, at.support_load, at.support_drive, p
                )
            if side_at_rest:
                holds = holds and _friction_holds(
                    side, at.side_friction, at.side_load, at.side_drive, p
                )
            if holds:
                return trial, True
    if no_load and support_unloaded == support_at_rest and side_unloaded == side_at_rest:
        support = _sign(begins.support_drive if support_at_rest else now.support_slip)
        side = _sign(begins.side_drive if side_at_rest else now.side_slip)
        return _with_friction(mode, support, side), True
    return mode, False


@inlined_kernel
def hold_sticking(q, p, mode):
    """``q`` with the slip of what sticks removed by friction impulses: rounding must not drift."""
    support_sticks = is_supported(mode) and mode.support_slip == STICKING
    side_sticks = mode.side == CLOSED and mode.side_slip == STICKING
    if not (support_sticks or side_sticks):
        return q
    support, side = support_contact(q, p, mode), side_contact(q, p, mode)
    t, u = support.tangent, side.tangent
    impulse, side_impulse = sticking_friction(
        support_sticks, side_sticks, support.slip, side.slip,
        mobility(support.slip_row, t, p), mobility(support.slip_row, u, p),
        mobility(side.slip_row, t, p), mobility(side.slip_row, u, p),
    )  # fmt: skip
    return State(
        q.x, q.y, q.tilt,
        q.x_rate + impulse * t[0] + side_impulse * u[0],
        q.y_rate + impulse * t[1] + side_impulse * u[1],
        q.tilt_rate + turning(impulse * t[2] + side_impulse * u[2], p),
    )  # fmt: skip


@inlined_kernel
def without_residual_slip(which, q, p, mode):
    """``q`` with exactly no slip where a sliding contact has come to rest.

    A switch is located to the accuracy of a step; the slip left over would contradict the friction
    state decided for rest.
    """
    if which == SUPPORT_SLIP and mode.support_slip != STICKING:
        return hold_sticking(q, p, _with_friction(mode, STICKING, mode.side_slip))
    if which == SIDE_SLIP and mode.side_slip != STICKING:
        return hold_sticking(q, p, _with_friction(mode, mode.support_slip, STICKING))
    return q


@inlined_kernel
def _decided(time, q, p, mode, support_at_rest, side_at_rest):
    # Not the literal True or False: for each of them everything below would be compiled again.
    at_rest = bool(support_at_rest), bool(side_at_rest)
    decided, possible = decide_friction(time, q, p, mode, at_rest[0], at_rest[1])
    if possible:
        return decided, CONTINUES, _NONE
    return mode, _FAILED, _NO_FRICTION_SOLUTION


@kernel
def _touching(contact, q, p):
    """State of a contact that begins: released if the base would have to pull at once.

    That happens under the printed damping law (R3), whose load starts below zero.
    """
    pulls = contact_load(0.0, contact.closing_rate, q, p) <= 0.0 and p.contact_damping > 0.0
    return RELEASED if pulls else CLOSED


@kernel
def _edge_enters(edge, time, q, p, mode, declared):
    """An edge enters the part: through the face of which it is least deep."""
    bottom, left, right, top = edge_inside(edge, outline(q, p), p)
    if bottom <= min(left, min(right, top)):
        if not declared.edge_on_face:
            return mode, _LEFT_SCENE, _UNDECLARED_CONTACT
        if mode.edge != edge and (mode.face != OPEN or mode.corner != OPEN):
            return mode, _LEFT_SCENE, _BOTH_SIDES
        state = _touching(edge_on_face(edge, q, p), q, p)
        return _decided(time, q, p, with_face(mode, edge, state), False, False)
    if edge == LEFT_EDGE and left <= min(right, top):
        if not declared.edge_on_side:
            return mode, _LEFT_SCENE, _UNDECLARED_CONTACT
        state = _touching(edge_on_side(q, p), q, p)
        return _decided(time, q, p, _with_side(mode, state), False, False)
    return mode, _LEFT_SCENE, _EDGE_ON_OTHER_FACE


@kernel
def _corner_lands(edge, time, q, p, mode, declared):
    """A bottom corner presses on the flat, from the depth at which it stands."""
    if not declared.corner_on_flat:
        return mode, _LEFT_SCENE, _UNDECLARED_CONTACT
    if mode.edge != edge and (mode.face != OPEN or mode.corner != OPEN):
        return mode, _LEFT_SCENE, _BOTH_SIDES
    corner = corner_on_flat(edge, q, p)
    landed = with_corner(mode, edge, _touching(corner, q, p), corner.depth)
    return _decided(time, q, p, landed, False, False)


@kernel
def _is_in_slot(time, q, p, mode):
    """Whether the corner B2 is in the slot, below the plane or at rest on it and about to fall."""
    corner_x, corner_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    if corner_y == 0.0:
        at = motion(time, q, p, mode)
        corner_y = at.y + at.tilt * (corner_x - q.x)
    return corner_x >= -p.slot_half_width and corner_y < 0.0


@kernel
def _passed(edge):
    """Why a part has left the scene that is wholly beyond an edge."""
    return _MOVED_AWAY if edge == RIGHT_EDGE else _OVERSHOT


@kernel
def _is_beside(edge, q, p):
    """Whether all of the bottom face is beyond an edge, beside the slot."""
    corner_x, _ = bottom_corner(-edge, q.x, q.y, q.tilt, p)
    return edge * corner_x > p.slot_half_width


@inlined_kernel
def _face_ends(time, q, p, mode):
    """The edge has passed the end of the bottom face toward the slot: alignment, or a free fall."""
    opened = with_face(mode, mode.edge, OPEN)
    if mode.edge == RIGHT_EDGE and _is_in_slot(time, q, p, opened):
        return _with_drop(mode), _ALIGNED, _NONE
    return opened, CONTINUES, _NONE


@kernel
def _corner_slides_in(time, q, p, mode):
    """A bottom corner has slid from the flat into the slot: alignment if A1 is past B1 already."""
    opened = with_corner(mode, mode.edge, OPEN, 0.0)
    place = edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    if mode.edge == LEFT_EDGE and not mode.dropped and place.along_face >= p.half_width:
        return _with_drop(opened), _ALIGNED, _NONE
    return _decided(time, q, p, opened, False, False)


@kernel
def _unloaded(depth, p):
    """State of a contact whose load has gone: open, or released while the bodies still overlap.

    Without damping load and depth vanish together, whatever rounding leaves of the depth.
    """
    return RELEASED if depth > 0.0 and p.contact_damping > 0.0 else OPEN


@inlined_kernel
def _contact_switch(which, time, q, p, mode):
    """Loads that go and return, gaps that open, faces that end."""
    if which == FACE_LOAD:
        state = _unloaded(edge_on_face(mode.edge, q, p).depth, p)
        return _decided(time, q, p, with_face(mode, mode.edge, state), False, False)
    if which == FACE_RELOAD:
        return _decided(time, q, p, with_face(mode, mode.edge, CLOSED), False, False)
    if which == FACE_GAP:
        return with_face(mode, mode.edge, OPEN), CONTINUES, _NONE
    if which == SIDE_LOAD:
        state = _unloaded(edge_on_side(q, p).depth, p)
        return _decided(time, q, p, _with_side(mode, state), False, False)
    if which == SIDE_RELOAD:
        return _decided(time, q, p, _with_side(mode, CLOSED), False, False)
    if which == SIDE_GAP:
        return _with_side(mode, OPEN), CONTINUES, _NONE
    if which == SIDE_END:
        bottom, _, _, top = edge_inside(LEFT_EDGE, outline(q, p), p)
        if top < bottom:
            return mode, _LEFT_SCENE, _EDGE_ON_OTHER_FACE
        return _decided(time, q, p, _with_side(mode, OPEN), False, False)
    if which == CORNER_LOAD:
        state = _unloaded(corner_on_flat(mode.edge, q, p).depth - mode.corner_offset, p)
        offset = mode.corner_offset if state == RELEASED else 0.0
        return _decided(time, q, p, with_corner(mode, mode.edge, state, offset), False, False)
    if which == CORNER_RELOAD:
        closed = with_corner(mode, mode.edge, CLOSED, mode.corner_offset)
        return _decided(time, q, p, closed, False, False)
    if which == CORNER_END:
        return _corner_slides_in(time, q, p, mode)
    # CORNER_GAP
    opened = with_corner(mode, mode.edge, OPEN, 0.0)
    return _decided(time, q, p, opened, False, False)


@inlined_kernel
def _friction_switch(which, time, q, p, mode):
    """Slip that reaches zero reverses or sticks; sticking that reaches its limit slips."""
    at_support = which == SUPPORT_SLIP
    if (mode.support_slip if at_support else mode.side_slip) != STICKING:
        return _decided(time, q, p, mode, at_support, not at_support)
    at = motion(time, q, p, mode)
    if at_support:
        broken = _with_friction(mode, -_sign(at.support_friction), mode.side_slip)
    else:
        broken = _with_friction(mode, mode.support_slip, -_sign(at.side_friction))
    return broken, CONTINUES, _NONE


@inlined_kernel
def switch(which, time, q, p, mode, declared):
    """What follows switching function ``which``: (mode, outcome, reason)."""
    if which == ALIGNED:
        return _with_drop(mode), _ALIGNED, _NONE
    if which == CORNERS_INSIDE:
        return mode, _ALIGNED, _NONE
    if which == RIGHT_EDGE_ENTERS:
        return _edge_enters(RIGHT_EDGE, time, q, p, mode, declared)
    if which == LEFT_EDGE_ENTERS:
        return _edge_enters(LEFT_EDGE, time, q, p, mode, declared)
    if which == RIGHT_CORNER_LANDS:
        return _corner_lands(RIGHT_EDGE, time, q, p, mode, declared)
    if which == LEFT_CORNER_LANDS:
        return _corner_lands(LEFT_EDGE, time, q, p, mode, declared)
    if which == FACE_END:
        return _face_ends(time, q, p, mode)
    if which == FACE_FAR_END:
        return mode, _LEFT_SCENE, _passed(mode.edge)
    if is_wall(which):
        edge = edge_of_wall(which)
        return mode, _LEFT_SCENE, _passed(edge) if _is_beside(edge, q, p) else _CORNER_ON_WALL
    if which == OVERTURNED:
        return mode, _LEFT_SCENE, _OVERTURNED
    if which == SUPPORT_SLIP or which == SIDE_SLIP:
        return _friction_switch(which, time, q, p, mode)
    return _contact_switch(which, time, q, p, mode)
