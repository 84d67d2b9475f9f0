"""Scenes: the contacts that a run models, and the events of their modes.

A run that reaches an undeclared contact leaves the scene and ends; it is never continued with
missing physics.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, get_args

from model.events.table import EVENTS, Table

ContactName = Literal["edge_on_face", "edge_on_side", "corner_on_flat", "corner_on_wall"]
CONTACT_NAMES: tuple[ContactName, ...] = get_args(ContactName)


@dataclass(frozen=True, repr=False)
class Scene:
    """A named set of declared contacts.

    Attributes:
        name: name of the scene.
        contacts: names of the declared contacts.
        events: table of events; that of the alignment scene by default.

    Raises:
        ValueError: a contact name that is not in ``CONTACT_NAMES``.
    """

    name: str
    contacts: frozenset[ContactName]
    events: Table = EVENTS

    def __post_init__(self) -> None:
        unknown = set(self.contacts) - set(CONTACT_NAMES)
        if unknown:
            raise ValueError(
                f"scene {self.name!r} declares unknown contacts {sorted(unknown)}: "
                f"valid are {', '.join(CONTACT_NAMES)}"
            )

    def __repr__(self) -> str:
        return f"<Scene: {self.name}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what copies and pickles are made of: the table of events goes by its name."""
        for name, table in _tables().items():
            if self.events is table:
                return _scene_of, (self.name, tuple(sorted(self.contacts)), name)
        raise TypeError(
            f"scene {self.name!r} has a table of events of its own, which cannot be copied or "
            "pickled: make the scene in each process"
        )

    @property
    def declared(self) -> "Declared":
        """The declared contacts in the form that kernels take."""
        return Declared(*(name in self.contacts for name in CONTACT_NAMES))


def _tables() -> dict[str, Table]:
    from model.events.insertion import TABLE  # noqa: PLC0415 - it builds upon this module

    return {"alignment": EVENTS, "insertion": TABLE}


def _scene_of(name: str, contacts: Sequence[ContactName], table: str) -> Scene:
    """Return a scene with the table of events of that name."""
    return Scene(name, frozenset(contacts), _tables()[table])


class Declared(NamedTuple):
    """Flags of the contacts that a scene declares."""

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
