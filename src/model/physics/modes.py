"""Modes: the state of every contact, and changes of several of its fields at once."""

from typing import Any, NamedTuple

from model.compile.kernels import inlined_kernel
from model.physics.notation import RIGHT_EDGE

# Normal state of a contact. RELEASED: the bodies overlap, but the base would have to pull: n = 0.
OPEN, CLOSED, RELEASED = 0, 1, 2

# Friction state: sign of the slip, or STICKING.
SLIP_NEGATIVE, STICKING, SLIP_POSITIVE = -1, 0, 1


class Mode(NamedTuple):
    """State of every contact, which selects one smooth vector field.

    Contacts are grouped in two, the *support* and the *side*; those of a group share one friction
    state. The support is an edge on the bottom face and its corner on the flat base or, in the
    slot, the right side: A1 on the right side face, B1 on the right wall. The side is the left one:
    A2 on the left side face, B2 on the left wall. The slot is wider than the part, so only one edge
    at a time carries the bottom face: ``edge``, which keeps its value after lift-off.

    Attributes:
        edge: RIGHT_EDGE or LEFT_EDGE, the side on which the part is supported.
        face: normal state of that edge on the bottom face; ``in_slot``, of A1 on the right side
            face.
        corner: normal state of that side's bottom corner on the flat base; ``in_slot``, of B1 on
            the right wall.
        corner_offset: depth of the corner when it began to press. It differs from 0 only if the
            tilt changed sign while the edge pressed: the base is then deformed at the corner too.
        slip_at_corner: True if the corner's slip decides the friction of both, else the edge's. It
            changes only when the deciding contact stops pressing, so that friction stays continuous
            while the other one opens and closes.
        support_slip: friction state of edge and corner.
        side: normal state of A2 on the left side face.
        side_slip: friction state of A2 and B2 on the left side.
        dropped: True after the part lost the edge past its corner B1 and falls into the slot.
        in_slot: True if the support is the right side of the slot; never in the alignment scene.
        wall: normal state of B2 on the left wall.
        slip_at_wall: as ``slip_at_corner``, for B2 and A2 on the left side.
        corners_inside: True once all four corner conditions have held.
    """

    edge: float
    face: int
    corner: int
    corner_offset: float
    slip_at_corner: bool
    support_slip: int
    side: int
    side_slip: int
    dropped: bool
    in_slot: bool = False
    wall: int = OPEN
    slip_at_wall: bool = False
    corners_inside: bool = False


MODE_KINDS: tuple[Any, ...] = tuple(Mode.__annotations__.values())
"""Types of the fields of a mode: records hold them all as floats."""

START = Mode(RIGHT_EDGE, CLOSED, OPEN, 0.0, False, STICKING, OPEN, STICKING, False)
"""At rest with the bottom face touching A1."""


@inlined_kernel
def with_support_opened(mode, in_slot):
    """Return the mode with an open support, on the right side of the slot or on its edges."""
    return mode._replace(face=OPEN, corner=OPEN, in_slot=in_slot)


@inlined_kernel
def with_drop(mode):
    """Return the mode after the part has lost the edge past its corner B1."""
    return mode._replace(face=OPEN, dropped=True)


@inlined_kernel
def with_friction(mode, support_slip, side_slip):
    """Return the mode with other friction states."""
    return mode._replace(support_slip=support_slip, side_slip=side_slip)


@inlined_kernel
def with_slip_place(mode):
    """Return the mode with slips decided by contacts that press: the same ones if possible."""
    return mode._replace(
        slip_at_corner=mode.corner == CLOSED and (mode.slip_at_corner or mode.face != CLOSED),
        slip_at_wall=mode.wall == CLOSED and (mode.slip_at_wall or mode.side != CLOSED),
    )
