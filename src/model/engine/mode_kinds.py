"""The modes of a run, and their kinds: modes of a kind have the same series.

The engine begins here. Input: the fields of ``Mode``. Output: the kinds of modes, for which
series.py derives series; all modes, for which lane_events.py selects events; and kernels that
number the mode of a run. For lanes to hold a further contact, add its modes here.
"""

from collections.abc import Iterable, Sequence
from functools import cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.compile.kernels import inlined_kernel
from model.physics.modes import CLOSED, OPEN, RELEASED, SLIP_POSITIVE, START, STICKING, Mode
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

_STATES, _SLIPS = (OPEN, CLOSED, RELEASED), (STICKING, SLIP_POSITIVE)
# Stages of a fall: ``dropped``, ``in_slot``, ``corners_inside``; without insertion, the first two.
_FALLS = (
    (False, False, False), (True, False, False), (True, True, False), (True, False, True),
    (True, True, True),
)  # fmt: skip

# Where the support is: A1 or A2 under the bottom face, or A1 and B1 on the right side of the slot.
ON_RIGHT_EDGE, ON_LEFT_EDGE, BETWEEN_WALLS = range(3)
FREE, SLIDES, STICKS = range(3)  # states of an edge alone; see ``SIDE_CONTACTS``


class SideContacts(NamedTuple):
    """Contacts that press on one side, the one whose slip counts, and whether it sticks."""

    edge: bool
    corner: bool
    slip_at_corner: bool
    sticks: bool


_WHERE = (True, False, False), (False, True, True), (True, True, False), (True, True, True)
SIDE_CONTACTS = (
    SideContacts(False, False, False, False),
    *(SideContacts(*where, sticks) for where in _WHERE for sticks in (False, True)),
)
"""Every ``SideContacts`` that occurs, numbered by its index; FREE where nothing presses."""


class ModeKind(NamedTuple):
    """A kind of mode: position of the support, and ``SIDE_CONTACTS`` of both sides, by number."""

    position: int
    support: int
    side: int


# Numbers of ``SIDE_CONTACTS``: an edge alone or none, a corner alone, both.
_EDGE, _CORNER, _BOTH = (FREE, SLIDES, STICKS), (3, 4), (5, 6, 7, 8)


def _kinds(positions: Iterable[int], *sides: Iterable[int]) -> tuple[ModeKind, ...]:
    return tuple(ModeKind(*each) for each in product(positions, *sides))


_CORNERS = _CORNER + _BOTH
_ALL = _EDGE + _CORNERS
ALIGNMENT_KINDS = (
    *_kinds((ON_RIGHT_EDGE,), _EDGE, _EDGE),
    *_kinds((ON_LEFT_EDGE,), _EDGE, (FREE,)),
    *_kinds((ON_RIGHT_EDGE, ON_LEFT_EDGE), _CORNERS, (FREE,)),
)
USUAL_KINDS = (
    *ALIGNMENT_KINDS,
    *_kinds((BETWEEN_WALLS,), _ALL, _EDGE),
    *_kinds((BETWEEN_WALLS,), _EDGE, _CORNER),
    *_kinds((ON_RIGHT_EDGE, BETWEEN_WALLS), (FREE,), _CORNERS),
)
"""Kinds that a page holds; others occur in some of 10,000 random sets."""


def kinds_of(inserts: bool) -> tuple[ModeKind, ...]:
    """Return all kinds of modes, the usual ones first, in a scene that ``inserts`` or not."""
    usual = USUAL_KINDS if inserts else ALIGNMENT_KINDS
    positions = range(3 if inserts else 2)
    return tuple(dict.fromkeys((*usual, *_kinds(positions, _ALL, _ALL if inserts else _EDGE))))


def mode_of_kind(kind: ModeKind, slips: Sequence[Any], corner_offset: Any) -> Mode:
    """Return a mode of this kind, with the ``slips`` of support and side where those slide."""
    support, side = SIDE_CONTACTS[kind.support], SIDE_CONTACTS[kind.side]
    support_slip, side_slip = (
        STICKING if each.sticks or not (each.edge or each.corner) else slip
        for each, slip in zip((support, side), slips, strict=True)
    )
    return START._replace(
        edge=LEFT_EDGE if kind.position == ON_LEFT_EDGE else RIGHT_EDGE,
        in_slot=kind.position == BETWEEN_WALLS,
        face=CLOSED if support.edge else OPEN, corner=CLOSED if support.corner else OPEN,
        corner_offset=corner_offset,
        slip_at_corner=support.slip_at_corner, support_slip=support_slip,
        side=CLOSED if side.edge else OPEN, wall=CLOSED if side.corner else OPEN,
        slip_at_wall=side.slip_at_corner, side_slip=side_slip,
    )  # fmt: skip


def numbers_of(kinds: Sequence[ModeKind]) -> NDArray[np.int64]:
    """Return the table [position, support, side] of indices in ``kinds``; -1 if one is not."""
    numbers = np.full((3, len(SIDE_CONTACTS), len(SIDE_CONTACTS)), -1)
    for number, kind in enumerate(kinds):
        numbers[kind] = number
    return numbers


@inlined_kernel
def _side_contacts(edge, corner, slip_at_corner, slip):
    """Return the number of the contacts that press on one side; see ``SIDE_CONTACTS``."""
    where = 0
    if corner == CLOSED:
        where = 2 + int(slip_at_corner) if edge == CLOSED else 1
    presses = edge == CLOSED or corner == CLOSED
    return 1 + 2 * where + int(slip == STICKING) if presses else FREE


@inlined_kernel
def kind_in(numbers, mode):
    """Return the number of the kind of a mode, -1 if it is not held; see ``numbers_of``."""
    position = ON_RIGHT_EDGE
    if mode.in_slot:
        position = BETWEEN_WALLS
    elif mode.edge == LEFT_EDGE and (mode.face != OPEN or mode.corner != OPEN):
        position = ON_LEFT_EDGE
    support = _side_contacts(mode.face, mode.corner, mode.slip_at_corner, mode.support_slip)
    side = _side_contacts(mode.side, mode.wall, mode.slip_at_wall, mode.side_slip)
    return numbers[position, support, side]


MODES_OF_A_KIND = 64  # numbers of ``mode_in_kind``


@inlined_kernel
def mode_in_kind(mode):
    """Return the number of a mode in its kind, by released contacts and the stage of its fall."""
    right = int(mode.face == RELEASED) + 2 * int(mode.corner == RELEASED)
    left = int(mode.side == RELEASED) + 2 * int(mode.wall == RELEASED)
    return right + 4 * left + 16 * int(mode.dropped) + 32 * int(mode.corners_inside)


@cache
def lane_modes(inserts: bool, kinds: tuple[ModeKind, ...]) -> list[tuple[Mode, tuple[int, int]]]:
    """Enumerate every mode of these ``kinds``, with slips of one sign: no event depends on it.

    With each its key: the number of its kind, and its number in the kind.
    """
    within = _STATES if inserts else (OPEN,)
    modes = [
        START._replace(
            edge=edge, face=face, corner=corner, side=side, wall=wall, support_slip=slip,
            side_slip=side_slip, slip_at_corner=at_corner, slip_at_wall=at_wall,
            dropped=dropped, in_slot=in_slot, corners_inside=inside,
        )
        for edge, face, corner, side, wall in product(
            (RIGHT_EDGE, LEFT_EDGE), _STATES, _STATES, _STATES, within
        )
        for at_corner in {corner == CLOSED, CLOSED == corner != face}
        for at_wall in {wall == CLOSED, CLOSED == wall != side}
        for slip in _SLIPS[: 2 if CLOSED in (face, corner) else 1]
        for side_slip in _SLIPS[: 2 if CLOSED in (side, wall) else 1]
        for dropped, in_slot, inside in (_FALLS if inserts else _FALLS[:2])
        if edge == RIGHT_EDGE or not in_slot  # A1 and B1 are the right side of the slot
    ]  # fmt: skip
    numbers = numbers_of(kinds)
    keys = ((int(kind_in(numbers, mode)), mode_in_kind(mode)) for mode in modes)
    return [each for each in zip(modes, keys, strict=True) if each[1][0] >= 0]
