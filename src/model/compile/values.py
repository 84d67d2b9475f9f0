"""Values that a kernel computes with, as the compiler sees them, and their types.

A value is a number in a register, an array in memory, a tuple of values, or an object of Python
that is known when the kernel is compiled: a function, a class, a table, a string. Such *static*
objects are part of a type: a kernel is translated anew for each of them. Static numbers are not,
unless a loop over static items or a comprehension produces them.
"""

import ast
import struct
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

DOUBLE, INTEGER, BOOLEAN, POINTER = "double", "i64", "i1", "ptr"
_WIDER = (BOOLEAN, INTEGER, DOUBLE)  # a number becomes one of a kind further on
_PYTHON_NUMBERS = (bool, int, float, np.bool_, np.integer, np.floating)


class SubsetError(Exception):
    """What a kernel may not do, and what to write instead.

    Attributes:
        problem, remedy: both in words.
        node: node of the syntax tree where it is done, if it is known.
    """

    def __init__(self, problem: str, remedy: str) -> None:
        super().__init__(problem, remedy)
        self.problem, self.remedy = problem, remedy
        self.node: ast.AST | None = None


class Static:
    """An object that is known when the kernel is compiled."""

    __slots__ = ("object",)

    def __init__(self, known: Any) -> None:
        self.object = known


class Number(NamedTuple):
    """A number: its kind, and its name or constant in LLVM's language."""

    kind: str
    name: str


class Group(NamedTuple):
    """A tuple: its named tuple class, None for a plain one, and its items."""

    made_by: type[Any] | None
    items: tuple[Any, ...]


class Array(NamedTuple):
    """An array in memory.

    Attributes:
        pointer: name of the address of its first number.
        kind: kind of its numbers, DOUBLE or INTEGER.
        lengths: of its dimensions, each an int or a ``Number``.
        strides: numbers from one element to the next along each dimension.
    """

    pointer: str
    kind: str
    lengths: tuple[int | Number, ...]
    strides: tuple[int, ...]


Value = Static | Number | Group | Array

# ------------------------------------------------------------------------------------------- types


class StaticType:
    """Type of a static object: numbers are the same by value, all others by identity."""

    __slots__ = ("key", "object")

    def __init__(self, known: Any) -> None:
        self.object = known
        self.key = (type(known), known) if is_number(known) else id(known)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StaticType) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


class GroupType(NamedTuple):
    """Type of a tuple."""

    made_by: type[Any] | None
    items: "tuple[Type, ...]"


class ArrayType(NamedTuple):
    """Type of an array: None stands for a length that is known only at run time."""

    kind: str
    lengths: tuple[int | None, ...]
    strides: tuple[int, ...]


Type = str | StaticType | GroupType | ArrayType


def is_number(known: Any) -> bool:
    """Return whether an object of Python is a number."""
    return isinstance(known, _PYTHON_NUMBERS)


def constant(known: Any) -> Number:
    """Return a number of Python as a constant."""
    if isinstance(known, (bool, np.bool_)):
        return Number(BOOLEAN, "true" if known else "false")
    if isinstance(known, (int, np.integer)):
        if not -(2**63) <= known < 2**63:
            raise SubsetError(f"the integer {known} does not fit into 64 bits", "write a float")
        return Number(INTEGER, str(int(known)))
    (bits,) = struct.unpack("<Q", struct.pack("<d", known))
    return Number(DOUBLE, f"0x{bits:016X}")


def known_number(number: Number) -> bool | int | None:
    """Return the value of a constant boolean or integer; None for any other number."""
    if number.kind == BOOLEAN and number.name in ("true", "false"):
        return number.name == "true"
    if number.kind == INTEGER and number.name.lstrip("-").isdigit():
        return int(number.name)
    return None


def type_of(value: Value) -> Type:
    """Return the type of a value."""
    if isinstance(value, Number):
        return value.kind
    if isinstance(value, Group):
        return GroupType(value.made_by, tuple(map(type_of, value.items)))
    if isinstance(value, Array):
        lengths = tuple(each if isinstance(each, int) else None for each in value.lengths)
        return ArrayType(value.kind, lengths, value.strides)
    return StaticType(value.object)


def leaves(value: Value) -> Iterator[Number]:
    """Yield the numbers and addresses of which a value is made."""
    if isinstance(value, Number):
        yield value
    elif isinstance(value, Group):
        for each in value.items:
            yield from leaves(each)
    elif isinstance(value, Array):
        yield Number(POINTER, value.pointer)
        yield from (each for each in value.lengths if isinstance(each, Number))


def leaf_kinds(type_: Type) -> list[str]:
    """Return the kinds of the ``leaves`` of a value of this type."""
    if isinstance(type_, str):
        return [type_]
    if isinstance(type_, GroupType):
        return [kind for each in type_.items for kind in leaf_kinds(each)]
    if isinstance(type_, ArrayType):
        return [POINTER, *(INTEGER for each in type_.lengths if each is None)]
    return []


def rebuilt(type_: Type, names: Iterator[str]) -> Value:
    """Return the value of this type whose leaves have these names."""
    if isinstance(type_, str):
        return Number(type_, next(names))
    if isinstance(type_, GroupType):
        return Group(type_.made_by, tuple([rebuilt(each, names) for each in type_.items]))
    if isinstance(type_, ArrayType):
        pointer = next(names)
        lengths = (Number(INTEGER, next(names)) if n is None else n for n in type_.lengths)
        return Array(pointer, type_.kind, tuple(lengths), type_.strides)
    return Static(type_.object)


def joined(one: Type, other: Type) -> Type | None:
    """Return the type of a variable that has one type here and another there; None for no type.

    Of two numbers it is the wider one; a static number counts as a number.
    """
    if one == other:
        return one
    one, other = _at_run_time(one), _at_run_time(other)
    if one == other:
        return one
    if isinstance(one, str) and isinstance(other, str):
        return max(one, other, key=_WIDER.index)
    if isinstance(one, GroupType) and isinstance(other, GroupType):
        if len(one.items) != len(other.items):
            return None
        if None not in (one.made_by, other.made_by) and one.made_by is not other.made_by:
            return None
        items = [joined(*each) for each in zip(one.items, other.items, strict=True)]
        return None if None in items else GroupType(one.made_by or other.made_by, tuple(items))  # type: ignore[arg-type]
    return None


def _at_run_time(type_: Type) -> Type:
    if isinstance(type_, StaticType) and is_number(type_.object):
        return constant(type_.object).kind
    return type_


def at_run_time(value: Value) -> Value:
    """Return a value with its static numbers, and static tuples of numbers, as constants."""
    if isinstance(value, Static):
        if is_number(value.object):
            return constant(value.object)
        if isinstance(value.object, tuple) and _is_numeric(value.object):
            items = (at_run_time(Static(each)) for each in value.object)
            return Group(_class_of(value.object), tuple(items))
    if isinstance(value, Group):
        return Group(value.made_by, tuple(map(at_run_time, value.items)))
    return value


def _is_numeric(known: Any) -> bool:
    return is_number(known) or (isinstance(known, tuple) and all(map(_is_numeric, known)))


def _class_of(known: tuple[Any, ...]) -> type[Any] | None:
    return type(known) if hasattr(known, "_fields") else None


def in_words(type_: Type) -> str:
    """Return a type as an error names it."""
    if isinstance(type_, str):
        return {DOUBLE: "a float", INTEGER: "an int", BOOLEAN: "a bool"}[type_]
    if isinstance(type_, GroupType):
        name = f" {type_.made_by.__name__}" if type_.made_by else ""
        return f"a tuple{name} of {len(type_.items)}"
    if isinstance(type_, ArrayType):
        return f"an array of {len(type_.lengths)} dimensions"
    return f"the object {getattr(type_.object, '__name__', type_.object)!r}"


def contiguous(lengths: Iterable[int]) -> tuple[int, ...]:
    """Return the strides of an array of these lengths without gaps; the first does not matter."""
    strides, size = [], 1
    for length in reversed(tuple(lengths)[1:]):
        strides.append(size)
        size *= length
    return (size, *reversed(strides))
