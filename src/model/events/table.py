"""The table of events: all events that end a mode, with their event functions and transitions.

An event happens where its event function crosses zero downward; the value of an event function is
called its level. All code that works on events is generated from this table: sampling and event
location, closest approaches for the test of periodic steady state, and transitions
to the next mode or to the end of the run. To add a contact, add its law to the physics, and to the
table the events that begin it, end it and change its friction.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from model.compile.kernels import inlined_kernel
from model.events import event_functions as functions
from model.events import friction, sources, transitions
from model.physics.modes import CLOSED, OPEN, RELEASED, STICKING
from model.physics.motion import is_beside, is_supported, never_sticks
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

Kernel = Callable[..., Any]
OF_LENGTH, OF_LOAD, OF_FRICTION = range(3)  # how a level depends on the state
START_TOLERANCE = 1e-9  # of levels at the start, which may be zero to rounding
GROUPS = "support", "side", "right"  # of contacts: under the part, on its left, on its right
PLACES_OF_CONTACT = "edge", "corner", "side", "wall"  # kinds of contact: see physics/contacts.py


@dataclass(frozen=True)
class Source:
    """Source of the quantities that event functions take.

    Attributes:
        of: (time, q, p, mode) -> named quantities.
        exists: (p, mode) -> True if any event of this source may apply.
    """

    of: Kernel
    exists: Kernel


@dataclass(frozen=True, eq=False)  # compared by identity, so that tables hash fast
class Event:
    """One event: the end of a mode, its event function and its transition.

    Attributes:
        name: name of the event.
        source: source of the quantities.
        function: cases (applies, event function): where ``applies(p, mode)`` holds, the event
            happens at a down-crossing of ``event_function(quantities, p, mode)``. A function may
            return four quantities: its value is then the largest.
        transition: (time, q, p, mode, declared) -> (mode, outcome, reason).
        reset: (q, p, mode) -> initial state of the next mode; the state at the event by default.
        guard: (``CornerPositions``, p, mode) -> True if a down-crossing is the event; always by
            default.
        kind: how the level depends on the state: OF_LENGTH (also for a velocity), OF_LOAD or
            OF_FRICTION.
        force_on: if the level is a normal force, its group and place, of ``GROUPS`` and
            ``PLACES_OF_CONTACT``. Nothing reads it: it can go when ``make null`` is next due.
        start: level below which a start is impossible.
    """

    name: str
    source: Source
    function: tuple[tuple[Kernel, Kernel], ...]
    transition: Kernel
    reset: Kernel | None = None
    guard: Kernel | None = None
    kind: int = OF_LENGTH
    force_on: tuple[str, str] | None = None
    start: float | None = None


Table = tuple[Event, ...]

PLACES = Source(sources.places, sources.always)
FACE = Source(sources.face_state, sources.on_face)
SIDE = Source(sources.side_state, sources.on_left_side)
CORNER = Source(sources.corner_state, sources.on_corner)
FORCES = Source(sources.forces, sources.rubs)


# ----------------------------------------------------------------------------- where events apply


@inlined_kernel
def _no_face(edge, mode):
    return not (mode.edge == edge and mode.face != OPEN)


@inlined_kernel
def _no_corner(edge, mode):
    return not (mode.edge == edge and mode.corner != OPEN)


@inlined_kernel
def _falls_in(_p, mode):
    return _no_face(RIGHT_EDGE, mode) and not mode.dropped


@inlined_kernel
def _has_fallen_in(_p, mode):
    return _no_face(RIGHT_EDGE, mode) and mode.dropped


@inlined_kernel
def right_edge_is_free(_p, mode):
    """Return whether A1 is neither under the bottom face nor behind the right side face."""
    return _no_face(RIGHT_EDGE, mode)


@inlined_kernel
def left_edge_is_free(_p, mode):
    """Return whether A2 is neither under the bottom face nor behind the side face."""
    return _no_face(LEFT_EDGE, mode) and mode.side == OPEN


@inlined_kernel
def right_corner_is_free(_p, mode):
    """Return whether B1 does not press on the flat base."""
    return _no_corner(RIGHT_EDGE, mode)


@inlined_kernel
def left_corner_is_free(_p, mode):
    """Return whether B2 may come to press on the flat base.

    While A2 is behind the side face, B2 can be beside the slot only through the slot's wall.
    """
    return _no_corner(LEFT_EDGE, mode) and mode.side == OPEN


@inlined_kernel
def _right_corner_meets_wall(_p, mode):
    return _no_corner(RIGHT_EDGE, mode) and _no_face(RIGHT_EDGE, mode) and not mode.dropped


@inlined_kernel
def _left_corner_meets_wall(_p, mode):
    return _no_corner(LEFT_EDGE, mode) and _no_face(LEFT_EDGE, mode)


@inlined_kernel
def _support_sticks(p, mode):
    return is_supported(mode) and mode.support_slip == STICKING and not never_sticks(p)


@inlined_kernel
def _support_slides(p, mode):
    return is_supported(mode) and mode.support_slip != STICKING and not never_sticks(p)


@inlined_kernel
def _side_sticks(p, mode):
    return is_beside(mode) and mode.side_slip == STICKING and not never_sticks(p)


@inlined_kernel
def _side_slides(p, mode):
    return is_beside(mode) and mode.side_slip != STICKING and not never_sticks(p)


# ------------------------------------------------------------------------------------------- guards


@inlined_kernel
def _corner_first(edge, at, p, mode):
    """Return whether a corner has met the wall before its part has met the edge.

    A part that is flat, to ``FLAT``, meets both together: then the edge carries it.
    """
    _, place = functions.largest(functions.corner_off_wall(edge, at, p, mode))
    outside = functions.tips_outside if p.is_round else functions.edge_outside
    gap, _ = functions.largest(outside(edge, at, p, mode))
    return place == 0.0 or gap > functions.ON_AN_EVENT + 2.0 * functions.FLAT * p.half_width


_right_corner_first, _left_corner_first = sources.on_both_sides(_corner_first)


# ----------------------------------------------------------------------------- events of a contact


def state_is(field: str, state: int, in_slot: bool | None = None, negated: bool = False) -> Kernel:
    """Make the kernel (p, mode): True if the contact ``field`` is in ``state``, or ``negated``.

    With ``in_slot``, only if the support is, or is not, the right side of the slot.
    """

    @inlined_kernel
    def applies(_p, mode):
        here = getattr(mode, field) != state if negated else getattr(mode, field) == state
        return here and (in_slot is None or mode.in_slot == in_slot)

    return applies


def of_contact(
    name: str,
    field: str,
    source: Source,
    transition: transitions.OfContact,
    force_on: tuple[str, str],
    in_slot: bool | None = None,
) -> Table:
    """Make the events of a contact that overlaps the base: load lost, gap opened, load returned.

    ``field`` of the mode holds its normal state. See ``Event`` and, for ``in_slot``, ``state_is``.
    """
    presses, is_released = (state_is(field, state, in_slot) for state in (CLOSED, RELEASED))
    return (
        Event(
            f"{name}_load", source, ((presses, functions.load),), transition.unloaded, kind=OF_LOAD,
            force_on=force_on,
        ),
        Event(f"{name}_gap", source, ((is_released, functions.depth),), transition.opens),
        Event(
            f"{name}_reload", source, ((is_released, functions.missing_load),), transition.reloaded,
            kind=OF_LOAD,
        ),
    )  # fmt: skip


# ---------------------------------------------------------------------------------------- the table

# Conditions on several quantities: the event function is the largest of them.
CONDITIONS: Table = (
    # In flight: A1 beyond B1, B2 inside the slot.
    Event("aligned", PLACES, ((_falls_in, functions.not_fallen_in),), transitions.fallen_in),
    # The paper's four corner conditions.
    Event(
        "corners_inside", PLACES, ((_has_fallen_in, functions.corners_outside),), transitions.inside
    ),
    # An edge enters the part.
    Event(
        "right_edge_enters", PLACES, ((right_edge_is_free, functions.right_edge_outside),),
        transitions.right_edge_enters,
    ),
    Event(
        "left_edge_enters", PLACES, ((left_edge_is_free, functions.left_edge_outside),),
        transitions.left_edge_enters, start=-START_TOLERANCE,
    ),
    # A bottom corner presses on the flat base.
    Event(
        "right_corner_lands", PLACES, ((right_corner_is_free, functions.right_corner_above),),
        transitions.right_corner_lands,
    ),
    Event(
        "left_corner_lands", PLACES, ((left_corner_is_free, functions.left_corner_above),),
        transitions.left_corner_lands,
    ),
    # A bottom corner meets the slot's wall from inside.
    Event(
        "right_wall", PLACES, ((_right_corner_meets_wall, functions.right_corner_off_wall),),
        transitions.right_wall, guard=_right_corner_first,
    ),
    Event(
        "left_wall", PLACES, ((_left_corner_meets_wall, functions.left_corner_off_wall),),
        transitions.left_wall, guard=_left_corner_first, start=-START_TOLERANCE,
    ),
)  # fmt: skip

CONTACTS: Table = (
    # The edge under the bottom face loses its load; the gap opens; the load returns before the gap
    # opens; the edge passes the corner on its own side, toward the slot, or the other one.
    *of_contact("face", "face", FACE, transitions.FACE, ("support", "edge"), in_slot=False),
    Event(
        "face_end", FACE, ((sources.on_face, functions.before_face_end),), transitions.face_ends
    ),
    Event(
        "face_far_end", FACE, ((sources.on_face, functions.before_far_end),), transitions.far_end,
        start=-START_TOLERANCE,
    ),
    # The same for A2 on the left side face; A2 passes an end of the face.
    *of_contact("side", "side", SIDE, transitions.SIDE, ("side", "side")),
    Event(
        "side_end", SIDE, ((sources.on_left_side, functions.before_side_end),),
        transitions.side_ends,
    ),
    # The same for a bottom corner on the flat base; the corner slides into the slot.
    *of_contact(
        "corner", "corner", CORNER, transitions.CORNER, ("support", "corner"), in_slot=False
    ),
    Event(
        "corner_end", CORNER, ((sources.on_corner, functions.beside_slot),),
        transitions.corner_slides_in,
    ),
    # Slip reaches zero, or the friction force reaches its limit.
    Event(
        "support_slip", FORCES,
        ((_support_sticks, functions.support_reserve), (_support_slides, functions.support_slip)),
        transitions.support_turns, reset=friction.at_rest_on_support, kind=OF_FRICTION,
    ),
    Event(
        "side_slip", FORCES,
        ((_side_sticks, functions.side_reserve), (_side_slides, functions.side_slip)),
        transitions.side_turns, reset=friction.at_rest_on_side, kind=OF_FRICTION,
    ),
    Event(
        "overturned", PLACES, ((sources.always, functions.upright),), transitions.overturned,
        start=0.0,
    ),
)  # fmt: skip

EVENTS = CONDITIONS + CONTACTS
"""The events of the alignment scene; conditions come first."""


def changed(table: Table, name: str, **changes: Any) -> Table:
    """Return the table with changed attributes of the event ``name``."""
    return tuple(replace(each, **changes) if each.name == name else each for each in table)


def number_of(name: str, table: Table = EVENTS) -> int:
    """Return the number of an event: its index in the table.

    Raises:
        ValueError: the table has no event of that name.
    """
    return [each.name for each in table].index(name)


def __getattr__(name: str) -> int:
    """Return the number of an event of the alignment scene, by its name in capitals."""
    if name.isupper() and name.lower() in (each.name for each in EVENTS):
        return number_of(name.lower())
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
