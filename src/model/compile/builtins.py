"""Functions of Python, ``math`` and numpy that a kernel may call."""

import math
from collections.abc import Callable
from inspect import signature
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from model.compile.arithmetic import both, truth_of
from model.compile.code import PYTHON_KINDS, Code
from model.compile.indexing import length_of
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    Array,
    Group,
    Number,
    Static,
    SubsetError,
    Value,
    constant,
    in_words,
    type_of,
)


class Caller(Protocol):
    """The expressions in which a function is called."""

    code: Code

    def items(self, value: Value) -> tuple[Value, ...]:
        """Return the items of a value."""

    def member(self, value: Value, name: str) -> Value:
        """Return a member of a value."""


def _converted(kind: str) -> Callable[..., Value]:
    return lambda caller, value: caller.code.of_kind(value, kind)


def _function(name: str) -> Callable[..., Value]:
    """Make the call of a function of floats that LLVM knows."""

    def call(caller: Caller, value: Value) -> Value:
        code = caller.code
        number = code.of_kind(value, DOUBLE).name
        text = f"call{code.contract} double @llvm.{name}.f64(double {number})"
        return Number(DOUBLE, code.do(text))

    return call


_absolute = _function("fabs")


def _abs(caller: Caller, value: Value) -> Value:
    number = caller.code.number(value)
    if number.kind == DOUBLE:
        return _absolute(caller, number)
    whole = caller.code.of_kind(number, INTEGER)
    return Number(INTEGER, caller.code.do(f"call i64 @llvm.abs.i64(i64 {whole.name}, i1 false)"))


def _extreme(how: str) -> Callable[..., Value]:
    """Make ``min`` or ``max``: a later argument replaces an earlier one only if it is beyond it."""

    def call(caller: Caller, *values: Value) -> Value:
        first, *others = caller.items(values[0]) if len(values) == 1 else values
        found: Value = caller.code.number(first)
        for value in others:
            a, b = caller.code.widened(found, value, INTEGER)
            found = caller.code.select(caller.code.compare(how, b, a), b, a)
        return found

    return call


def _is_nan(caller: Caller, value: Value) -> Value:
    number = caller.code.of_kind(value, DOUBLE).name
    return Number(BOOLEAN, caller.code.do(f"fcmp uno double {number}, 0.0"))


def _is_finite(caller: Caller, value: Value) -> Value:
    return caller.code.compare("lt", _absolute(caller, value), constant(math.inf))


def _where(caller: Caller, condition: Value, yes: Value, no: Value) -> Value:
    return caller.code.select(caller.code.of_kind(condition, BOOLEAN), yes, no)


def _len(_caller: Caller, value: Value) -> Value:
    if isinstance(value, Group):
        return Static(len(value.items))
    if isinstance(value, Array):
        return length_of(value.lengths[0])
    raise SubsetError(f"the length of {in_words(type_of(value))}", "give a tuple or an array")


def _tuple(caller: Caller, value: Value) -> Value:
    return Group(None, caller.items(value))


def _zip(caller: Caller, *values: Value) -> Value:
    lists = [caller.items(each) for each in values]
    if len({len(each) for each in lists}) > 1:
        raise SubsetError(
            f"zip of {', '.join(str(len(each)) for each in lists)} items", "give the same number"
        )
    return Group(None, tuple(Group(None, each) for each in zip(*lists, strict=True)))


def _enumerate(caller: Caller, value: Value) -> Value:
    pairs = enumerate(caller.items(value))
    return Group(None, tuple(Group(None, (Static(n), each)) for n, each in pairs))


def _reversed(caller: Caller, value: Value) -> Value:
    return Group(None, caller.items(value)[::-1])


def _getattr(caller: Caller, value: Value, name: Value) -> Value:
    if not isinstance(name, Static):
        raise SubsetError("a member that is chosen at run time", "choose it by an if")
    return caller.member(value, name.object)


def _isinstance(_caller: Caller, value: Value, kind: Value) -> Value:
    if not isinstance(kind, Static):
        raise SubsetError("isinstance of a class that is not known", "name the class")
    if isinstance(value, Number):
        return Static(PYTHON_KINDS[value.kind] is kind.object)
    made_by = value.made_by or tuple if isinstance(value, Group) else np.ndarray
    return Static(issubclass(made_by, kind.object))


def _several(how: str) -> Callable[..., Value]:
    """Make ``any`` or ``all``, which compute all their items."""

    def call(caller: Caller, values: Value) -> Value:
        found: Static | Number = Static(how == "and")
        for each in caller.items(values):
            found = both(caller.code, how, found, truth_of(caller.code, each))
        return found

    return call


def fetch_add(numbers: NDArray[np.int64], by: int) -> int:
    """Add to the first of ``numbers`` and return what it was before; at once, between threads."""
    before = int(numbers[0])
    numbers[0] += by
    return before


def _fetch_add(caller: Caller, numbers: Value, by: Value) -> Value:
    if not (isinstance(numbers, Array) and numbers.kind == INTEGER):
        raise SubsetError(f"fetch_add to {in_words(type_of(numbers))}", "give an array of int64")
    number = caller.code.of_kind(by, INTEGER).name
    text = f"atomicrmw add ptr {numbers.pointer}, i64 {number} monotonic"
    return Number(INTEGER, caller.code.do(text))


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
    len: _len,
    tuple: _tuple,
    zip: _zip,
    enumerate: _enumerate,
    reversed: _reversed,
    range: lambda _caller, *_: _refuse_range(),
    fetch_add: _fetch_add,
    getattr: _getattr,
    isinstance: _isinstance,
}


def _refuse_range() -> Value:
    raise SubsetError("a range of run time here", "loop over it by a for statement")


def is_builtin(function: Any) -> bool:
    """Return whether a kernel may call a function that is no kernel."""
    try:
        return function in _BUILTINS
    except TypeError:
        return False


def call_builtin(
    function: Any, arguments: list[Value], named: dict[str, Value], caller: Caller
) -> Value:
    """Return the result of a function that ``is_builtin``; only ``zip`` has named arguments."""
    if {*named} - ({"strict"} if function is zip else set()):
        raise SubsetError(f"{function.__name__} with {', '.join(named)}", "pass values by position")
    write = _BUILTINS[function]
    try:
        signature(write).bind(caller, *arguments)
    except TypeError as error:
        raise SubsetError(f"{function.__name__}: {error}", "pass what it takes") from None
    return write(caller, *arguments)
