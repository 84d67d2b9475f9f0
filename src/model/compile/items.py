"""Members and items of values: of tuples, of arrays and their parts, of static objects."""

import ast
from typing import NamedTuple

import numpy as np

from model.compile.arithmetic import both, operate
from model.compile.code import Code
from model.compile.values import (
    BOOLEAN,
    INTEGER,
    Array,
    Generated,
    Group,
    Number,
    Static,
    SubsetError,
    Value,
    as_group,
    at_run_time,
    constant,
    in_words,
    is_iterator,
    known_number,
    static_result,
    type_of,
)

_MOST_UNROLLED = 1024  # items of a comprehension or a loop over static items


class Method:
    """A method of a value, ``_replace`` or ``view``, about to be called."""

    def __init__(self, of: Value, name: str) -> None:
        self.of, self.name = of, name


class Slice(NamedTuple):
    """A slice between brackets: its ends, None where they are left out."""

    first: Value | None
    end: Value | None


Index = Value | Slice

# ---------------------------------------------------------------------------------- tuples, objects


def member(code: Code, value: Value, name: str) -> Value:
    """Return a member of a named tuple, of an array or of a static object."""
    if isinstance(value, Static) and hasattr(value.object, name):
        is_method = name == "_replace" and isinstance(value.object, tuple)
        return Static(Method(value, name)) if is_method else Static(getattr(value.object, name))
    if isinstance(value, Group):
        fields = getattr(value.made_by, "_fields", ())
        if name in fields:
            return value.items[fields.index(name)]
        if name == "_replace" and fields:
            return Static(Method(value, name))
        if name in vars(value.made_by or object):  # an attribute of the class
            return Static(getattr(value.made_by, name))
    elif name == "view" and (isinstance(value, Array) or type_of(value) != Number(BOOLEAN)):
        return Static(Method(value, name))
    elif name == "shape" and isinstance(value, Array):
        return Group(None, tuple(map(_length, value.lengths)))
    elif name == "size" and isinstance(value, Array):
        size = _length(value.lengths[0])
        for length in value.lengths[1:]:
            size = operate(code, ast.Mult, size, _length(length))
        return size
    raise SubsetError(f"{in_words(type_of(value))} has no {name!r}", "name a member that it has")


def replaced(value: Value, named: dict[str, Value]) -> Value:
    """Return a named tuple with other fields: its method ``_replace``."""
    group = as_group(value)
    if not isinstance(group, Group) or not group.made_by:
        raise SubsetError(f"_replace of {in_words(type_of(value))}", "give a named tuple")
    fields = group.made_by._fields
    if unknown := sorted({*named} - {*fields}):
        raise SubsetError(f"_replace of {', '.join(unknown)}", f"name of {', '.join(fields)}")
    items = (named.get(name, item) for name, item in zip(fields, group.items, strict=True))
    return Group(group.made_by, tuple(items))


def items_of(code: Code, value: Value) -> tuple[Value, ...]:
    """Return the items of a tuple, a static sequence or an array of known length."""
    if isinstance(value, Group):
        return value.items
    if isinstance(value, Static) and isinstance(value.object, np.ndarray):
        value = code.declared.array(value.object)
    if isinstance(value, Static) and isinstance(value.object, (tuple, list, range, str, dict)):
        return tuple(map(Static, value.object)) if _is_short(len(value.object)) else ()
    if isinstance(value, Array) and isinstance(value.lengths[0], int):
        numbers = range(value.lengths[0] if _is_short(value.lengths[0]) else 0)
        return tuple(element(code, value, [Static(n)]) for n in numbers)
    raise SubsetError(
        f"the items of {in_words(type_of(value))}", "loop over a range, or give a tuple"
    )


def _is_short(count: int) -> bool:
    """Return True for a number of items that may be unrolled."""
    if count > _MOST_UNROLLED:
        raise SubsetError(f"{count} items to be unrolled", "write a loop over a range")
    return True


def lasting_items(code: Code, value: Value) -> tuple[Value, ...]:
    """Return the items of a value that is gone through in steps, between which others run.

    Raises:
        SubsetError: they are computed in the same steps, or may change in between.
    """
    is_written = isinstance(value, Array) and len(value.lengths) == 1 and not value.is_constant
    if is_written or (isinstance(value, Group) and value.made_by is Generated):
        raise SubsetError(
            f"a loop over {in_words(type_of(value))}", "make a tuple of it, or loop over a range"
        )
    return items_of(code, value)


# --------------------------------------------------------------------------------- items by indices


def element(code: Code, value: Value, indices: list[Index]) -> Value:
    """Return an item of a tuple, or an element or a part of an array."""
    if isinstance(value, Static) and isinstance(value.object, np.ndarray):
        value = code.declared.array(value.object)
    if isinstance(value, Array):
        found = part_of(code, value, indices)
        return found if found.lengths else code.load(Number(found.kind, found.pointer))
    if len(indices) > 1:
        raise SubsetError(f"{len(indices)} indices of a tuple", "give one")
    (index,) = indices
    if isinstance(value, Static):
        if isinstance(index, Static):
            return static_result(lambda: value.object[index.object])
        if not isinstance(value.object, (tuple, list, range)):
            raise SubsetError(f"such an index of {in_words(value)}", "give a tuple or an array")
    if is_iterator(value):
        raise SubsetError("an index of an iterator", "make a tuple of it")
    return _item(code, items_of(code, value), index)


def _item(code: Code, items: tuple[Value, ...], index: Index) -> Value:
    """Return an item of a tuple, or several as a tuple."""
    if isinstance(index, Slice):
        ends = (None if end is None else _known(end) for end in index)
        return Group(None, items[slice(*ends)])
    number = code.whole(index, "an index")
    known = known_number(number)
    if known is not None or not items:
        return items[_checked(known or 0, len(items))]
    is_inside(code, number, len(items))
    found = at_run_time(items[-1])
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
    inside: Static | Number = Static(True)
    lengths: list[int | Number] = []
    strides: list[int] = []
    given = [*indices, *[Slice(None, None)] * (dimensions - len(indices))]
    for index, length, stride in zip(given, array.lengths, array.strides, strict=True):
        if isinstance(index, Slice):
            first, count = _range_of(code, index, length)
            lengths.append(count)
            strides.append(stride)
        else:
            first = _index(code, index, length)
            inside = both(code, "and", inside, is_inside(code, first, length))
        offset = _further(code, offset, first, stride)
    address = code.address(array, offset)
    if isinstance(inside, Number):
        address = code.instead(inside, address)
    return array._replace(pointer=address, lengths=tuple(lengths), strides=tuple(strides))


def is_inside(code: Code, index: Value, length: int | Number) -> Static | Number:
    """Return whether an index exists; tell if it does not. Only ``CHECKED`` code finds out."""
    is_known = isinstance(index, Static) and isinstance(length, int)
    if is_known or not code.declared.checked:
        return Static(True)
    return code.checked(code.number(index), code.number(_length(length)))


def _further(code: Code, offset: Value, count: Value, stride: int) -> Value:
    """Return an offset in an array plus a number of strides."""
    term = count if stride == 1 else operate(code, ast.Mult, count, Static(stride))
    is_first = isinstance(offset, Static) and offset.object == 0
    return term if is_first else operate(code, ast.Add, offset, term)


def length_of(value: Value) -> Value:
    """Return the length of a tuple or an array."""
    if isinstance(value, Group) and not is_iterator(value):
        return Static(len(value.items))
    if isinstance(value, Array):
        return _length(value.lengths[0])
    raise SubsetError(f"the length of {in_words(type_of(value))}", "give a tuple or an array")


def _length(length: int | Number) -> Value:
    return Static(length) if isinstance(length, int) else length


def _range_of(code: Code, index: Slice, length: int | Number) -> tuple[Value, int | Number]:
    """Return the first index of a slice, and the number of those that follow it, as Python does."""
    first = Static(0) if index.first is None else _end_of(code, index.first, length)
    end = _length(length) if index.end is None else _end_of(code, index.end, length)
    if isinstance(first, Static) and isinstance(end, Static):
        return first, max(end.object - first.object, 0)
    if isinstance(first, Static) and first.object == 0:
        return first, code.number(end)
    count = code.whole(operate(code, ast.Sub, end, first), "a length")
    return first, _larger(code, count, constant(0))


def _end_of(code: Code, index: Value, length: int | Number) -> Value:
    """Return an end of a slice between 0 and the length; from the end, if it is negative."""
    number = _whole_index(code, index)
    known = known_number(number)
    if known is not None and (isinstance(length, int) or known == 0):
        return Static(slice(known).indices(length)[1] if isinstance(length, int) else 0)
    count = code.number(_length(length))
    if known is None or known < 0:
        below = code.compare("lt", number, constant(0))
        moved = code.select(below, code.integers("add", number, count), number)
        number = _larger(code, code.number(moved), constant(0))
    return code.select(code.compare("lt", number, count), number, count)


def _larger(code: Code, one: Number, other: Number) -> Number:
    return code.number(code.select(code.compare("lt", one, other), other, one))


def _whole_index(code: Code, index: Value) -> Number:
    number = code.number(index, "an index")
    if number.kind != INTEGER:
        raise SubsetError(f"{in_words(type_of(number))} as an index", "take int(...) of it")
    return number


def _index(code: Code, index: Value, length: int | Number) -> Value:
    """Return an index of an array, counted from the beginning; static if it is known."""
    number = _whole_index(code, index)
    known = known_number(number)
    if known is None:
        return number
    if known < 0 and not isinstance(length, int):
        raise SubsetError(f"the index {known} of an array", "count from the beginning")
    return Static(_checked(known, length) if isinstance(length, int) else int(known))


def _checked(index: int, length: int) -> int:
    """Return an index that is known, counted from the beginning."""
    if not -length <= index < length:
        raise SubsetError(f"the index {index} of {length} items", "give one that exists")
    return index % length


def _known(index: Value) -> int:
    """Return the end of a slice of a tuple, which must be known."""
    number = at_run_time(index)
    known = known_number(number) if isinstance(number, Number) else None
    if known is None:
        raise SubsetError("such a slice of a tuple", "give ends that are known ints")
    return int(known)
