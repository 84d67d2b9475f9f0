"""Transitions at events: (next mode, CONTINUES, NONE), or the end of the run.

A transition takes (time, q, p, mode, declared): time and state of the event, the mode that ends,
and the contacts that the scene declares.
"""

from typing import Any, NamedTuple

from model.compile.kernels import inlined_kernel, kernel
from model.events.event_functions import edge_inside
from model.events.friction import decide_friction, sign
from model.events.outcomes import OUTCOME, REASON
from model.events.sources import corner_positions, on_both_sides
from model.physics.contacts import contact_load, corner_on_flat, edge_on_side, support_on_face
from model.physics.geometry import bottom_corner, edge_place
from model.physics.modes import (
    CLOSED,
    OPEN,
    RELEASED,
    STICKING,
    with_drop,
    with_friction,
    with_support_opened,
)
from model.physics.motion import motion_at
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

# Plain integers for kernels; CONTINUES: the run continues in the returned mode.
CONTINUES = -1


@inlined_kernel
def decided(time, q, p, mode, support_at_rest, side_at_rest):
    """Continue in ``mode`` with consistent friction states, or fail if there are none."""
    found, possible = decide_friction(time, q, p, mode, support_at_rest, side_at_rest)
    if possible:
        return found, CONTINUES, REASON.NONE
    return mode, OUTCOME.FAILED, REASON.NO_FRICTION_SOLUTION


# ------------------------------------------------------------------------------------- ends of runs


@inlined_kernel
def fallen_in(_time, _q, _p, mode, _declared):
    """Align in flight: A1 is past B1, B2 in the slot."""
    return with_drop(mode), OUTCOME.ALIGNED, REASON.NONE


def ending(outcome: int, reason: int = REASON.NONE) -> Any:
    """Make the transition that ends the run."""

    @inlined_kernel
    def end(_time, _q, _p, mode, _declared):
        return mode, outcome, reason

    return end


inside = ending(OUTCOME.ALIGNED)  # by the paper's corner conditions
overturned = ending(OUTCOME.LEFT_SCENE, REASON.OVERTURNED)


@kernel
def _passed(edge):
    """Reason for leaving the scene with the whole part beyond an edge."""
    return REASON.MOVED_AWAY if edge == RIGHT_EDGE else REASON.OVERSHOT


@inlined_kernel
def far_end(_time, _q, _p, mode, _declared):
    """Leave the scene over the far end of the face."""
    return mode, OUTCOME.LEFT_SCENE, _passed(mode.edge)


@inlined_kernel
def meets_wall(edge, _time, q, p, mode, _declared):
    """Leave the scene with a corner on the wall, or with the whole part beside the slot."""
    corner_x, _ = bottom_corner(-edge, q.x, q.y, q.tilt, p)
    is_beside = edge * corner_x > p.slot_half_width
    return mode, OUTCOME.LEFT_SCENE, _passed(edge) if is_beside else REASON.CORNER_ON_WALL


right_wall, left_wall = on_both_sides(meets_wall)


# ------------------------------------------------------------------------------ contacts that begin


@kernel
def touching(depth, contact, q, p):
    """State of a contact that begins at a depth: released if a damped base would not press.

    Else closed. It would not press at depth zero under the printed damping law (R3), nor where
    bodies that already overlap separate.
    """
    pulls = contact_load(depth, contact.closing_rate, q, p) <= 0.0 and p.contact_damping > 0.0
    return RELEASED if pulls else CLOSED


@inlined_kernel
def _on_edges(mode):
    """Return the mode with the support, if it was on the right side of the slot, on the edges."""
    return with_support_opened(mode, False) if mode.in_slot else mode


@kernel
def face_lands(edge, time, q, p, mode, declared):
    """Begin the contact of the bottom face with an edge, or with the tips over it."""
    if not declared.edge_on_face:
        return mode, OUTCOME.LEFT_SCENE, REASON.UNDECLARED_CONTACT
    if mode.edge != edge and (mode.face != OPEN or mode.corner != OPEN):
        return mode, OUTCOME.LEFT_SCENE, REASON.BOTH_SIDES
    state = touching(0.0, support_on_face(edge, q, p), q, p)
    met = _on_edges(mode)._replace(edge=edge, face=state)
    return decided(time, q, p, met, False, False)


@inlined_kernel
def meets_bottom(depths, p):
    """Return whether an edge inside a plane part is least deep behind its bottom face.

    A round part's edge meets its side only, at a depth that may equal that behind the bottom.
    """
    bottom, left, right, top = depths
    return not p.is_round and bottom <= min(left, min(right, top))


@kernel
def edge_enters(edge, time, q, p, mode, declared):
    """Begin the contact of an edge with the face behind which it is least deep in the part."""
    depths = edge_inside(edge, corner_positions(q, p), p)
    _, left, right, top = depths
    if meets_bottom(depths, p):
        return face_lands(edge, time, q, p, mode, declared)
    if edge == LEFT_EDGE and left <= min(right, top):
        if not declared.edge_on_side:
            return mode, OUTCOME.LEFT_SCENE, REASON.UNDECLARED_CONTACT
        state = touching(0.0, edge_on_side(LEFT_EDGE, q, p), q, p)
        return decided(time, q, p, mode._replace(side=state), False, False)
    return mode, OUTCOME.LEFT_SCENE, REASON.EDGE_ON_OTHER_FACE


right_edge_enters, left_edge_enters = on_both_sides(edge_enters)
right_tips_enter, left_tips_enter = on_both_sides(face_lands)


@kernel
def corner_lands(edge, time, q, p, mode, declared):
    """Begin the contact of a bottom corner with the flat base, from its depth at the event."""
    if not declared.corner_on_flat:
        return mode, OUTCOME.LEFT_SCENE, REASON.UNDECLARED_CONTACT
    if mode.edge != edge and (mode.face != OPEN or mode.corner != OPEN):
        return mode, OUTCOME.LEFT_SCENE, REASON.BOTH_SIDES
    corner = corner_on_flat(edge, q, p)
    landed = _on_edges(mode)._replace(
        edge=edge, corner=touching(0.0, corner, q, p), corner_offset=corner.depth
    )
    return decided(time, q, p, landed, False, False)


right_corner_lands, left_corner_lands = on_both_sides(corner_lands)


# ----------------------------------------------------------------- loads that end and return, gaps


@kernel
def without_load(depth, p):
    """State of a contact without load: open, or released while the bodies still overlap.

    Without damping, load and depth vanish together; a depth left by rounding is ignored.
    """
    return RELEASED if depth > 0.0 and p.contact_damping > 0.0 else OPEN


class OfContact(NamedTuple):
    """Transitions of a contact: its load ends, returns, a gap opens, the touched surface ends."""

    unloaded: Any
    reloaded: Any
    opens: Any
    ends: Any


def of_contact(depth: Any, put: Any) -> OfContact:
    """Make the transitions of a contact of this ``depth`` (q, p, mode).

    ``put`` (mode, state) returns the mode with another normal state of the contact.
    """

    @inlined_kernel
    def unloaded(time, q, p, mode, _declared):
        """Release or open the contact."""
        state = without_load(depth(q, p, mode), p)
        return decided(time, q, p, put(mode, state), False, False)

    @inlined_kernel
    def reloaded(time, q, p, mode, _declared):
        """Close the contact again."""
        return decided(time, q, p, put(mode, CLOSED), False, False)

    @inlined_kernel
    def opens(_time, _q, _p, mode, _declared):
        """Open the released contact."""
        return put(mode, OPEN), CONTINUES, REASON.NONE

    @inlined_kernel
    def ends(time, q, p, mode, _declared):
        """Open the contact, which may press."""
        return decided(time, q, p, put(mode, OPEN), False, False)

    return OfContact(unloaded, reloaded, opens, ends)


@inlined_kernel
def _face_depth(q, p, mode):
    return support_on_face(mode.edge, q, p).depth


@inlined_kernel
def _face(mode, state):
    return mode._replace(face=state)


@inlined_kernel
def _side_depth(q, p, _mode):
    return edge_on_side(LEFT_EDGE, q, p).depth


@inlined_kernel
def _side(mode, state):
    return mode._replace(side=state)


@inlined_kernel
def _corner_depth(q, p, mode):
    return corner_on_flat(mode.edge, q, p).depth - mode.corner_offset


@inlined_kernel
def _corner(mode, state):
    """Keep the corner's offset while it is released."""
    return mode._replace(corner=state, corner_offset=0.0 if state == OPEN else mode.corner_offset)


FACE = of_contact(_face_depth, _face)
SIDE = of_contact(_side_depth, _side)
CORNER = of_contact(_corner_depth, _corner)


# --------------------------------------------------------------------------------- ends of surfaces


@kernel
def _is_in_slot(time, q, p, mode):
    """Return whether B2 is in the slot, below the plane or at rest on it and about to fall."""
    corner_x, corner_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    if corner_y == 0.0:
        at = motion_at(time, q, p, mode)
        corner_y = at.y + at.tilt * (corner_x - q.x)
    return corner_x >= -p.slot_half_width and corner_y < 0.0


@inlined_kernel
def face_ends(time, q, p, mode, _declared):
    """Align, or fall freely: the edge has passed the corner on its own side."""
    opened = mode._replace(face=OPEN)
    if mode.edge == RIGHT_EDGE and _is_in_slot(time, q, p, opened):
        return with_drop(mode), OUTCOME.ALIGNED, REASON.NONE
    return opened, CONTINUES, REASON.NONE


@kernel
def side_ends(time, q, p, mode, _declared):
    """Open the contact at the corner of the side face, or leave the scene over its top."""
    bottom, _, _, top = edge_inside(LEFT_EDGE, corner_positions(q, p), p)
    if top < bottom:
        return mode, OUTCOME.LEFT_SCENE, REASON.EDGE_ON_OTHER_FACE
    return decided(time, q, p, mode._replace(side=OPEN), False, False)


@kernel
def corner_slides_in(time, q, p, mode, _declared):
    """Open the corner's contact at the slot; align if A1 is already past B1."""
    opened = mode._replace(corner=OPEN, corner_offset=0.0)
    place = edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    if mode.edge == LEFT_EDGE and not mode.dropped and place.along_face >= p.half_width:
        return with_drop(opened), OUTCOME.ALIGNED, REASON.NONE
    return decided(time, q, p, opened, False, False)


# ----------------------------------------------------------------------------------------- friction


@inlined_kernel
def support_turns(time, q, p, mode, _declared):
    """Reverse or stick at zero slip of the support; slip where friction is at its limit."""
    if mode.support_slip != STICKING:
        return decided(time, q, p, mode, True, False)
    at = motion_at(time, q, p, mode)
    return with_friction(mode, -sign(at.support_friction), mode.side_slip), CONTINUES, REASON.NONE


@inlined_kernel
def side_turns(time, q, p, mode, _declared):
    """``support_turns`` for the left side."""
    if mode.side_slip != STICKING:
        return decided(time, q, p, mode, False, True)
    at = motion_at(time, q, p, mode)
    return with_friction(mode, mode.support_slip, -sign(at.side_friction)), CONTINUES, REASON.NONE
