"""Kernels on the events of a table: levels, guards, resets and transitions.

A loop over the events of a table, which is known when a kernel is compiled, becomes a line of code
for each event, in which the event's own functions are called.
"""

from dataclasses import dataclass
from functools import cache
from itertools import groupby
from typing import Any, NamedTuple

from model.compile.kernels import Symbol, inlined_kernel, kernel, separate_kernel
from model.events import sources
from model.events.event_functions import NEVER, largest
from model.events.round_parts import RIGHT_TIPS, with_tips
from model.events.scenes import Declared, Scene
from model.events.table import OF_LENGTH, Event, Source, Table
from model.physics.modes import START
from model.physics.parameters import Constants, RoundConstants

MOST_EVENTS = 44  # capacity of records and histories


@dataclass(frozen=True, eq=False)
class Numbered:
    """An event of a table: its number, its index there.

    Attributes:
        number: index in the table.
        event: the event.
        is_combined: True if it has several quantities.
    """

    number: int
    event: Event
    is_combined: bool


@dataclass(frozen=True, eq=False)
class Events:
    """The events of a table, as kernels loop over them.

    Attributes:
        all: every event, in the order of the table.
        combined: count of the events with several quantities; these come first.
        in_order: neighbours in the table that share a source.
        corners_inside: number of "corners_inside"; face_end: of "face_end".
        inserts: True if runs continue after alignment until the part is inserted.
        constants: class of the constants: ``RoundConstants`` for a round part.
    """

    all: tuple[Numbered, ...]
    combined: int
    in_order: tuple[tuple[Source, tuple[Numbered, ...]], ...]
    corners_inside: int
    face_end: int
    inserts: bool
    constants: type[Constants]

    @property
    def count(self) -> int:
        """Number of events."""
        return len(self.all)

    def with_a(self, part: str) -> tuple[Numbered, ...]:
        """Return the events whose attribute ``part`` is stated."""
        return tuple(each for each in self.all if getattr(each.event, part) is not None)


class SceneEvents(NamedTuple):
    """A scene in the form that kernels take: its declared contacts and its events."""

    declared: Declared
    events: Events


class _Any(Symbol):
    """Symbol for any number, where only the type of a result matters."""

    def _same(self, _other: Any = None) -> "_Any":
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __neg__ = __abs__ = _same


_ANY: Any = _Any()
_ANY_PLACES = sources.CornerPositions(*[_ANY] * len(sources.CornerPositions._fields))


def _is_combined(event: Event) -> bool:
    """Return whether the event function is the largest of several quantities."""
    if event.source.of is not sources.places:
        return False
    p = Constants(*[_ANY] * len(Constants._fields))
    return isinstance(event.function[0][1](_ANY_PLACES, p, START), tuple)


def combined_count(table: Table) -> int:
    """Return the number of events with several quantities; these come first.

    Raises:
        ValueError: such an event comes after another one, or there are too many events.
    """
    combined = [_is_combined(event) for event in table]
    if combined != sorted(combined, reverse=True):
        raise ValueError("a table of events must begin with all events of several quantities")
    if len(table) > MOST_EVENTS:
        raise ValueError(f"{len(table)} events: a table may have at most {MOST_EVENTS}")
    return sum(combined)


@cache
def events_of(table: Table) -> Events:
    """Return the events of a table as kernels take them."""
    combined, names = combined_count(table), [each.name for each in table]
    numbered = tuple(Numbered(k, event, k < combined) for k, event in enumerate(table))
    neighbours = groupby(numbered, key=lambda each: each.event.source)
    return Events(
        all=numbered,
        combined=combined,
        in_order=tuple((source, tuple(members)) for source, members in neighbours),
        corners_inside=names.index("corners_inside"),
        face_end=names.index("face_end"),
        inserts="inserted" in names,
        constants=RoundConstants if RIGHT_TIPS in names else Constants,
    )


def in_kernels(scene: Scene, is_round: bool = False) -> SceneEvents:
    """Return the scene, of plane or of round parts, in the form that kernels take."""
    table = with_tips(scene.events) if is_round else scene.events
    return SceneEvents(scene.declared, events_of(table))


# ------------------------------------------------------------------------------------------- levels


@inlined_kernel
def _level_at(each, at, p, mode):
    """Return the level of an event that applies, from the quantities of its source."""
    for applies, function in each.event.function[:-1]:
        if applies(p, mode):
            return function(at, p, mode)
    found = each.event.function[-1][1](at, p, mode)
    return largest(found)[0] if each.is_combined else found


@separate_kernel
def level(events, which, time, q, p, mode):
    """Return the level of the event ``which``, which applies."""
    for source, members in events.in_order:
        if members[0].number <= which <= members[-1].number:
            at = source.of(time, q, p, mode)
            for each in members:
                if which == each.number:
                    return _level_at(each, at, p, mode)
    return NEVER


@kernel
def start_is_impossible(events, q, p, mode):
    """Return whether a level that limits the start is below its limit."""
    for each in events.with_a("start"):
        for applies, _ in each.event.function:
            exists = each.event.source.exists(p, mode) and applies(p, mode)
            if exists and level(events, each.number, 0.0, q, p, mode) < each.event.start:
                return True
    return False


# --------------------------------------------------------------------------- single events at work


@inlined_kernel
def is_conditional(events, which):
    """Return whether ``guard`` may refuse a down-crossing of the event ``which``."""
    return any(which == each.number for each in events.with_a("guard"))


@inlined_kernel
def guard(events, which, q, p, mode):
    """Return whether a down-crossing of the level is the event ``which``."""
    at = sources.corner_positions(q, p)
    for each in events.with_a("guard"):
        if which == each.number:
            return each.event.guard(at, p, mode)
    return True


@inlined_kernel
def reset(events, which, q, p, mode):
    """Return the state with which the next mode begins after the event ``which``."""
    for each in events.with_a("reset"):
        if which == each.number:
            return each.event.reset(q, p, mode)
    return q


@inlined_kernel
def transition(events, which, time, q, p, mode, declared):
    """Return (next mode, outcome, reason) after the event ``which``; see ``Event``."""
    for each in events.all[:-1]:
        if which == each.number:
            return each.event.transition(time, q, p, mode, declared)
    return events.all[-1].event.transition(time, q, p, mode, declared)


@inlined_kernel
def kind_of(events, which):
    """Return how the level of the event ``which`` depends on the state: see ``Event.kind``."""
    for each in events.all:
        if which == each.number:
            return each.event.kind
    return OF_LENGTH
