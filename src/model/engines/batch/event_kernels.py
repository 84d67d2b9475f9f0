"""Kernels of the batch engine that loop over events, generated from the table of a scene.

Input: an event table, with its levels as linear forms (level_forms.py). Output: the members that
``vector_kernels_of`` lists, for step.py, event_search.py and scheduling.py. numba vectorizes loops
over lanes only if every level is written out, with places known at compile time: the code is
generated, a line for each event. Events that apply in no mode of the lanes are omitted.
"""

from collections.abc import Iterator
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.compile.generated_kernels import GeneratedKernels
from model.compile.jit import inlined_kernel, kernel, python_of
from model.compile.source import Lines, Writer
from model.compile.vector_code import WIDTH
from model.engines.batch import step, workspace
from model.engines.batch.level_forms import LinearForm, P, forms_of, rendered
from model.engines.batch.mode_kinds import (
    MODES_OF_A_KIND,
    kind_in,
    kinds_of,
    lane_modes,
    mode_in_kind,
    numbers_of,
)
from model.engines.batch.series import EventQuantities
from model.engines.batch.series_code import ErrorWriter, SeriesWriter
from model.engines.batch.series_kernels import filler, series_sampler
from model.engines.batch.series_layout import NODES, ORDER, ROWS, SINES
from model.engines.batch.workspace import COEFFICIENTS, EVENT_ROWS, ROW, VALUES
from model.events.event_functions import NEVER, NOTHING
from model.events.kernels import SceneKernels, combined_count, kernels_of
from model.events.scenes import Scene
from model.events.table import Event, Table

TERMS = ORDER + 1  # of the series of each quantity
_LEAST_EVENTS = 8  # in a loop over lanes: the compiler unrolls short ones and leaves them scalar
_BOUND_SCALE = f"{step.CURVATURE!r} * "  # from the bound of |g''| to the curvature bound
_CORNERS = "corner_load", "wall_load"  # the last quantities, of the insertion scene


_ROUGH = P._replace(friction=1.0)  # constants with which every level applies that needs friction


class Case(NamedTuple):
    """Case of a level: ``applies`` (p, mode) -> bool, and its quantities as forms."""

    applies: Any
    forms: tuple[LinearForm, ...]


class LaneEvent:
    """Event that has a level in some mode of the lanes.

    Attributes:
        number: index in the event table.
        cases: cases of its level.
        places: places of the modes in which it applies; see ``lane_modes``.
    """

    def __init__(self, number: int, event: Event, inserts: bool) -> None:
        self.number = number
        self.cases: list[Case] = []
        self.places: set[tuple[int, int]] = set()
        for applies, level in event.function:
            here = python_of(applies)
            places = {place for mode, place in lane_modes(inserts) if here(_ROUGH, mode)}
            if not places:
                continue
            forms = forms_of(event.source, level, inserts)
            if forms is None:
                raise ValueError(f"{event.name}: lanes hold its modes, but not its quantities")
            self.cases.append(Case(applies, forms))
            self.places |= places

    @cached_property
    def is_partial(self) -> bool:
        """True if lanes lack some of its quantities: the reference engine then decides."""
        return any(not form.is_known for case in self.cases for form in case.forms)


def _load_lines(forms: tuple[LinearForm, ...], row: str, scale: str = "") -> Lines:
    """Lines that load the rows of forms, from ``row`` on."""
    names = dict.fromkeys(name for form in forms for name in form.factors)
    for name in names:
        yield f"{name} = {scale}w[({row} + {ROW[name]}) * {WIDTH} + i]"


def _value(form: LinearForm, size: str = "abs({})") -> str:
    """Expression of a quantity, from loaded rows."""
    return rendered(form, str, size) if form.is_known else "NOTHING"


def _constant(form: LinearForm) -> str:
    """Expression of a quantity where all rows are zero."""
    return rendered(form, lambda _: "0.0") if form.is_known else "NOTHING"


def _bound(form: LinearForm) -> str:
    """Expression of the curvature bound of a quantity, from the bounds of rows."""
    terms = []
    for name, factor in form.factors.items():
        is_one = isinstance(factor, float) and abs(factor) == 1.0
        terms.append(name if is_one else f"abs({factor}) * {name}")
    return " + ".join(terms) if form.is_known and terms else "0.0"


def _all_forms(events: list[LaneEvent]) -> tuple[LinearForm, ...]:
    return tuple(form for event in events for case in event.cases for form in case.forms)


def _selected(event: LaneEvent, texts: list[str], otherwise: str, write: Writer) -> str:
    """Expression that selects the case that applies."""
    text = otherwise
    for case, each in zip(reversed(event.cases), reversed(texts), strict=True):
        text = f"({each} if {write.name(case.applies)}(p, mode) else {text})"
    return text


def _in_loops(events: list[LaneEvent]) -> Iterator[tuple[str, list[LaneEvent]]]:
    """Yield events for one loop over lanes, with the condition that one of them may apply."""
    size = -(-len(events) // max(1, len(events) // _LEAST_EVENTS))
    for first in range(0, len(events), size):
        group = events[first : first + size]
        yield f"applicable & {sum(1 << each.number for each in group)}", group


_LANE = "p, mode = constants_of_lane(w, i), mode_of_lane(w, i)"


def _sample_lines(singles: list[LaneEvent], samples: int, count: int, write: Writer) -> Lines:
    """Levels of one quantity at every node, with constant offsets for each node.

    The loop over lanes is a kernel inlined for each node: numba takes 4 s longer for five of them.
    """
    for number, (condition, events) in enumerate(_in_loops(singles)):
        lines = [f"for i in range({WIDTH}):"]
        lines += [f"    {each}" for each in (_LANE, *_load_lines(_all_forms(events), "row"))]
        for event in events:
            values = [_value(case.forms[0]) for case in event.cases]
            selected = _selected(event, values, "NEVER", write)
            lines.append(f"    w[(sample + {event.number}) * {WIDTH} + i] = {selected}")
        write.write(inlined_kernel, f"sample_{number}(row, sample, w)", iter(lines))
        yield f"if {condition}:"
        for node in range(NODES):
            row, sample = VALUES + node * SINES, samples + node * count
            yield f"    sample_{number}({row}, {sample}, w)"


def _bound_lines(singles: list[LaneEvent], bounds: int, write: Writer) -> Lines:
    """Curvature bounds of levels of one quantity."""
    row = str(VALUES + NODES * SINES)
    for condition, events in _in_loops(singles):
        yield f"if {condition}:"
        yield f"    for i in range({WIDTH}):"
        lines = [_LANE, *_load_lines(_all_forms(events), row, _BOUND_SCALE)]
        for event in events:
            values = [_bound(case.forms[0]) for case in event.cases]
            selected = _selected(event, values, "0.0", write)
            lines.append(f"w[{(bounds + event.number) * WIDTH} + i] = {selected}")
        yield from (f"        {each}" for each in lines)


def _quantity_lines(combined: list[LaneEvent], row: str, scale: str, text: Any) -> Lines:
    """Lines that return the four quantities of the event ``which``, or their bounds."""
    yield _LANE
    for event in combined:
        forms = event.cases[0].forms
        values = map(text, forms)
        last = event is combined[-1]
        yield "if True:" if last else f"if which == {event.number}:"
        yield from (f"    {each}" for each in _load_lines(forms, row, scale))
        yield f"    return {', '.join(values)}"


def _screen_lines(several: list[LaneEvent], singles: list[LaneEvent]) -> Lines:
    """Lines that screen the events that may apply."""
    for condition, events in _in_loops(singles):
        yield f"if {condition}:"
        yield f"    for i in range({WIDTH}):"
        bits = " + ".join(f"screen_single(events, {each.number}, w, i)" for each in events)
        yield f"        w[CANDIDATES * {WIDTH} + i] += {bits}"
    for each in several:
        yield f"if applicable & {1 << each.number}: screen_combined(events, {each.number}, w)"


def _series_lines(event: LaneEvent, write: Writer) -> Lines:
    """Series of the quantities of one event, in the fraction of the step."""
    yield "p, mode, length = constants_of_lane(w, i), mode_of_lane(w, i), w[LENGTH * WIDTH + i]"
    for case in event.cases:
        last = case is event.cases[-1]
        yield "if True:" if last else f"if {write.name(case.applies)}(p, mode):"
        yield "    scale = 1.0"
        yield f"    for order in range({TERMS}):"
        yield f"        row = {COEFFICIENTS} + order * {ROWS}"
        yield from (f"        {each}" for each in _load_lines(case.forms, "row", "scale * "))
        for n, form in enumerate(case.forms):
            yield f"        g{n} = {_value(form, '(sign * {})')}"
            yield f"        if order > 0: g{n} = g{n} - {_constant(form)}"
            yield f"        series[{n * TERMS} + order] = g{n}"
        yield "        scale *= length"
        yield "    return"


def _masks(lane_events: list[LaneEvent], kinds: int) -> NDArray[np.int64]:
    """Return the masks of the events that may apply in each mode of each kind."""
    masks = np.zeros((kinds, MODES_OF_A_KIND), np.int64)
    for event in lane_events:
        for place in event.places:
            masks[place] |= 1 << event.number
    return masks


@cache
def vector_kernels_of(table: Table) -> GeneratedKernels:
    """Return the kernels of ``kernels_of`` for a table, with further ones for the batch engine.

    Members:
        rows, kinds: number of rows of the workspace, and of kinds of modes.
        samples, bounds, subintervals: first rows of the levels at the nodes, of their curvature
            bounds, and of the masks of subintervals that may contain a down-crossing.
        applicable(kind, mode): mask of the events that may apply in a mode of this kind.
        sample_lanes(applicable, w), enter_bounds(applicable, w): write the levels of one quantity,
            and their bounds, of the events in the mask ``applicable``.
        quantities_in(which, row, w, i), bounds_of(which, w, i): quantities of a level of several,
            and their bounds.
        applies(which, p, mode): True if a level of several quantities applies.
        screen(events, applicable, w): writes the candidates, by bounds over the whole step.
        find(events, candidates, w): writes those that remain, with their subintervals.
        enter_series(which, sign, series, w, i): writes the series of a level's quantities; ``sign``
            is the sign of the argument of its absolute value.
        mode_of_lane(w, i): the ``Mode`` of a lane; kind_of(mode): see ``kind_in``.
        fill_series, fill_errors, sample_series: see series_kernels.py.
        has_absolute(which, p, mode), is_partial(which): see ``LinearForm`` and ``LaneEvent``.
    """
    combined, count, base = combined_count(table), len(table), kernels_of(table)
    inserts = base.inserts == 1
    kinds = kinds_of(inserts)
    mode_of_lane = workspace.mode_of_lane_in_slot if inserts else workspace.mode_of_lane
    quantities = EventQuantities._fields if inserts else EventQuantities._fields[: -len(_CORNERS)]
    samples = EVENT_ROWS
    bounds = samples + NODES * count
    subintervals = bounds + count
    numbers = {
        "samples": samples, "bounds": bounds, "subintervals": subintervals,
        "rows": subintervals + count, "kinds": len(kinds),
    }  # fmt: skip
    lane_events = [
        each for k, event in enumerate(table) if (each := LaneEvent(k, event, inserts)).cases
    ]
    several = [each for each in lane_events if each.number < combined]
    singles = [each for each in lane_events if each.number >= combined]
    write = Writer(
        base.name, NEVER=NEVER, NOTHING=NOTHING, WIDTH=WIDTH, CANDIDATES=workspace.CANDIDATES,
        LENGTH=workspace.LENGTH, constants_of_lane=workspace.constants_of_lane,
        mode_of_lane=mode_of_lane,
        screen_single=step.screen_single, screen_combined=step.screen_combined,
        find_single=step.find_single, find_combined=step.find_combined,
    )  # fmt: skip
    sampled = _sample_lines(singles, samples, count, write)
    write.write(kernel, "sample_lanes(applicable, w)", sampled)
    write.write(kernel, "enter_bounds(applicable, w)", _bound_lines(singles, bounds, write))
    write.write(
        inlined_kernel, "quantities_in(which, row, w, i)",
        _quantity_lines(several, "row", "", _value),
    )  # fmt: skip
    write.write(
        inlined_kernel, "bounds_of(which, w, i)",
        _quantity_lines(several, str(VALUES + NODES * SINES), _BOUND_SCALE, _bound),
    )  # fmt: skip
    write.choose(
        "applies(which, p, mode)",
        ((k.number, f"{write.name(k.cases[0].applies)}(p, mode)") for k in several),
        "False",
    )
    write.write(kernel, "screen(events, applicable, w)", _screen_lines(several, singles))
    write.write(kernel, "find(events, candidates, w)", iter([
        f"find_{'combined' if k.number < combined else 'single'}(events, {k.number}, candidates, w)"
        for k in lane_events
    ]))  # fmt: skip
    for each in lane_events:
        head = f"enter_{each.number}(sign, series, w, i)"
        write.write(inlined_kernel, head, _series_lines(each, write))
    write.write(kernel, "enter_series(which, sign, series, w, i)", iter([
        f"{'if' if k is lane_events[0] else 'elif'} which == {k.number}: "
        f"enter_{k.number}(sign, series, w, i)"
        for k in lane_events
    ]))  # fmt: skip
    write.choose(
        "has_absolute(which, p, mode)",
        (
            (k.number, f"{write.name(case.applies)}(p, mode)")
            for k in singles
            for case in k.cases
            if case.forms[0].has_absolute
        ),
        "False",
    )
    write.choose(
        "is_partial(which)", ((k.number, "True") for k in several if k.is_partial), "False"
    )
    write.known |= {"NUMBERS": numbers_of(kinds), "kind_in": kind_in}
    write.write(inlined_kernel, "kind_of(mode)", iter(("return kind_in(NUMBERS, mode)",)))
    write.known |= {"MASKS": _masks(lane_events, len(kinds)), "mode_in_kind": mode_in_kind}
    write.write(
        inlined_kernel, "applicable(kind, mode)", iter(("return MASKS[kind, mode_in_kind(mode)]",))
    )
    members = base.members | write.members | numbers
    members |= {
        "mode_of_lane": mode_of_lane,
        "fill_series": filler("fill_series", SeriesWriter, kinds, inserts),
        "fill_errors": filler("fill_errors", ErrorWriter, kinds, inserts),
        "sample_series": series_sampler(len(quantities)),
    }
    return GeneratedKernels(f"{base.name}-lanes", members, write.sources)


def in_vector_kernels(scene: Scene) -> SceneKernels:
    """Return the scene in the form that the kernels of the batch engine take."""
    return SceneKernels(scene.declared, vector_kernels_of(scene.events))
