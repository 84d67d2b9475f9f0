"""Events in lanes: which apply, their levels, and kernels on them.

Input: an event table. Output: its ``LaneEvents``, for step.py, event_search.py and scheduling.py.
Events that apply in no mode of the lanes are left out.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.compile.vector_code import each_lane
from model.engine.levels import Level, bound_in, coefficient_in, level_in, levels_of
from model.engine.mode_kinds import (
    ALIGNMENT_KINDS,
    MODES_OF_A_KIND,
    USUAL_KINDS,
    ModeKind,
    kind_in,
    kinds_of,
    lane_modes,
    mode_in_kind,
    numbers_of,
)
from model.engine.series import CONSISTENT, EventQuantities, symbols_of
from model.engine.series_kernels import Series
from model.engine.series_layout import FRACTIONS, LINES, NODES, ORDER, SINES
from model.engine.workspace import (
    APPLICABLE,
    COEFFICIENTS,
    EVENT_LINES,
    STEP_LENGTH,
    VALUES,
    VARIED,
    constants_of_lane,
    mode_of_lane,
)
from model.events.event_functions import NEVER, largest
from model.events.kernels import Events, Numbered
from model.events.table import FORCES
from model.physics.modes import Mode
from model.physics.motion import never_sticks

QUANTITIES = 4  # of a combined event
TERMS = ORDER + 1  # of the series of each quantity
# The largest distance from a line through samples at a step's quarters, over the bound of |g''|.
CURVATURE = FRACTIONS[0] ** 2 / 8.0
_BOUNDS = VALUES + NODES * SINES  # first line of the bounds of quantities


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
    """

    number: int
    cases: tuple[Case, ...]
    is_combined: bool


@dataclass(frozen=True, eq=False)
class LaneEvents:
    """The events of a table, and the series of its modes, as the kernels of lanes take them.

    Attributes:
        events: the whole table.
        combined, singles: events of several quantities, and of one, that apply in lanes.
        masks: masks of the events that apply, by kind of mode and number of the mode in its kind.
        of_friction: mask of the events that need friction.
        kinds: numbers of the kinds of modes; see ``numbers_of``.
        varied: fields of ``Mode`` that lanes hold.
        series: functions that fill and sample the series of each kind of mode.
        symbols: the constants of a lane, for tracing; see ``symbols_of``.
    """

    events: Events
    combined: tuple[LaneEvent, ...]
    singles: tuple[LaneEvent, ...]
    masks: NDArray[np.int64]
    of_friction: int
    kinds: NDArray[np.int64]
    varied: tuple[int, ...]
    series: Series
    symbols: Any

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
    def quantities(self) -> int:
        """First line of the quantities of combined events: of all, at each node, then bounds."""
        return self.subintervals + self.events.count

    @property
    def lines(self) -> int:
        """Number of lines of the workspace."""
        return self.quantities + (NODES + 1) * QUANTITIES * self.events.combined

    @property
    def all(self) -> tuple[LaneEvent, ...]:
        """Every event that applies in lanes."""
        return self.combined + self.singles


def _in_lanes(
    numbered: Numbered, events: Events, kinds: tuple[ModeKind, ...], p: Any
) -> tuple[LaneEvent, set[tuple[int, int]]]:
    """Return an event as lanes have it, and the keys of the modes in which it applies."""
    cases, event, modes = [], numbered.event, lane_modes(events.inserts, kinds)
    rough = p._replace(friction=1.0)  # with which every level applies that needs friction
    for applies, function in event.function:
        if any(applies(rough, mode) for mode, _ in modes):
            levels = levels_of(event.source, function, events.inserts, p)
            if levels is None:
                raise ValueError(f"{event.name}: lanes do not hold its quantities")
            cases.append(Case(applies, levels))
    keys: dict[bool, set[tuple[int, int]]] = {True: set(), False: set()}
    for mode, key in modes:
        keys[any(case.applies(rough, mode) for case in cases)].add(key)
    if keys[True] & keys[False]:
        raise ValueError(f"{event.name}: applies in some modes of a kind and number, not in others")
    return LaneEvent(numbered.number, tuple(cases), numbered.is_combined), keys[True]


def _sampled(events: Events) -> int:
    """Return the number of event quantities up to the last that a scene needs."""
    needed = "tips_depth" if events.constants.is_round else "corner_load"
    if events.inserts and not events.constants.is_round:
        needed = "wall_load"
    return EventQuantities._fields.index(needed) + 1


@cache
def lane_events_of(
    events: Events, switches: tuple[float, ...] = CONSISTENT, is_resident: bool = False
) -> LaneEvents:
    """Return the events of a table as the kernels of lanes take them, in a variant (``Variants``).

    Those of a page are ``is_resident``, see ``Series``: it holds the usual kinds of modes only.

    Raises:
        ValueError: an event applies in a mode that lanes hold, but they lack its quantities, or not
            in all modes of its kind and number.
    """
    kinds = kinds_of(events.inserts)
    if is_resident:
        kinds = USUAL_KINDS if events.inserts else ALIGNMENT_KINDS
    symbols = symbols_of(events.constants, switches)
    masks, found = np.zeros((len(kinds), MODES_OF_A_KIND), np.int64), []
    for numbered in events.all:
        each, keys = _in_lanes(numbered, events, kinds, symbols)
        for key in keys:
            masks[key] |= 1 << each.number
        found += [each] if each.cases else []
    return LaneEvents(
        events=events,
        combined=tuple(each for each in found if each.is_combined),
        singles=tuple(each for each in found if not each.is_combined),
        masks=masks,
        of_friction=sum(1 << each.number for each in events.all if each.event.source == FORCES),
        kinds=numbers_of(kinds),
        varied=tuple(range(len(Mode._fields))) if events.inserts else VARIED,
        series=Series(
            kinds, events.inserts, events.constants, switches, _sampled(events), is_resident
        ),
        symbols=symbols,
    )


# ------------------------------------------------------------------------------------------ kernels


@inlined_kernel
def kind_of_mode(lanes, mode):
    """Return the number of the kind of a mode, -1 if lanes do not hold it: in a page."""
    return kind_in(lanes.kinds, mode)


@inlined_kernel
def applicable_in(lanes, kind, p, mode):
    """Return the mask of the events that apply in a mode of this kind."""
    found = lanes.masks[kind, mode_in_kind(mode)]
    return found & ~lanes.of_friction if never_sticks(p) else found


@inlined_kernel
def sample_line(lanes, which, node):
    """Return the line of the level of an event at a node."""
    return lanes.samples + node * lanes.events.count + which


@inlined_kernel
def quantity_line(lanes, which, node, part):
    """Return the line of a quantity of a combined event at a node; of its bound, at node NODES."""
    return lanes.quantities + (node * lanes.events.combined + which) * QUANTITIES + part


@inlined_kernel
def _is_case(lanes, case, w, i):
    """Return whether a case of an event that applies in lane ``i`` is the one."""
    return case.applies(constants_of_lane(lanes, w, i), mode_of_lane(lanes, w, i))


@inlined_kernel
def _sample_single(lanes, event, node, w):
    """Write the level at a node, NEVER in lanes where it does not apply."""
    first = VALUES + node * SINES
    for i in each_lane():
        found = level_in(event.cases[-1].levels[0], first, w, i)
        for case in event.cases[:-1]:
            here = level_in(case.levels[0], first, w, i)
            found = np.where(_is_case(lanes, case, w, i), here, found)
        applies = int(w[APPLICABLE, i]) & (1 << event.number) != 0
        w[sample_line(lanes, event.number, node), i] = np.where(applies, found, NEVER)


@inlined_kernel
def _bound_single(lanes, event, w):
    for i in each_lane():
        found = bound_in(event.cases[-1].levels[0], _BOUNDS, CURVATURE, w, i)
        for case in event.cases[:-1]:
            here = bound_in(case.levels[0], _BOUNDS, CURVATURE, w, i)
            found = np.where(_is_case(lanes, case, w, i), here, found)
        w[lanes.bounds + event.number, i] = found


@inlined_kernel
def _sample_combined(lanes, event, node, w):
    """Write the quantities at a node, and the largest of them as the level."""
    for i in each_lane():
        first, levels = VALUES + node * SINES, event.cases[0].levels
        found = tuple(level_in(level, first, w, i) for level in levels)
        for part, value in enumerate(found):
            w[quantity_line(lanes, event.number, node, part), i] = value
        w[sample_line(lanes, event.number, node), i] = largest(found)[0]


@inlined_kernel
def _bound_combined(lanes, event, w):
    """Write the bounds of the quantities, and NEVER as the first level where it does not apply."""
    for i in each_lane():
        for part, level in enumerate(event.cases[0].levels):
            bound = bound_in(level, _BOUNDS, CURVATURE, w, i)
            w[quantity_line(lanes, event.number, NODES, part), i] = bound
        applies = int(w[APPLICABLE, i]) & (1 << event.number) != 0
        line = sample_line(lanes, event.number, 0)
        w[line, i] = np.where(applies, w[line, i], NEVER)


@kernel
def _sample_node(lanes, applicable, node, w):
    """Write the levels at a node, of the events in the mask."""
    for event in lanes.all:
        if applicable & (1 << event.number) != 0:
            if event.is_combined:
                _sample_combined(lanes, event, node, w)
            else:
                _sample_single(lanes, event, node, w)


@separate_kernel
def sample_levels(lanes, applicable, w):
    """Write levels at every node and their curvature bounds, of the events in the mask."""
    for node in range(NODES):
        _sample_node(lanes, applicable, node, w)
    for event in lanes.all:
        if applicable & (1 << event.number) != 0:
            if event.is_combined:
                _bound_combined(lanes, event, w)
            else:
                _bound_single(lanes, event, w)


@inlined_kernel
def has_absolute(lanes, which, w, i):
    """Return whether the level of the event ``which`` contains an absolute value in lane ``i``."""
    for event in lanes.singles:
        for case in event.cases:
            is_absolute = case.levels[0].has_absolute and which == event.number
            if is_absolute and _is_case(lanes, case, w, i):
                return True
    return False


@inlined_kernel
def _enter_case(case, sign, series, w, i):
    length, scale = w[STEP_LENGTH, i], 1.0
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
    for event in lanes.all:
        if which == event.number:
            for case in event.cases[:-1]:
                if _is_case(lanes, case, w, i):
                    _enter_case(case, sign, series, w, i)
                    return
            _enter_case(event.cases[-1], sign, series, w, i)
