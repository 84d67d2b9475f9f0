"""What a run models: the contacts a scene declares, and the mode each of them is in.

A run that reaches a contact its scene does not declare leaves the scene; it is never integrated on
with physics that is missing.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

from model.physics.notation import RIGHT_EDGE

ContactName = Literal["edge_on_face", "edge_on_side", "corner_on_flat"]
CONTACT_NAMES: tuple[ContactName, ...] = get_args(ContactName)


@dataclass(frozen=True)
class Scene:
    """A named set of declared contacts.

    Raises:
        ValueError: a contact name that is not in ``CONTACT_NAMES``.
    """

    name: str
    contacts: frozenset[ContactName]

    def __post_init__(self) -> None:
        unknown = set(self.contacts) - set(CONTACT_NAMES)
        if unknown:
            raise ValueError(
                f"scene {self.name!r} declares unknown contacts {sorted(unknown)}: "
                f"valid are {', '.join(CONTACT_NAMES)}"
            )

    @property
    def declared(self) -> "Declared":
        """The form that kernels take."""
        return Declared(*(name in self.contacts for name in CONTACT_NAMES))


class Declared(NamedTuple):
    """Which kinds of contact a scene declares."""

    edge_on_face: bool
    edge_on_side: bool
    corner_on_flat: bool


ALIGNMENT = Scene("alignment", frozenset(CONTACT_NAMES))
"""The paper's scene, completed: edges on bottom and side face, bottom corners on the flat base."""

PRINTED_CONTACTS = Scene("printed_contacts", frozenset({"edge_on_face", "edge_on_side"}))
"""Only what the paper writes down: A1 on the bottom face and A2 on the side face."""

SUSPENDED = Scene("suspended", frozenset())
"""No contact at all: the part on its springs."""

# Normal state of a contact. RELEASED: the bodies overlap but the base would have to pull (n = 0).
OPEN, CLOSED, RELEASED = 0, 1, 2

# Friction state: sign of the slip, or STICKING.
SLIP_NEGATIVE, STICKING, SLIP_POSITIVE = -1, 0, 1


class Mode(NamedTuple):
    """Which smooth vector field holds. Contacts on the same side share one friction state.

    The two edges cannot carry the bottom face at the same time, since the slot is wider than the
    part; ``edge`` says which one does, or last did.

    Attributes:
        edge: RIGHT_EDGE or LEFT_EDGE, the side on which the part is supported.
        face: normal state of that edge on the bottom face.
        corner: normal state of that side's bottom corner on the flat base.
        corner_offset: how deep the corner stood when it began to press. Not 0 only where the tilt
            changed sign while the edge pressed: the base is then already down at the corner too.
        slip_at_corner: whether the corner's slip counts for both, else the edge's; it changes only
            when the one that counts no longer presses, so that friction is continuous as the other
            comes and goes.
        support_slip: friction state of edge and corner.
        side: normal state of A2 on the left side face.
        side_slip: friction state of A2 on the left side face.
        dropped: the contact has been lost past the corner B1, the part falls into the slot.
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


START = Mode(RIGHT_EDGE, CLOSED, OPEN, 0.0, False, STICKING, OPEN, STICKING, False)
"""At rest with the bottom face touching A1."""
