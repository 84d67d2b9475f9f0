"""Functions of Python, ``math`` and numpy that a kernel may call."""

import math
from collections.abc import Callable
from inspect import signature
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.compile.arithmetic import both, truth_of
from model.compile.code import PYTHON_KINDS, Code
from model.compile.items import is_inside, items_of, lasting_items, length_of, member, part_of
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    NOTHING,
    Array,
    Group,
    Number,
    Once,
    Static,
    SubsetError,
    Value,
    constant,
    in_words,
    known_objects,
    static_result,
    type_of,
)
from model.compile.vector_code import WIDTH, VectorFunction, call_at


def _converted(kind: str) -> Callable[..., Value]:
    return lambda code, value: code.of_kind(value, kind)


def _function(name: str) -> Callable[..., Value]:
    """Make the call of a function of floats that LLVM knows."""
    return lambda code, value: code.intrinsic(name, value)


def _abs(code: Code, value: Value) -> Value:
    number = code.widened(value, value, INTEGER)[0]
    if number.kind == DOUBLE:
        return code.intrinsic("fabs", number)
    return Number(INTEGER, code.do(f"call i64 @llvm.abs.i64(i64 {number.name}, i1 false)"))


def _extreme(how: str) -> Callable[..., Value]:
    """Make ``min`` or ``max``: a later argument replaces an earlier one only if it is beyond it."""

    def call(code: Code, *values: Value) -> Value:
        listed = items_of(code, values[0]) if len(values) == 1 else values
        if not listed:
            raise SubsetError("the extreme of nothing", "give a number at least")
        found: Value = code.number(listed[0])
        for value in listed[1:]:
            a, b = code.widened(found, value, INTEGER)
            found = code.select(code.compare(how, b, a), b, a)
        return found

    return call


def _is_nan(code: Code, value: Value) -> Value:
    number = code.of_kind(value, DOUBLE).name
    return Number(BOOLEAN, code.do(f"fcmp uno double {number}, 0.0"))


def _is_finite(code: Code, value: Value) -> Value:
    return code.compare("lt", code.intrinsic("fabs", value), constant(math.inf))


def _where(code: Code, condition: Value, yes: Value, no: Value) -> Value:
    return code.select(code.of_kind(condition, BOOLEAN), code.number(yes), code.number(no))


def _tuple(code: Code, value: Value) -> Value:
    return Group(None, items_of(code, value))


def _zip(code: Code, *values: Value) -> Value:
    lists = [lasting_items(code, each) for each in values]
    if len({len(each) for each in lists}) > 1:
        raise SubsetError(
            f"zip of {', '.join(str(len(each)) for each in lists)} items", "give the same number"
        )
    return Group(Once, tuple(Group(None, each) for each in zip(*lists, strict=True)))


def _enumerate(code: Code, value: Value) -> Value:
    pairs = enumerate(lasting_items(code, value))
    return Group(Once, tuple(Group(None, (Static(n), each)) for n, each in pairs))


def _reversed(code: Code, value: Value) -> Value:
    return Group(Once, lasting_items(code, value)[::-1])


def _range(_code: Code, *values: Value) -> Value:
    if not all(isinstance(each, Static) for each in values):
        raise SubsetError("a range of run time here", "loop over it by a for statement")
    return static_result(range, *(each.object for each in values))  # type: ignore[union-attr]


def _getattr(code: Code, value: Value, name: Value) -> Value:
    if not (isinstance(name, Static) and isinstance(name.object, str)):
        raise SubsetError("a member that is chosen at run time", "choose it by an if")
    return member(code, value, name.object)


def _isinstance(_code: Code, value: Value, kind: Value) -> Value:
    kinds, known = known_objects([kind]), known_objects([value])
    if kinds is None:
        raise SubsetError("isinstance of a class that is not known", "name the class")
    if known is not None:
        return static_result(isinstance, *known, *kinds)
    if isinstance(value, Number):
        return static_result(issubclass, PYTHON_KINDS[value.kind], *kinds)
    made_by = value.made_by or tuple if isinstance(value, Group) else np.ndarray
    return static_result(issubclass, made_by, *kinds)


def _several(how: str) -> Callable[..., Value]:
    """Make ``any`` or ``all``, which compute all their items."""

    def call(code: Code, values: Value) -> Value:
        found: Static | Number = Static(how == "and")
        for each in items_of(code, values):
            found = both(code, how, found, truth_of(code, each))
        return found

    return call


def fetch_add(numbers: NDArray[np.int64], by: int) -> int:
    """Add to the first of ``numbers`` and return what it was before; at once, between threads."""
    before = int(numbers[0])
    numbers[0] += by
    return before


def _fetch_add(code: Code, numbers: Value, by: Value) -> Value:
    if not (isinstance(numbers, Array) and numbers.kind == INTEGER) or numbers.is_constant:
        found = in_words(type_of(numbers))
        raise SubsetError(f"fetch_add to {found}", "give an array of int64 of run time")
    inside = is_inside(code, constant(0), numbers.lengths[0])
    number, pointer = code.whole(by, "a count").name, numbers.pointer
    if isinstance(inside, Number):
        pointer = code.instead(inside, pointer)
    text = f"atomicrmw add ptr {pointer}, i64 {number} monotonic"
    return Number(INTEGER, code.do(text))


def vectors_at(code: Code, block: Value, rows: Value) -> list[str]:
    """Return the addresses of vectors: of rows of an array, by their numbers."""
    if not isinstance(block, Array) or block.kind != DOUBLE or block.lengths[1:] != (WIDTH,):
        remedy = f"give an array of floats, of shape (n, {WIDTH})"
        raise SubsetError(f"vectors in {in_words(type_of(block))}", remedy)
    return [part_of(code, block, [each]).pointer for each in items_of(code, rows)]


def _call_at(code: Code, address: Value, block: Value, rows: Value) -> Value:
    target = code.do(f"inttoptr i64 {code.whole(address, 'an address').name} to ptr")
    code.call_vectors(target, vectors_at(code, block, rows))
    return NOTHING


_BUILTINS: dict[Any, Callable[..., Value]] = {
    abs: _abs,
    any: _several("or"),
    all: _several("and"),
    min: _extreme("lt"),
    max: _extreme("gt"),
    int: _converted(INTEGER),
    np.int64: _converted(INTEGER),
    float: _converted(DOUBLE),
    np.float64: _converted(DOUBLE),
    bool: _converted(BOOLEAN),
    math.sqrt: _function("sqrt"),
    math.floor: _function("floor"),
    math.isnan: _is_nan,
    np.isnan: _is_nan,
    math.isfinite: _is_finite,
    np.where: _where,
    len: lambda _code, value: length_of(value),
    tuple: _tuple,
    zip: _zip,
    enumerate: _enumerate,
    reversed: _reversed,
    range: _range,
    fetch_add: _fetch_add,
    getattr: _getattr,
    isinstance: _isinstance,
    call_at: _call_at,
}
_NEVER_STATIC = (call_at, enumerate, fetch_add, np.where, reversed, zip)


def is_builtin(function: Any) -> bool:
    """Return whether a kernel may call a function that is no kernel."""
    try:
        return function in _BUILTINS or isinstance(function, VectorFunction)
    except TypeError:  # it has no hash
        return False


def call_builtin(
    code: Code, function: Any, arguments: list[Value], named: dict[str, Value]
) -> Value:
    """Return the result of a function that ``is_builtin``; only ``zip`` has named arguments."""
    name = function.name if isinstance(function, VectorFunction) else function.__name__
    if {*named} - ({"strict"} if function is zip else set()):
        raise SubsetError(f"{name} with {', '.join(named)}", "pass values by position")
    write = _BUILTINS.get(function, _call_vectors(function))
    try:
        signature(write).bind(code, *arguments)
    except TypeError as error:
        raise SubsetError(f"{name}: {error}", "pass what it takes") from None
    known = known_objects(arguments)
    if known is not None and function in _BUILTINS and function not in _NEVER_STATIC:
        return static_result(function, *known)
    return write(code, *arguments)


def _call_vectors(function: VectorFunction) -> Callable[..., Value]:
    def call(code: Code, block: Value, rows: Value) -> Value:
        code.call_vectors(function, vectors_at(code, block, rows))
        return NOTHING

    return call
