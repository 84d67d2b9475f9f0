"""Events in the lanes of the batch engine: which apply, their levels, and kernels that loop over them.

Input: an event table. Output: its ``LaneEvents``, for step.py, event_search.py and scheduling.py.
LLVM vectorizes a loop over lanes if every level is written out, with places that are known: the
loops over events run when a kernel is compiled. Events that apply in no mode of the lanes are left
out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.compile.identity import identity_of
from model.compile.kernels import inlined_kernel, kernel
from model.compile.vector_code import WIDTH
from model.engines.batch.levels import Level, bound_in, coefficient_in, level_in, levels_of
from model.engines.batch.mode_kinds import (
    MODES_OF_A_KIND,
    ModeKind,
    kind_in,
    kinds_of,
    lane_modes,
    mode_in_kind,
    numbers_of,
)
from model.engines.batch.series import SYMBOLS, EventQuantities
from model.engines.batch.series_kernels import Series
from model.engines.batch.series_layout import FRACTIONS, LINES, NODES, ORDER, SINES
from model.engines.batch.workspace import (
    COEFFICIENTS,
    EVENT_LINES,
    LENGTH,
    VALUES,
    VARIED,
    VARIED_IN_SLOT,
    constants_of_lane,
    mode_of_lane,
)
from model.events.event_functions import NEVER
from model.events.kernels import Events, Numbered, events_of
from model.events.table import Table

TERMS = ORDER + 1  # of the series of each quantity
# The largest distance from a line through samples at a step's quarters, over the bound of |g''|.
CURVATURE = FRACTIONS[0] ** 2 / 8.0
_LEAST_EVENTS = 8  # in a loop over lanes: the compiler unrolls short ones and leaves them scalar
_CORNERS = "corner_load", "wall_load"  # the last quantities, of the insertion scene

# Constants with which every level applies that needs friction.
_ROUGH = SYMBOLS._replace(friction=1.0)


@dataclass(frozen=True, eq=False)
class Case:
    """Case of a level: ``applies`` (p, mode) -> bool, and its quantities."""

    applies: Any
    levels: tuple[Level, ...]


@dataclass(frozen=True, eq=False)
class LaneEvent:
    """Event that has a level in some mode of the lanes.

    Attributes:
        number: index in the event table.
        cases: cases of its level.
        is_combined: True if it has several quantities.
        is_partial: True if lanes lack one of them: the reference engine then decides.
    """

    number: int
    cases: tuple[Case, ...]
    is_combined: bool
    is_partial: bool


@dataclass(frozen=True, eq=False)
class LaneEvents:
    """The events of a table, and the series of its modes, as the kernels of lanes take them.

    Attributes:
        events: the whole table.
        combined, singles: events of several quantities, and of one, that apply in lanes.
        loops: the singles, as many as one loop over lanes takes, with the mask of their numbers.
        masks: events that may apply, by kind of mode and number of the mode in its kind.
        kinds: numbers of the kinds of modes; see ``numbers_of``.
        varied: fields of ``Mode`` that lanes hold.
        series: functions that fill and sample the series of each kind of mode.
    """

    events: Events
    combined: tuple[LaneEvent, ...]
    singles: tuple[LaneEvent, ...]
    loops: tuple[tuple[int, tuple[LaneEvent, ...]], ...]
    masks: NDArray[np.int64]
    kinds: NDArray[np.int64]
    varied: tuple[int, ...]
    series: Series

    @property
    def identity(self) -> str:
        """What code for lanes depends on."""
        return f"lanes of {identity_of(self.events)}, {self.series.identity}"

    @property
    def samples(self) -> int:
        """First line of the levels at the nodes."""
        return EVENT_LINES

    @property
    def bounds(self) -> int:
        """First line of the curvature bounds of levels."""
        return self.samples + NODES * self.events.count

    @property
    def subintervals(self) -> int:
        """First line of the masks of subintervals that may contain a down-crossing."""
        return self.bounds + self.events.count

    @property
    def lines(self) -> int:
        """Number of lines of the workspace."""
        return self.subintervals + self.events.count

    @property
    def all(self) -> tuple[LaneEvent, ...]:
        """Every event that applies in lanes."""
        return self.combined + self.singles


def _in_lanes(numbered: Numbered, events: Events) -> tuple[LaneEvent, set[tuple[int, int]]]:
    """Return an event as lanes have it, and the places of the modes in which it applies."""
    cases, places, event = [], set(), numbered.event
    for applies, function in event.function:
        here = {place for mode, place in lane_modes(events.inserts) if applies(_ROUGH, mode)}
        if not here:
            continue
        levels = levels_of(event.source, function, events.inserts)
        if levels is None:
            raise ValueError(f"{event.name}: lanes hold its modes, but not its quantities")
        cases.append(Case(applies, levels))
        places |= here
    is_partial = any(not level.is_known for case in cases for level in case.levels)
    found = LaneEvent(numbered.number, tuple(cases), numbered.is_combined, is_partial)
    return found, places


def _loops(singles: Sequence[LaneEvent]) -> tuple[tuple[int, tuple[LaneEvent, ...]], ...]:
    size = -(-len(singles) // max(1, len(singles) // _LEAST_EVENTS))
    loops = (tuple(singles[n : n + size]) for n in range(0, len(singles), size))
    return tuple((sum(1 << each.number for each in loop), loop) for loop in loops)


@cache
def lane_events_of(table: Table) -> LaneEvents:
    """Return the events of a table as the kernels of lanes take them.

    Raises:
        ValueError: an event applies in a mode that lanes hold, but they lack its quantities.
    """
    events = events_of(table)
    kinds = kinds_of(events.inserts)
    masks, found = np.zeros((len(kinds), MODES_OF_A_KIND), np.int64), []
    for numbered in events.all:
        each, places = _in_lanes(numbered, events)
        for place in places:
            masks[place] |= 1 << each.number
        found += [each] if each.cases else []
    singles = tuple(each for each in found if not each.is_combined)
    quantities = EventQuantities._fields
    count = len(quantities) - (0 if events.inserts else len(_CORNERS))
    return LaneEvents(
        events=events,
        combined=tuple(each for each in found if each.is_combined),
        singles=singles,
        loops=_loops(singles),
        masks=masks,
        kinds=numbers_of(kinds),
        varied=VARIED_IN_SLOT if events.inserts else VARIED,
        series=Series(kinds, events.inserts, count),
    )


def nodes_of(lanes: LaneEvents) -> list[tuple[int, int]]:
    """Return for each node the first line of its quantities, and of its levels."""
    count = lanes.events.count
    return [(VALUES + n * SINES, lanes.samples + n * count) for n in range(NODES)]


# ------------------------------------------------------------------------------------------ kernels


@inlined_kernel
def kind_of(lanes, mode):
    """Return the number of the kind of a mode, -1 if lanes cannot hold it."""
    return kind_in(lanes.kinds, mode)


@inlined_kernel
def applicable_in(lanes, kind, mode):
    """Return the mask of the events that may apply in a mode of this kind."""
    return lanes.masks[kind, mode_in_kind(mode)]


@inlined_kernel
def _sample(lanes, loop, first, sample, w):
    """Write levels of one quantity at a node, of the events of a ``loop``."""
    for i in range(WIDTH):
        p, mode = constants_of_lane(w, i), mode_of_lane(lanes, w, i)
        for event in loop:
            found = NEVER
            for case in reversed(event.cases):
                here = level_in(case.levels[0], first, w, i)
                found = np.where(case.applies(p, mode), here, found)
            w[(sample + event.number) * WIDTH + i] = found


@kernel
def sample_lanes(lanes, applicable, w):
    """Write the levels of one quantity at every node, of the events in the mask ``applicable``."""
    for mask, loop in lanes.loops:
        if applicable & mask != 0:
            for first, sample in nodes_of(lanes):
                _sample(lanes, loop, first, sample, w)


@inlined_kernel
def _enter_bounds(lanes, loop, w):
    for i in range(WIDTH):
        p, mode = constants_of_lane(w, i), mode_of_lane(lanes, w, i)
        for event in loop:
            found = 0.0
            for case in reversed(event.cases):
                here = bound_in(case.levels[0], VALUES + NODES * SINES, CURVATURE, w, i)
                found = np.where(case.applies(p, mode), here, found)
            w[(lanes.bounds + event.number) * WIDTH + i] = found


@kernel
def enter_bounds(lanes, applicable, w):
    """Write the curvature bounds of the levels of one quantity, of the events in the mask."""
    for mask, loop in lanes.loops:
        if applicable & mask != 0:
            _enter_bounds(lanes, loop, w)


@inlined_kernel
def quantities_in(event, first, w, i):
    """Return the quantities of an event with several, from the lines of a node."""
    return tuple(level_in(level, first, w, i) for level in event.cases[0].levels)


@inlined_kernel
def bounds_of(event, w, i):
    """Return the curvature bounds of the quantities of an event with several."""
    first = VALUES + NODES * SINES
    return tuple(bound_in(level, first, CURVATURE, w, i) for level in event.cases[0].levels)


@inlined_kernel
def is_partial(lanes, which):
    """Return whether lanes lack a quantity of the event ``which``."""
    for event in lanes.combined:
        if event.is_partial and which == event.number:
            return True
    return False


@inlined_kernel
def has_absolute(lanes, which, p, mode):
    """Return whether the level of the event ``which`` contains an absolute value."""
    for event in lanes.singles:
        for case in event.cases:
            if case.levels[0].inside is not None:
                if which == event.number and case.applies(p, mode):
                    return True
    return False


@inlined_kernel
def _enter_case(case, sign, series, w, i):
    length, scale = w[LENGTH * WIDTH + i], 1.0
    for order in range(TERMS):
        first = COEFFICIENTS + order * LINES
        for n, level in enumerate(case.levels):
            found = coefficient_in(level, order, first, scale, sign, w, i)
            series[n * TERMS + order] = found
        scale *= length


@kernel
def enter_series(lanes, which, sign, series, w, i):
    """Write the series of the quantities of the event ``which``, in the fraction of the step.

    ``sign`` is that of the argument of its absolute value.
    """
    p, mode = constants_of_lane(w, i), mode_of_lane(lanes, w, i)
    for event in lanes.all:
        if which == event.number:
            for case in event.cases[:-1]:
                if case.applies(p, mode):
                    _enter_case(case, sign, series, w, i)
                    return
            _enter_case(event.cases[-1], sign, series, w, i)
