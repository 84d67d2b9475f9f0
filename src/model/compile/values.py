"""Values that a kernel computes with, as the compiler sees them.

A value is a number in a register, an array in memory, a tuple of values, or an object of Python
that is known when the kernel is compiled: a function, a class, a table, a string. The *type* of a
value is the same without the names of registers. Static objects are part of it: a kernel is
translated anew for each of them. Static numbers are not, unless a loop over static items or a
comprehension produces them.
"""

import ast
import struct
from collections.abc import Callable, Iterable, Iterator
from itertools import repeat
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

DOUBLE, INTEGER, BOOLEAN, POINTER = "double", "i64", "i1", "ptr"
KINDS = (BOOLEAN, INTEGER, DOUBLE)  # a number becomes one of a kind further on
_MOST_LISTED = 4  # items of a tuple in an error
_PYTHON_NUMBERS = (bool, int, float, np.bool_, np.integer, np.floating)
_ELEMENTS = {np.dtype(np.float64): DOUBLE, np.dtype(np.int64): INTEGER}


class SubsetError(Exception):
    """Refusal of what a kernel may not do, with what to write instead.

    Attributes:
        problem, remedy: both in words.
        node: node of the syntax tree where it is done, if it is known.
    """

    def __init__(self, problem: str, remedy: str) -> None:
        super().__init__(problem, remedy)
        self.problem, self.remedy = problem, remedy
        self.node: ast.AST | None = None


class Static:
    """An object that is known when the kernel is compiled.

    As types, static numbers are the same by value, all other objects by identity.
    """

    __slots__ = ("object",)

    def __init__(self, known: Any) -> None:
        self.object = known

    def _key(self) -> Any:
        known = self.object
        return (type(known), repr(known)) if is_number(known) else id(known)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Static) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())


class Number(NamedTuple):
    """A number: its kind, and its name or constant in LLVM's language."""

    kind: str
    name: str = ""


class Group(NamedTuple):
    """A tuple: its named tuple class, None for a plain one or ``Once``, and its items."""

    made_by: type[Any] | None
    items: "tuple[Value, ...]"


class Once:
    """Class of the items of an iterator, which Python gives once."""


class Generated(Once):
    """Class of the items of a generator, which Python computes one by one."""


class Array(NamedTuple):
    """An array in memory.

    Attributes:
        pointer: name of the address of its first number.
        kind: kind of its numbers, DOUBLE or INTEGER.
        lengths: of its dimensions, each an int or a ``Number``.
        strides: numbers from one element to the next along each dimension.
        is_constant: True if it may not be written.
    """

    pointer: str
    kind: str
    lengths: tuple[int | Number, ...]
    strides: tuple[int, ...]
    is_constant: bool


Value = Static | Number | Group | Array
Type = Value
NOTHING = Static(None)  # what a kernel without a result returns


def is_iterator(value: Value) -> bool:
    """Return whether a value can be gone through once."""
    return isinstance(value, Group) and value.made_by in (Once, Generated)


def is_number(known: Any) -> bool:
    """Return whether an object of Python is a number."""
    return isinstance(known, _PYTHON_NUMBERS)


def static_result(function: Callable[..., Any], *arguments: Any, **named: Any) -> Static:
    """Call a function of Python, when the kernel is compiled."""
    try:
        return Static(function(*arguments, **named))
    except Exception as error:  # noqa: BLE001 - whatever it raises is a mistake in the kernel
        name = getattr(function, "__name__", repr(function))
        raise SubsetError(f"{name}: {error}", "pass what it takes") from None


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


def element_kind(array: NDArray[Any]) -> str:
    """Return the kind of the numbers of an array of numpy.

    Raises:
        SubsetError: they are others than kernels compute with, or it has no dimension.
    """
    kind = _ELEMENTS.get(array.dtype)
    if kind is None or array.ndim == 0 or any(each % array.itemsize for each in array.strides):
        raise SubsetError(
            f"an array of {array.dtype} with {array.ndim} dimensions",
            "give one of float64 or int64 with at least one dimension",
        )
    return kind


def element_strides(array: NDArray[Any]) -> tuple[int, ...]:
    """Return the strides of an array of numpy, in numbers.

    An empty array, and a dimension of length one, may have any strides in numpy. Here they get
    those of a contiguous array, since kernels are compiled for each set of strides.
    """
    strides, step = [], 1
    for length, stride in zip(reversed(array.shape), reversed(array.strides), strict=True):
        strides.append(step if length <= 1 or array.size == 0 else stride // array.itemsize)
        step = strides[-1] * max(length, 1)
    return tuple(reversed(strides))


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


def leaf_kinds(*types: Type) -> list[str]:
    """Return the kinds of the ``leaves`` of values of these types."""
    return [leaf.kind for each in types for leaf in leaves(each)]


def rebuilt(type_: Type, names: Iterator[str]) -> Value:
    """Return the value of this type whose leaves have these names."""
    if isinstance(type_, Number):
        return Number(type_.kind, next(names))
    if isinstance(type_, Group):
        return Group(type_.made_by, tuple([rebuilt(each, names) for each in type_.items]))
    if isinstance(type_, Array):
        pointer = next(names)
        lengths = [n if isinstance(n, int) else Number(n.kind, next(names)) for n in type_.lengths]
        return type_._replace(pointer=pointer, lengths=tuple(lengths))
    return type_


def type_of(value: Value) -> Type:
    """Return the type of a value."""
    return rebuilt(value, repeat(""))


def check_same(one: Type, other: Type) -> None:
    """Check that two values, of which one is taken, are of the same type."""
    if one != other:
        found = f"a value that is {in_words(one)} or {in_words(other)}"
        raise SubsetError(found, "give both the same type: 0.0, not 0, beside a float")


def at_run_time(value: Value) -> Value:
    """Return a value with its static numbers, and static tuples of numbers, as constants."""
    if isinstance(value, Static):
        if is_number(value.object):
            return constant(value.object)
        if _is_numeric(value.object):
            return at_run_time(as_group(value))
    if isinstance(value, Group):
        return Group(value.made_by, tuple(map(at_run_time, value.items)))
    return value


def as_group(value: Value) -> Value:
    """Return a static tuple as a tuple of static items; another value as it is."""
    if not (isinstance(value, Static) and isinstance(value.object, tuple)):
        return value
    made_by = type(value.object) if hasattr(value.object, "_fields") else None
    return Group(made_by, tuple(map(Static, value.object)))


def known_objects(values: Iterable[Value]) -> list[Any] | None:
    """Return the objects of static values; None if one is not static."""
    listed = [*values]
    known = [each.object for each in listed if isinstance(each, Static)]
    return known if len(known) == len(listed) else None


def _is_numeric(known: Any) -> bool:
    return is_number(known) or (isinstance(known, tuple) and all(map(_is_numeric, known)))


def in_words(type_: Type) -> str:
    """Return a type as an error names it."""
    if isinstance(type_, Number):
        return {DOUBLE: "a float", INTEGER: "an int", BOOLEAN: "a bool"}[type_.kind]
    if is_iterator(type_):
        return "an iterator"
    if isinstance(type_, Group):
        name = f" {type_.made_by.__name__}" if type_.made_by else ""
        is_short = len(type_.items) <= _MOST_LISTED
        items = ", ".join(map(in_words, type_.items)) if is_short else len(type_.items)
        return f"a tuple{name} of {items or 'nothing'}"
    if isinstance(type_, Array):
        return f"an array of {len(type_.lengths)} dimensions"
    kind = "number" if is_number(type_.object) else "object"
    return f"the {kind} {getattr(type_.object, '__name__', type_.object)!r}"
