"""Arithmetic and comparisons of values: static where both are known, else code."""

import ast
import operator
from collections.abc import Callable
from typing import Any

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
    is_number,
)

_ARITHMETIC = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div"}
_BITS = {
    ast.BitAnd: "and", ast.BitOr: "or", ast.BitXor: "xor", ast.LShift: "shl", ast.RShift: "ashr",
}  # fmt: skip
_PYTHON: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.Pow: operator.pow,
    ast.BitAnd: operator.and_, ast.BitOr: operator.or_, ast.BitXor: operator.xor,
    ast.LShift: operator.lshift, ast.RShift: operator.rshift,
}  # fmt: skip
_COMPARISONS: dict[type[ast.cmpop], tuple[str, Callable[[Any, Any], Any]]] = {
    ast.Eq: ("eq", operator.eq), ast.NotEq: ("ne", operator.ne), ast.Lt: ("lt", operator.lt),
    ast.LtE: ("le", operator.le), ast.Gt: ("gt", operator.gt), ast.GtE: ("ge", operator.ge),
}  # fmt: skip
_SIGNS: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Invert: operator.invert,
}  # fmt: skip
_MOST_FACTORS = 64  # of a power that is written as a product


def operate(code: Code, how: type[ast.operator], a: Value, b: Value) -> Value:
    """Return the result of an operation on two values."""
    if isinstance(a, Static) and isinstance(b, Static):
        try:
            return Static(_PYTHON[how](a.object, b.object))
        except (ArithmeticError, TypeError, KeyError, ValueError) as error:
            raise SubsetError(str(error), "compute what is defined") from None
    if isinstance(a, Group) or isinstance(b, Group):
        if how is not ast.Add or not (isinstance(a, Group) and isinstance(b, Group)):
            raise SubsetError("arithmetic on tuples", "compute item by item; + joins two tuples")
        return Group(None, (*a.items, *b.items))
    if how in _ARITHMETIC:
        neutral = _without_effect(how, a, b)
        return code.arithmetic(_ARITHMETIC[how], a, b) if neutral is None else neutral
    if how in _BITS:
        return code.whole(_BITS[how], a, b)
    if how is ast.Pow:
        return _power(code, a, b)
    if how in (ast.FloorDiv, ast.Mod):
        return _floored(code, how, a, b)
    raise SubsetError(f"the operator {how.__name__}", "write it out in sums and products")


def _without_effect(how: type[ast.operator], a: Value, b: Value) -> Value | None:
    """Return the other number where one is the int 0 or 1 and changes nothing; else None.

    Only of ints: 0 + x is not x where x is -0.0.
    """
    for known, other in ((a, b), (b, a)):
        if isinstance(known, Static) and type(known.object) is int:
            if not (isinstance(other, Number) and other.kind == INTEGER):
                continue
            if known.object == (how is ast.Mult) and how in (ast.Add, ast.Mult):
                return other
            if how is ast.Sub and known is b and known.object == 0:
                return other
    return None


def _power(code: Code, base: Value, exponent: Value) -> Value:
    """Return a power: a product for whole exponents that are known, else as C's ``pow``."""
    if isinstance(exponent, Static) and exponent.object in range(1, _MOST_FACTORS + 1):
        return _product(code, code.number(base), int(exponent.object))
    if code.number(base).kind != DOUBLE and code.number(exponent).kind != DOUBLE:
        raise SubsetError("a power of two ints", "make one of them a float")
    a, b = (code.of_kind(each, DOUBLE).name for each in (base, exponent))
    text = f"call{code.contract} double @llvm.pow.f64(double {a}, double {b})"
    return Number(DOUBLE, code.do(text))


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
    rest = code.whole("srem", top, bottom)
    differ = code.compare("lt", code.whole("xor", rest, bottom), constant(0))
    below = code.whole("and", differ, code.compare("ne", rest, constant(0)))
    if how is ast.Mod:
        return code.select(below, code.whole("add", rest, bottom), rest)
    return code.whole("sub", code.whole("sdiv", top, bottom), code.of_kind(below, INTEGER))


def signed(code: Code, how: type[ast.unaryop], value: Value) -> Value:
    """Return ``-value``, ``+value`` or ``~value``."""
    if isinstance(value, Static) and is_number(value.object):
        return Static(_SIGNS[how](value.object))
    number = code.number(value)
    if number.kind == BOOLEAN:
        number = code.of_kind(number, INTEGER)
    if how is ast.UAdd:
        return number
    if how is ast.Invert:
        return code.whole("xor", number, constant(-1))
    if number.kind == DOUBLE:
        return Number(DOUBLE, code.do(f"fneg{code.contract} double {number.name}"))
    return code.whole("sub", constant(0), number)


# -------------------------------------------------------------------------------------- conditions


def truth_of(code: Code, value: Value) -> Static | Number:
    """Return whether a value counts as true, static if it is known."""
    if isinstance(value, Static):
        return Static(bool(value.object))
    if isinstance(value, Group):
        return Static(bool(value.items))
    return code.of_kind(value, BOOLEAN)


def negation(code: Code, truth: Static | Number) -> Static | Number:
    """Return the negation of a truth."""
    if isinstance(truth, Static):
        return Static(not truth.object)
    return code.whole("xor", truth, constant(True))


def both(code: Code, how: str, one: Static | Number, other: Static | Number) -> Static | Number:
    """Return "and" or "or" of two truths, both of which are computed."""
    for known, rest in ((one, other), (other, one)):
        if isinstance(known, Static):
            return rest if known.object == (how == "and") else known
    return code.whole(how, one, other)


def compared(code: Code, how: ast.cmpop, a: Value, b: Value) -> Static | Number:
    """Return the truth of a comparison of two values, other than ``in``."""
    if isinstance(how, (ast.Is, ast.IsNot)):
        if not (isinstance(a, Static) or isinstance(b, Static)):
            raise SubsetError("`is` between values of run time", "write ==")
        same = isinstance(a, Static) and isinstance(b, Static) and a.object is b.object
        return Static(same == isinstance(how, ast.Is))
    name, python = _COMPARISONS[type(how)]
    if isinstance(a, Static) and isinstance(b, Static):
        return Static(bool(python(a.object, b.object)))
    if isinstance(a, Group) or isinstance(b, Group):
        raise SubsetError("a comparison of tuples", "compare item by item")
    return code.compare(name, a, b)
