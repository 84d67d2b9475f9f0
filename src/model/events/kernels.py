"""Kernels generated from a table of events: samples, single event functions, transitions."""

import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from numba.core import types
from numba.extending import typeof_impl

from model.compile.cache import PACKAGE
from model.compile.generated_kernels import GeneratedKernels
from model.compile.jit import Symbol, inlined_kernel, kernel, python_of
from model.compile.source import Lines, Writer, is_generated
from model.events import event_functions as functions
from model.events.scenes import Declared, Scene
from model.events.table import EVENTS, PLACES_OF_FORCES, Event, Source, Table
from model.physics.modes import START
from model.physics.parameters import Constants

MOST_EVENTS = 44  # capacity of records and histories
MOST_SAMPLES = 2 * MOST_EVENTS


class SceneKernels(NamedTuple):
    """A scene in the form that kernels take: its declared contacts and its event kernels."""

    declared: Declared
    events: Any


@cache
def _scene_type(events: Any) -> Any:
    declared = [types.boolean] * len(Declared._fields)
    return types.NamedTuple(
        [types.NamedUniTuple(declared[0], len(declared), Declared), events], SceneKernels
    )


@typeof_impl.register(SceneKernels)
def _type_of(scene: SceneKernels, _context: Any) -> Any:
    return _scene_type(scene.events.type)  # numba builds it anew at every call, in 0.1 ms


def in_kernels(scene: Scene) -> SceneKernels:
    """Return the scene in the form that kernels take."""
    return SceneKernels(scene.declared, kernels_of(scene.events))


class _Any(Symbol):
    """Symbol for any number, where only the type of a result matters."""

    def _same(self, _other: Any = None) -> "_Any":
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __neg__ = __abs__ = _same


def _is_combined(event: Event) -> bool:
    """Return whether the event function is the largest of several quantities."""
    if event.source.of is not functions.places:
        return False
    p, at = Constants(*[_ANY] * len(Constants._fields)), _ANY_PLACES
    return isinstance(python_of(event.function[0][1])(at, p, START), tuple)


_ANY: Any = _Any()
_ANY_PLACES = functions.CornerPositions(*[_ANY] * len(functions.CornerPositions._fields))


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


def _sample(table: Table, combined: int, write: Writer) -> Lines:
    """All levels; then, for every event with several quantities, the index of the largest."""
    sources: dict[Source, list[int]] = {}
    for number, event in enumerate(table):
        sources.setdefault(event.source, []).append(number)
    for source, numbers in sources.items():
        yield from (f"f{k} = NEVER" for k in numbers)
        yield from (f"g{k} = NEVER" for k in numbers if k < combined)
        yield f"if {write.name(source.exists)}(p, mode):"
        yield f"    at = {write.name(source.of)}(time, q, p, mode)"
        for k in numbers:
            for applies, function in table[k].function:
                value = f"{write.name(function)}(at, p, mode)"
                yield f"    if {write.name(applies)}(p, mode):"
                yield (
                    f"        f{k}, g{k} = largest({value})"
                    if k < combined
                    else f"        f{k} = {value}"
                )
    found = [f"f{k}" for k in range(len(table))] + [f"g{k}" for k in range(combined)]
    yield f"return {', '.join(found)}"


def _level(table: Table, combined: int, write: Writer) -> Lines:
    """The level of one event, which applies."""
    for source, group in groupby(enumerate(table), key=lambda each: each[1].source):
        events = list(group)
        yield f"if {events[0][0]} <= which <= {events[-1][0]}:"
        yield f"    at = {write.name(source.of)}(time, q, p, mode)"
        for k, event in events:
            yield f"    if which == {k}:"
            *others, last = event.function
            for applies, function in others:
                yield f"        if {write.name(applies)}(p, mode):"
                yield f"            return {write.name(function)}(at, p, mode)"
            value = f"{write.name(last[1])}(at, p, mode)"
            yield (
                f"        return largest({value})[0]" if k < combined else f"        return {value}"
            )
    yield "return NEVER"


def _quantities(table: Table, combined: int, write: Writer) -> Lines:
    """The four quantities of one event with several."""
    yield f"at = {write.name(functions.places)}(time, q, p, mode)"
    for k in range(combined):
        value = f"{write.name(table[k].function[0][1])}(at, p, mode)"
        yield f"return {value}" if k == combined - 1 else f"if which == {k}: return {value}"


def _force(table: Table, place: str) -> Lines:
    """Normal force at a place, from a sample; it may be negative."""
    numbers = [k for k, event in enumerate(table) if event.force_on == place]
    for k in numbers:
        yield f"f{k} = sample[{k}] if sample[{k}] != NEVER else 0.0"
    yield f"return {' + '.join(f'f{k}' for k in numbers) or '0.0'}"


def _start(table: Table) -> Lines:
    """Check of the levels at the start."""
    yield "found = sample(0.0, q, p, mode)"
    starts = [(k, event.start) for k, event in enumerate(table) if event.start is not None]
    yield f"return {' or '.join(f'found[{k}] < {start!r}' for k, start in starts) or 'False'}"


def _fingerprint(function: Callable[..., Any]) -> bytes:
    """Bytes that identify a function: its file, name and code, and the values that it encloses.

    A file of the package is named by its place in it: else each checkout would compile its kernels.
    """
    code = function.__code__
    file = Path(code.co_filename)
    if is_generated(function):
        file = Path(file.name)
    elif file.is_relative_to(PACKAGE):
        file = file.relative_to(PACKAGE)
    found = repr((str(file), code.co_qualname, code.co_names, code.co_consts)).encode()
    found += code.co_code
    cells = [each.cell_contents for each in function.__closure__ or ()]
    for each in map(python_of, cells):
        found += _fingerprint(each) if hasattr(each, "__code__") else repr(each).encode()
    return found


def _label(table: Table) -> str:
    """Unique name of a table."""
    if table is EVENTS:
        return "alignment"
    digest = hashlib.sha256()
    for event in table:
        cases = (each for case in event.function for each in case)
        parts = event.source.of, event.source.exists, *cases, event.transition, event.reset
        digest.update(repr((event.name, event.kind, event.force_on, event.start)).encode())
        for part in filter(None, (*parts, event.guard)):
            digest.update(_fingerprint(python_of(part)))
    return f"table-{digest.hexdigest()[:16]}"


@cache
def kernels_of(table: Table) -> GeneratedKernels:
    """Return the kernels of a table.

    Members:
        count, combined, sample_size: number of events, of events with several quantities, and of
            values in a sample.
        sample(time, q, p, mode): levels of all events, NEVER for those that do not apply, and for
            each event with several quantities the index of the largest.
        sample_into(time, q, p, mode, out): writes the sample into ``out``.
        level(which, time, q, p, mode), quantities(which, time, q, p, mode): level and quantities of
            one event.
        guard(which, time, q, p, mode): True if a down-crossing of the level is the event.
        is_conditional(which): True if ``guard`` may be False.
        reset(which, q, p, mode), transition(which, time, q, p, mode, declared): see ``Event``.
        kind(which): LENGTH, LOAD or FRICTION.
        start_is_impossible(q, p, mode), support_force(sample), side_force(sample),
            right_force(sample).
        corners_inside, face_end: numbers of these events.
        inserts: 1 if runs continue after alignment until the part is inserted, else 0.
    """
    combined, label = combined_count(table), _label(table)
    write = Writer(label, NEVER=functions.NEVER, largest=functions.largest)
    events = list(enumerate(table))
    write.write(inlined_kernel, "sample(time, q, p, mode)", _sample(table, combined, write))
    size = len(table) + combined
    write.write(
        kernel, "sample_into(time, q, p, mode, out)",
        iter(("found = sample(time, q, p, mode)", f"for i in range({size}): out[i] = found[i]")),
    )  # fmt: skip
    write.write(kernel, "level(which, time, q, p, mode)", _level(table, combined, write))
    write.write(kernel, "quantities(which, time, q, p, mode)", _quantities(table, combined, write))
    write.write(kernel, "start_is_impossible(q, p, mode)", _start(table))
    for place in PLACES_OF_FORCES:
        write.write(inlined_kernel, f"{place}_force(sample)", _force(table, place))

    def calls(part: str, arguments: str) -> Iterator[tuple[int, str]]:
        for k, event in enumerate(table):
            if function := getattr(event, part):
                yield k, f"{write.name(function)}({arguments})"

    at = f"{write.name(functions.corner_positions)}(q, p)"
    write.choose("guard(which, time, q, p, mode)", calls("guard", f"{at}, p, mode"), "True")
    guarded = ((k, "True") for k, each in events if each.guard)
    write.choose("is_conditional(which)", guarded, "False")
    write.choose("reset(which, q, p, mode)", calls("reset", "q, p, mode"), "q")
    arguments = "time, q, p, mode, declared"
    *others, (_, last) = calls("transition", arguments)
    write.choose(f"transition(which, {arguments})", iter(others), last)
    write.choose("kind(which)", ((k, str(each.kind)) for k, each in events if each.kind), "0")
    names = [each.name for each in table]
    numbers = {
        "count": len(table), "combined": combined, "sample_size": size,
        "corners_inside": names.index("corners_inside"), "face_end": names.index("face_end"),
        "inserts": int("inserted" in names),
    }  # fmt: skip
    return GeneratedKernels(label, write.members | numbers, write.sources)


ALIGNMENT_EVENTS = kernels_of(EVENTS)
