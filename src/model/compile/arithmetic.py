"""Arithmetic, comparisons and conditions: static where all values are known, else code."""

import ast
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from model.compile.code import Code
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    Group,
    Number,
    Static,
    SubsetError,
    Value,
    constant,
    known_number,
    static_result,
)

_ARITHMETIC = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div"}
_BITS = {
    ast.BitAnd: "and", ast.BitOr: "or", ast.BitXor: "xor", ast.LShift: "shl", ast.RShift: "ashr",
}  # fmt: skip
_PYTHON: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.Pow: operator.pow,
    ast.BitAnd: operator.and_, ast.BitOr: operator.or_, ast.BitXor: operator.xor,
    ast.LShift: operator.lshift, ast.RShift: operator.rshift,
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Invert: operator.invert,
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le,
    ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip
_COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Eq: "eq", ast.NotEq: "ne", ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge",
}  # fmt: skip
_MOST_FACTORS = 64  # of a power that is written as a product
_BITS_OF_INTEGER = 64


def operate(code: Code, how: type[ast.operator], a: Value, b: Value) -> Value:
    """Return the result of an operation on two values."""
    if how not in _PYTHON:
        raise SubsetError(f"the operator {how.__name__}", "write it out in sums and products")
    if isinstance(a, Static) and isinstance(b, Static):
        return static_result(_PYTHON[how], a.object, b.object)
    if isinstance(a, Group) or isinstance(b, Group):
        raise SubsetError("arithmetic on tuples", "compute item by item, or write (*a, *b)")
    if how in _ARITHMETIC:
        return code.arithmetic(_ARITHMETIC[how], a, b)
    if how is ast.Pow:
        return _power(code, a, b)
    if how in (ast.FloorDiv, ast.Mod):
        return _floored(code, how, a, b)
    shift = known_number(code.number(b)) if how in (ast.LShift, ast.RShift) else None
    if shift is not None and not 0 <= shift < _BITS_OF_INTEGER:
        raise SubsetError(f"a shift by {shift}", f"shift by 0 to {_BITS_OF_INTEGER - 1}")
    return code.integers(_BITS[how], a, b)


def _power(code: Code, base: Value, exponent: Value) -> Value:
    """Return a power: a product for whole exponents that are known, else as C's ``pow``."""
    count = exponent.object if isinstance(exponent, Static) else None
    if type(count) is int and 0 < count <= _MOST_FACTORS:
        return _product(code, code.widened(base, base, INTEGER)[0], count)
    if code.number(base).kind != DOUBLE and code.number(exponent).kind != DOUBLE:
        raise SubsetError("a power of two ints", "make one of them a float")
    return code.intrinsic("pow", base, exponent)


def _product(code: Code, base: Number, count: int) -> Number:
    """Return the product of ``count`` equal factors, by repeated squaring."""
    if count == 1:
        return base
    rest = _product(code, code.arithmetic("mul", base, base), count // 2)
    return code.arithmetic("mul", rest, base) if count % 2 else rest


def _floored(code: Code, how: type[ast.operator], a: Value, b: Value) -> Value:
    """Return the quotient or the remainder of two ints, rounded down as Python does."""
    if DOUBLE in (code.number(a).kind, code.number(b).kind):
        raise SubsetError("// or % of a float", "write floor(a / b), or a - floor(a / b) * b")
    top, bottom = code.of_kind(a, INTEGER), code.of_kind(b, INTEGER)
    if known_number(bottom) == 0:
        raise SubsetError("a division by 0", "divide by another number")
    rest = code.integers("srem", top, bottom)
    differ = code.compare("lt", code.integers("xor", rest, bottom), constant(0))
    below = code.integers("and", differ, code.compare("ne", rest, constant(0)))
    if how is ast.Mod:
        return code.select(below, code.integers("add", rest, bottom), rest)
    return code.integers("sub", code.integers("sdiv", top, bottom), below)


def signed(code: Code, how: type[ast.unaryop], value: Value) -> Value:
    """Return ``-value``, ``+value`` or ``~value``."""
    if isinstance(value, Static) and not isinstance(value.object, tuple):
        return static_result(_PYTHON[how], value.object)
    number = code.widened(value, value, INTEGER)[0]
    if how is ast.UAdd:
        return number
    if how is ast.Invert:
        return code.integers("xor", number, constant(-1))
    if number.kind == DOUBLE:
        return Number(DOUBLE, code.do(f"fneg{code.contract} double {number.name}"))
    return code.integers("sub", constant(0), number)


# -------------------------------------------------------------------------------------- conditions


def truth_of(code: Code, value: Value) -> Static | Number:
    """Return whether a value counts as true, static if it is known."""
    if isinstance(value, Static):
        return static_result(bool, value.object)
    if isinstance(value, Group):
        return Static(bool(value.items))
    return code.of_kind(value, BOOLEAN)


def boolean(value: Value) -> Static | Number:
    """Return an operand of ``and`` and ``or``, which must be a boolean."""
    is_known = isinstance(value, Static) and isinstance(value.object, (bool, np.bool_))
    if is_known or (isinstance(value, Number) and value.kind == BOOLEAN):
        return value  # type: ignore[return-value]
    raise SubsetError("`and` or `or` of what is no bool", "compare it: x != 0, x is not None")


def negation(code: Code, truth: Static | Number) -> Static | Number:
    """Return the negation of a truth."""
    if isinstance(truth, Static):
        return Static(not truth.object)
    return code.integers("xor", truth, constant(True))


def both(code: Code, how: str, one: Static | Number, other: Static | Number) -> Static | Number:
    """Return "and" or "or" of two truths, both of which are computed."""
    for known, rest in ((one, other), (other, one)):
        if isinstance(known, Static):
            return rest if known.object == (how == "and") else known
    return code.integers(how, one, other)


def compared(code: Code, how: ast.cmpop, a: Value, b: Value) -> Static | Number:
    """Return the truth of a comparison of two values, other than ``in``."""
    if isinstance(how, (ast.Is, ast.IsNot)):
        return Static(_is_same(a, b) == isinstance(how, ast.Is))
    if isinstance(a, Static) and isinstance(b, Static):
        return static_result(lambda: bool(_PYTHON[type(how)](a.object, b.object)))
    if isinstance(a, Group) or isinstance(b, Group):
        raise SubsetError("a comparison of tuples", "compare item by item")
    return code.compare(_COMPARISONS[type(how)], a, b)


def _is_same(a: Value, b: Value) -> bool:
    """Return whether two values, one of which must be None, are the same object."""
    is_none = [isinstance(each, Static) and each.object is None for each in (a, b)]
    if not any(is_none):
        raise SubsetError("`is` without None", "write ==")
    return all(is_none)
