"""The insertion scene: the alignment scene, continued in the slot until the part is inserted.

It adds A1 on the right side face, and the bottom corners on the walls of the slot. A part touches
two points at most on either side of the slot: an edge on a side face, and the corner below it on
the wall. Until alignment the two scenes have the same events; a side that meets A1 aligns the part
here, and leaves the alignment scene.
"""

from dataclasses import replace
from math import sqrt

from model.compile.kernels import inlined_kernel, kernel
from model.events import event_functions as functions
from model.events import sources, table, transitions
from model.events.event_functions import edge_inside
from model.events.outcomes import OUTCOME, REASON
from model.events.scenes import CONTACT_NAMES, Scene
from model.events.sources import corner_positions, on_both_sides
from model.events.table import CONDITIONS, CONTACTS, Event, Source, changed, of_contact, state_is
from model.events.transitions import (
    CONTINUES,
    decided,
    edge_enters,
    ending,
    meets_bottom,
    touching,
)
from model.physics.contacts import corner_on_wall, dot, edge_on_side
from model.physics.geometry import bottom_corner
from model.physics.modes import (
    CLOSED,
    OPEN,
    STICKING,
    with_support_opened,
)
from model.physics.motion import is_beside, is_supported, side_contact, support_contact
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

# ----------------------------------------------------------------------------- where events apply


@inlined_kernel
def _stands_on(mode, edge):
    """Return whether an edge is under the bottom face, or its corner on the flat base."""
    return (mode.face != OPEN or mode.corner != OPEN) and not mode.in_slot and mode.edge == edge


@inlined_kernel
def _is_in(_p, mode):
    return mode.dropped


@inlined_kernel
def _has_fallen_in(_p, mode):
    return mode.dropped and not mode.corners_inside


def _before_fall(event: Event) -> Event:
    """Return an event of one case so that it applies only before the part has fallen in."""
    ((applies, function),) = event.function

    @inlined_kernel
    def applies_before(p, mode):
        return not mode.dropped and applies(p, mode)

    return replace(event, function=((applies_before, function),))


@inlined_kernel
def _right_corner_lands_again(p, mode):
    at_side = mode.in_slot and mode.face != OPEN
    return mode.dropped and table.right_corner_is_free(p, mode) and not at_side


@inlined_kernel
def _left_corner_lands_again(p, mode):
    return mode.dropped and table.left_corner_is_free(p, mode)


@inlined_kernel
def _right_corner_meets_side(_p, mode):
    on_wall = mode.in_slot and mode.corner != OPEN
    return mode.dropped and not on_wall and not _stands_on(mode, RIGHT_EDGE)


@inlined_kernel
def _left_corner_meets_side(_p, mode):
    return mode.dropped and mode.wall == OPEN and not _stands_on(mode, LEFT_EDGE)


_on_right_side = state_is("face", OPEN, in_slot=True, negated=True)
_on_right_wall = state_is("corner", OPEN, in_slot=True, negated=True)
_on_left_wall = state_is("wall", OPEN, negated=True)


# -------------------------------------------------------------------------------------- transitions


@inlined_kernel
def _inside(_time, _q, _p, mode, _declared):
    """Record, once, that the paper's corner conditions hold."""
    return mode._replace(corners_inside=True), OUTCOME.ALIGNED, REASON.NONE


@inlined_kernel
def _right_side(mode, state):
    """Return the mode with the state of A1 on the right side face."""
    return mode._replace(edge=RIGHT_EDGE, face=state)


@inlined_kernel
def _right_wall(mode, state):
    """Return the mode with the state of B1 on the right wall."""
    return mode._replace(edge=RIGHT_EDGE, corner=state, corner_offset=0.0)


@inlined_kernel
def _left_wall(mode, state):
    """Return the mode with the state of B2 on the left wall."""
    return mode._replace(wall=state)


@inlined_kernel
def _against_right(mode):
    """Return the mode with the support on the right side of the slot."""
    return mode if mode.in_slot else with_support_opened(mode, True)


@kernel
def _right_edge_enters(time, q, p, mode, declared):
    """Begin the contact of A1 with the right side face, or as ``edge_enters``.

    A part that has not fallen in is aligned then: B1 is in the slot, and B2 over it.
    """
    at = corner_positions(q, p)
    depths = edge_inside(RIGHT_EDGE, at, p)
    _, left, right, top = depths
    in_slot = right <= functions.ON_AN_EVENT and at.left_corner_x >= -p.slot_half_width
    aligns = mode.corner == OPEN and in_slot
    if not (mode.dropped or aligns) or meets_bottom(depths, p):
        return edge_enters(RIGHT_EDGE, time, q, p, mode, declared)
    if right > min(left, top):
        return mode, OUTCOME.LEFT_SCENE, REASON.EDGE_ON_OTHER_FACE
    if _stands_on(mode, LEFT_EDGE):
        return mode, OUTCOME.LEFT_SCENE, REASON.BOTH_SIDES
    state = touching(0.0, edge_on_side(RIGHT_EDGE, q, p), q, p)
    met = _right_side(_against_right(mode), state)._replace(dropped=True)
    found, outcome, reason = decided(time, q, p, met, False, False)
    if not mode.dropped and outcome == CONTINUES:
        return found, OUTCOME.ALIGNED, REASON.NONE
    return found, outcome, reason


@kernel
def _corner_touches(side, time, q, p, mode, _declared):
    """Begin the contact of a bottom corner with the wall on its side.

    An edge that passes its corner at a depth d leaves the corner d sin φ behind the wall.
    """
    if side == RIGHT_EDGE and _stands_on(mode, LEFT_EDGE):
        return mode, OUTCOME.LEFT_SCENE, REASON.BOTH_SIDES
    corner = corner_on_wall(side, q, p)
    state = touching(max(corner.depth, 0.0), corner, q, p)
    met = mode._replace(wall=state)
    if side == RIGHT_EDGE:
        met = _right_wall(_against_right(mode), state)
    return decided(time, q, p, met, False, False)


_right_corner_touches, _left_corner_touches = on_both_sides(_corner_touches)


@kernel
def _right_side_ends(time, q, p, mode, _declared):
    """Open the contact at the corner of the side face, or leave the scene over its top."""
    bottom, _, _, top = edge_inside(RIGHT_EDGE, corner_positions(q, p), p)
    if top < bottom:
        return mode, OUTCOME.LEFT_SCENE, REASON.EDGE_ON_OTHER_FACE
    return decided(time, q, p, _right_side(mode, OPEN), False, False)


@inlined_kernel
def _right_side_depth(q, p, _mode):
    return edge_on_side(RIGHT_EDGE, q, p).depth


@inlined_kernel
def _wall_depth(side, q, p, _mode):
    return corner_on_wall(side, q, p).depth


_right_wall_depth, _left_wall_depth = on_both_sides(_wall_depth)


# ---------------------------------------------------------------------------------------- the table

RIGHT_SIDE = Source(sources.right_side_state, _on_right_side)
RIGHT_WALL = Source(sources.right_wall_state, _on_right_wall)
LEFT_WALL = Source(sources.left_wall_state, _on_left_wall)
_AT_RIGHT_SIDE = transitions.of_contact(_right_side_depth, _right_side)
_AT_RIGHT_WALL = transitions.of_contact(_right_wall_depth, _right_wall)
_AT_LEFT_WALL = transitions.of_contact(_left_wall_depth, _left_wall)

TABLE = (
    *CONDITIONS,
    Event("inserted", table.PLACES, ((_is_in, functions.not_inserted),), ending(OUTCOME.INSERTED)),
    # A bottom corner meets the slot's wall from inside.
    Event(
        "right_corner_touches", table.PLACES,
        ((_right_corner_meets_side, functions.right_corner_in_slot),), _right_corner_touches,
    ),
    Event(
        "left_corner_touches", table.PLACES,
        ((_left_corner_meets_side, functions.left_corner_in_slot),), _left_corner_touches,
    ),
    # A bottom corner lands on the flat base after the part has come out of the slot.
    Event(
        "right_corner_lands_again", table.PLACES,
        ((_right_corner_lands_again, functions.right_corner_over_flat),),
        transitions.right_corner_lands,
    ),
    Event(
        "left_corner_lands_again", table.PLACES,
        ((_left_corner_lands_again, functions.left_corner_over_flat),),
        transitions.left_corner_lands,
    ),
    *CONTACTS,
    *of_contact("right_side", "face", RIGHT_SIDE, _AT_RIGHT_SIDE, ("right", "side"), in_slot=True),
    Event(
        "right_side_end", RIGHT_SIDE, ((_on_right_side, functions.before_side_end),),
        _right_side_ends,
    ),
    *of_contact(
        "right_wall", "corner", RIGHT_WALL, _AT_RIGHT_WALL, ("right", "wall"), in_slot=True
    ),
    Event(
        "right_wall_end", RIGHT_WALL, ((_on_right_wall, functions.below_plane),),
        _AT_RIGHT_WALL.ends,
    ),
    *of_contact("left_wall", "wall", LEFT_WALL, _AT_LEFT_WALL, ("side", "wall")),
    Event(
        "left_wall_end", LEFT_WALL, ((_on_left_wall, functions.below_plane),), _AT_LEFT_WALL.ends
    ),
)  # fmt: skip
TABLE = changed(
    TABLE,
    "corners_inside",
    function=((_has_fallen_in, functions.corners_outside),),
    transition=_inside,
)
TABLE = changed(TABLE, "right_edge_enters", transition=_right_edge_enters)
_NOT_AFTER_FALL = "right_corner_lands", "left_corner_lands", "left_wall"
TABLE = tuple(_before_fall(each) if each.name in _NOT_AFTER_FALL else each for each in TABLE)

INSERTION = Scene("insertion", frozenset(CONTACT_NAMES), TABLE)
"""The alignment scene, continued in the slot: edges on both side faces, corners on both walls."""


# ------------------------------------------------------------------------------------- ends of runs


@kernel
def is_wedged(q, p, mode):
    """Return whether friction alone can hold a part between its two points of contact.

    The line through the points then lies inside both friction cones: θ > c/μ for a small tilt θ and
    the clearance c = (D - d)/D of a peg of width d in a hole of width D (Whitney, J. Dyn. Syst.
    Meas. Control 104 (1982) 65-77).
    """
    right = bottom_corner(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    if mode.corner != CLOSED:
        right = p.slot_half_width, 0.0
    left = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    if mode.wall != CLOSED:
        left = -p.slot_half_width, 0.0
    x, y = left[0] - right[0], left[1] - right[1]
    length = sqrt(x * x + y * y)
    inside = True
    for sign, contact in ((1.0, support_contact(q, p, mode)), (-1.0, side_contact(q, p, mode))):
        along_normal = sign * (x * contact.x + y * contact.y) / contact.load
        along_tangent = dot(contact.tangent, x, y, 0.0)
        inside = inside and abs(along_tangent) <= p.friction * along_normal
    return inside and length > 0.0


@kernel
def end_in_slot(outcome, reason, q, p, mode):
    """Return (outcome, reason) of a run that ends after alignment.

    A part is at rest if its motion has settled, or if it sticks at two points at the horizon. It
    has climbed out if a bottom corner is above the plane, even while it bounces.
    """
    if outcome == OUTCOME.LEFT_SCENE:
        return OUTCOME.CLIMBED_OUT, reason
    if outcome not in (OUTCOME.SETTLED, OUTCOME.HORIZON_REACHED):
        return outcome, reason
    _, right_y = bottom_corner(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    _, left_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    is_out = max(right_y, left_y) > 0.0
    if is_out or _stands_on(mode, RIGHT_EDGE) or _stands_on(mode, LEFT_EDGE):
        return OUTCOME.CLIMBED_OUT, REASON.ON_EDGE
    at_two_points = mode.in_slot and is_supported(mode) and is_beside(mode)
    held = at_two_points and mode.support_slip == STICKING and mode.side_slip == STICKING
    if outcome == OUTCOME.HORIZON_REACHED and not held:
        return outcome, reason
    if at_two_points and is_wedged(q, p, mode):
        return OUTCOME.JAMMED, REASON.WEDGED
    return OUTCOME.JAMMED, REASON.LACK_OF_FORCE
