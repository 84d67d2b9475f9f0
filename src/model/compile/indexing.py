"""Items of tuples, and elements and parts of arrays."""

import ast
from typing import NamedTuple

from model.compile.arithmetic import operate
from model.compile.code import Code
from model.compile.values import (
    DOUBLE,
    INTEGER,
    Array,
    Group,
    Number,
    Static,
    SubsetError,
    Value,
    at_run_time,
    constant,
    is_number,
    known_number,
)


class Slice(NamedTuple):
    """A slice between brackets: its ends, None where they are left out."""

    first: Value | None
    end: Value | None


Index = Value | Slice


def item_of(code: Code, items: tuple[Value, ...], index: Index) -> Value:
    """Return an item of a tuple, or several as a tuple."""
    if isinstance(index, Slice):
        ends = (None if end is None else _known(end) for end in index)
        return Group(None, items[slice(*ends)])
    if isinstance(index, Static):
        return items[_checked(index, len(items))]
    number, found = code.of_kind(index, INTEGER), at_run_time(items[-1])
    for n in range(len(items) - 2, -1, -1):
        here = code.compare("eq", number, constant(n))
        found = code.select(here, at_run_time(items[n]), found)
    return found


def part_of(code: Code, array: Array, indices: list[Index]) -> Array:
    """Return the part of an array that indices select; an element is one of no dimension."""
    dimensions = len(array.lengths)
    if len(indices) > dimensions:
        raise SubsetError(
            f"{len(indices)} indices of an array of {dimensions} dimensions",
            "give one for each dimension at most",
        )
    offset: Value = Static(0)
    lengths: list[int | Number] = []
    strides: list[int] = []
    given = [*indices, *[Slice(None, None)] * (dimensions - len(indices))]
    for index, length, stride in zip(given, array.lengths, array.strides, strict=True):
        if isinstance(index, Slice):
            first = Static(0) if index.first is None else _not_negative(index.first)
            end = length_of(length) if index.end is None else _not_negative(index.end)
            count = at_run_time(operate(code, ast.Sub, end, first))
            number = code.of_kind(count, INTEGER)
            known = known_number(number)
            lengths.append(number if known is None else int(known))
            strides.append(stride)
        elif isinstance(index, Static) and isinstance(length, int):
            first = Static(_checked(index, length))
        else:
            first = _whole(code, index)
        offset = operate(code, ast.Add, offset, operate(code, ast.Mult, first, Static(stride)))
    return Array(code.address(array, offset), array.kind, tuple(lengths), tuple(strides))


def length_of(length: int | Number) -> Value:
    """Return a length of an array as a value."""
    return Static(length) if isinstance(length, int) else length


def _whole(code: Code, index: Value) -> Value:
    if isinstance(index, Static):
        return _not_negative(index)
    number = code.number(index, "an index")
    if number.kind == DOUBLE:
        raise SubsetError("a float as an index", "take int(...) of it")
    return code.of_kind(number, INTEGER)


def _not_negative(index: Value) -> Value:
    """Return an index of an array, unless it is known to count from the end."""
    if isinstance(index, Static) and _integer(index) < 0:
        raise SubsetError(f"the index {index.object} of an array", "count from the beginning")
    return index


def _checked(index: Static, length: int) -> int:
    """Return an index that is known, counted from the beginning."""
    found = _integer(index)
    if not -length <= found < length:
        raise SubsetError(
            f"the index {found} of {length} items", f"give one from 0 to {length - 1}"
        )
    return found % length


def _known(index: Value) -> int:
    if not isinstance(index, Static):
        raise SubsetError("a slice of a tuple at run time", "give ends that are known")
    return _integer(index)


def _integer(index: Static) -> int:
    if isinstance(index.object, (bool, float)) or not is_number(index.object):
        raise SubsetError(f"the index {index.object!r}", "give an int")
    return int(index.object)
