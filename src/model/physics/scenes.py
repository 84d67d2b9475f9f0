"""Scenes and modes: the contacts that a run models, and the state of each of them.

A run that reaches an undeclared contact leaves the scene and ends; it is never continued with
missing physics.
"""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, get_args

from model.physics.notation import RIGHT_EDGE

ContactName = Literal["edge_on_face", "edge_on_side", "corner_on_flat", "corner_on_wall"]
CONTACT_NAMES: tuple[ContactName, ...] = get_args(ContactName)


@dataclass(frozen=True)
class Scene:
    """A named set of declared contacts.

    Attributes:
        name: name of the scene.
        contacts: names of the declared contacts.
        events: table of events (model.events.table); None for the table of the alignment scene.

    Raises:
        ValueError: a contact name that is not in ``CONTACT_NAMES``.
    """

    name: str
    contacts: frozenset[ContactName]
    events: tuple[Any, ...] | None = None

    def __post_init__(self) -> None:
        unknown = set(self.contacts) - set(CONTACT_NAMES)
        if unknown:
            raise ValueError(
                f"scene {self.name!r} declares unknown contacts {sorted(unknown)}: "
                f"valid are {', '.join(CONTACT_NAMES)}"
            )

    @property
    def declared(self) -> "Declared":
        """The declared contacts in the form that kernels take."""
        return Declared(*(name in self.contacts for name in CONTACT_NAMES))


class Declared(NamedTuple):
    """Flags of the kinds of contact that a scene declares."""

    edge_on_face: bool
    edge_on_side: bool
    corner_on_flat: bool
    corner_on_wall: bool


ALIGNMENT = Scene("alignment", frozenset(CONTACT_NAMES) - {"corner_on_wall"})
"""The paper's scene completed: edges on bottom and side face, bottom corners on the flat base."""

PRINTED_CONTACTS = Scene("printed_contacts", frozenset({"edge_on_face", "edge_on_side"}))
"""The contacts with equations in the paper: A1 on the bottom face and A2 on the side face."""

SUSPENDED = Scene("suspended", frozenset())
"""No contact: the part on its springs."""

# Normal state of a contact. RELEASED: the bodies overlap, but the base would have to pull: n = 0.
OPEN, CLOSED, RELEASED = 0, 1, 2

# Friction state: sign of the slip, or STICKING.
SLIP_NEGATIVE, STICKING, SLIP_POSITIVE = -1, 0, 1


class Mode(NamedTuple):
    """State of every contact, which selects one smooth vector field.

    Contacts on the same side share one friction state. The contacts of two sides press at most: the
    ``support`` and the ``side``. The side is the left one: A2 on the left side face, B2 on the left
    wall. The support is an edge on the bottom face and its corner on the flat base or, in the slot,
    the right side: A1 on the right side face, B1 on the right wall. The slot is wider than the
    part, so only one edge at a time carries the bottom face: ``edge``, which keeps the last one
    after lift-off.

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
        slip_at_wall: ``slip_at_corner`` of the left side.
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


START = Mode(RIGHT_EDGE, CLOSED, OPEN, 0.0, False, STICKING, OPEN, STICKING, False)
"""At rest with the bottom face touching A1."""
