"""Expressions of a kernel: from a node of Python's syntax tree to a ``Value`` and its code."""

import ast
import operator
from collections.abc import Callable
from typing import Any, ClassVar, Protocol

import numpy as np

from model.compile.builtins import call_builtin, is_builtin
from model.compile.code import Code
from model.compile.kernels import marks_of
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    Array,
    Group,
    Number,
    Refusal,
    Static,
    Value,
    at_run_time,
    constant,
    contiguous,
    in_words,
    is_number,
    joined,
    known_number,
    type_of,
)
from model.compile.vector_code import WIDTH, VectorFunction, call_at

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
_MOST_FACTORS = 64  # of a power that is written as a product
_LONGEST_SHOWN = 60  # characters of an expression in an error
_MOST_UNROLLED = 1024  # items of a comprehension or a loop over static items


class Scope(Protocol):
    """What expressions need of the function in which they stand."""

    code: Code
    names: dict[str, Any]

    def look_up(self, name: str) -> Value:
        """Return the value of a name."""

    def bind(self, target: ast.expr, value: Value) -> None:
        """Bind the target of a comprehension."""

    def call(self, function: Any, arguments: list[Value], named: dict[str, Value]) -> Value:
        """Call a kernel."""

    def call_vectors(self, function: VectorFunction, pointers: list[str]) -> None:
        """Call a function of vectors."""

    def array(self, known: Any) -> Array:
        """Return an array of numpy as constants of the module."""


class Expressions:
    """Translates the expressions of one function."""

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.code = scope.code

    def evaluate(self, node: ast.expr) -> Value:
        """Translate an expression and return its value."""
        try:
            if type(node) not in self._translations:
                raise Refusal(f"{_shown(node)} in a kernel", "use the expressions of the subset")
            found: Value = self._translations[type(node)](self, node)
        except Refusal as refusal:
            refusal.node = getattr(refusal, "node", None) or node
            raise
        return found

    def condition(self, node: ast.expr) -> Static | Number:
        """Translate an expression and return its truth, static if it is known."""
        return self._truth(self.evaluate(node))

    def items(self, value: Value) -> tuple[Value, ...]:
        """Return the items of a tuple, a static sequence or an array of known length."""
        if isinstance(value, Group):
            return value.items
        if isinstance(value, Static):
            if isinstance(value.object, np.ndarray):
                return self.items(self.scope.array(value.object))
            try:
                found = tuple(Static(each) for each in value.object)
            except TypeError:
                raise Refusal(f"{in_words(type_of(value))} has no items", "give a tuple") from None
            if len(found) > _MOST_UNROLLED:
                raise Refusal(f"{len(found)} items to be unrolled", "write a loop over a range")
            return found
        if isinstance(value, Array) and isinstance(value.lengths[0], int):
            return tuple(self.element(value, [Static(n)]) for n in range(value.lengths[0]))
        raise Refusal(
            f"the items of {in_words(type_of(value))}", "loop over a range, or give a tuple"
        )

    # -------------------------------------------------------------------------- names and members

    def _constant(self, node: ast.Constant) -> Value:
        return Static(node.value)

    def _name(self, node: ast.Name) -> Value:
        return self.scope.look_up(node.id)

    def _attribute(self, node: ast.Attribute) -> Value:
        return self.member(self.evaluate(node.value), node.attr)

    def member(self, value: Value, name: str) -> Value:
        """Return a member of a named tuple, of an array or of a static object."""
        if isinstance(value, Group):
            fields = getattr(value.made_by, "_fields", ())
            if name in fields:
                return value.items[fields.index(name)]
            if name == "_replace" and fields:
                return Static(_Method(value, name))
        elif isinstance(value, Array):
            if name == "shape":
                return Group(None, tuple(map(_length, value.lengths)))
            if name == "size":
                size: Value = _length(value.lengths[0])
                for length in value.lengths[1:]:
                    size = self.operate(ast.Mult, size, _length(length))
                return size
            if name in ("reshape", "view"):
                return Static(_Method(value, name))
        elif isinstance(value, Static) and hasattr(value.object, name):
            found = getattr(value.object, name)
            is_method = name == "_replace" and isinstance(value.object, tuple)
            return Static(_Method(at_run_time(value), name)) if is_method else Static(found)
        elif isinstance(value, Number) and name == "view":
            return Static(_Method(value, name))
        raise Refusal(f"{in_words(type_of(value))} has no {name!r}", "name a field that it has")

    # -------------------------------------------------------------------------------- tuples, items

    def _tuple(self, node: ast.Tuple) -> Value:
        return Group(None, tuple(self.each(node.elts)))

    def each(self, nodes: list[ast.expr]) -> list[Value]:
        """Return the values of expressions; a starred one gives its items."""
        found: list[Value] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                found += self.items(self.evaluate(node.value))
            else:
                found.append(self.evaluate(node))
        return found

    def _comprehension(self, node: ast.GeneratorExp | ast.ListComp) -> Value:
        """A comprehension over static items, or over those of a tuple, is a tuple."""
        found: list[Value] = []
        names = dict(self.scope.names)

        def go_through(generators: list[ast.comprehension]) -> None:
            if not generators:
                found.append(self.evaluate(node.elt))
                return
            first, *rest = generators
            for item in self.items(self.evaluate(first.iter)):
                self.scope.bind(first.target, item)
                tests = [self.condition(each) for each in first.ifs]
                if not all(isinstance(each, Static) for each in tests):
                    raise Refusal(
                        "a comprehension that leaves out items at run time",
                        "test what is known when the kernel is compiled",
                    )
                if all(each.object for each in tests):  # type: ignore[union-attr]
                    go_through(rest)

        go_through(node.generators)
        self.scope.names = names
        return Group(None, tuple(found))

    def _subscript(self, node: ast.Subscript) -> Value:
        return self.element(self.evaluate(node.value), self.indices(node.slice))

    def indices(self, node: ast.expr) -> list[Any]:
        """Return the indices between brackets; of a slice, its two ends."""
        found: list[Any] = []
        for each in node.elts if isinstance(node, ast.Tuple) else [node]:
            if isinstance(each, ast.Slice):
                if each.step is not None:
                    raise Refusal("a slice with a step", "loop over a range with a step")
                ends = each.lower, each.upper
                found.append(tuple(None if end is None else self.evaluate(end) for end in ends))
            else:
                found.append(self.evaluate(each))
        return found

    def element(self, value: Value, indices: list[Any]) -> Value:
        """Return an item of a tuple, or an element or a part of an array."""
        if isinstance(value, Static) and isinstance(value.object, np.ndarray):
            value = self.scope.array(value.object)
        if isinstance(value, Array):
            found = self.part(value, indices)
            if isinstance(found, Array) and not found.lengths:
                return self.code.read(found)
            return found
        (index,) = indices if len(indices) == 1 else (Group(None, tuple(indices)),)
        if isinstance(value, Static) and isinstance(index, Static):
            try:
                return Static(value.object[index.object])
            except (LookupError, TypeError) as error:
                raise Refusal(f"{error} ({index.object!r})", "give an index that exists") from None
        items = self.items(value)
        if isinstance(index, tuple) and not isinstance(index, (Number, Group)):
            return Group(None, items[slice(*map(_known_index, index))])
        if isinstance(index, Static):
            return items[self._checked(index, len(items))]
        return self._selected(items, self.code.of_kind(index, INTEGER))

    def _selected(self, items: tuple[Value, ...], index: Number) -> Value:
        """Return the item at an index that is known at run time only."""
        found, earlier = at_run_time(items[-1]), list(enumerate(items))[:-1]
        for n, item in reversed(earlier):
            here = self.code.compare("eq", index, constant(n))
            found = self.code.select(here, at_run_time(item), found)
        return found

    @staticmethod
    def _checked(index: Static, length: int) -> int:
        """Return a static index from 0 on."""
        if isinstance(index.object, (bool, float)) or not is_number(index.object):
            raise Refusal(f"the index {index.object!r}", "give an int")
        found = int(index.object)
        if not -length <= found < length:
            raise Refusal(
                f"the index {found} of {length} items", f"give one from 0 to {length - 1}"
            )
        return found % length

    def part(self, array: Array, indices: list[Any]) -> Array:
        """Return the part of an array that indices select; an element is one of no dimension."""
        if len(indices) > len(array.lengths):
            raise Refusal(
                f"{len(indices)} indices of an array of {len(array.lengths)} dimensions",
                "give one for each dimension at most",
            )
        offset: Value = Static(0)
        lengths: list[int | Number] = []
        strides: list[int] = []
        given = [*indices, *[(None, None)] * (len(array.lengths) - len(indices))]
        for index, length, stride in zip(given, array.lengths, array.strides, strict=True):
            first = index
            if isinstance(index, tuple) and not isinstance(index, (Number, Group)):
                first, end = index
                first = Static(0) if first is None else first
                end = _length(length) if end is None else end
                count = at_run_time(self.operate(ast.Sub, end, first))
                known = known_number(count) if isinstance(count, Number) else None
                lengths.append(self.code.of_kind(count, INTEGER) if known is None else int(known))
                strides.append(stride)
            elif isinstance(index, Static) and isinstance(length, int):
                first = Static(self._checked(index, length))
            by = self.operate(ast.Mult, self._index(first), Static(stride))
            offset = self.operate(ast.Add, offset, by)
        return Array(
            self.code.address(array, offset), array.kind, tuple(lengths), tuple(strides)
        )  # fmt: skip

    def _index(self, value: Value) -> Value:
        if isinstance(value, Static):
            return value
        number = self.code.number(value, "an index")
        if number.kind == DOUBLE:
            raise Refusal("a float as an index", "take int(...) of it")
        return self.code.of_kind(number, INTEGER)

    # ---------------------------------------------------------------------------------- operations

    def _binary(self, node: ast.BinOp) -> Value:
        return self.operate(type(node.op), self.evaluate(node.left), self.evaluate(node.right))

    def operate(self, how: type[ast.operator], a: Value, b: Value) -> Value:
        """Return the result of an operation on two values."""
        if isinstance(a, Static) and isinstance(b, Static):
            try:
                return Static(_PYTHON[how](a.object, b.object))
            except (ArithmeticError, TypeError, KeyError, ValueError) as error:
                raise Refusal(str(error), "compute what is defined") from None
        if isinstance(a, Group) or isinstance(b, Group):
            if how is not ast.Add:
                raise Refusal("arithmetic on tuples", "compute item by item; + joins two tuples")
            return Group(None, (*self.items(a), *self.items(b)))
        if how in _ARITHMETIC:
            neutral = _without_effect(how, a, b)
            return self.code.arithmetic(_ARITHMETIC[how], a, b) if neutral is None else neutral
        if how in _BITS:
            return self.code.whole(_BITS[how], a, b)
        if how is ast.Pow:
            return self._power(a, b)
        if how in (ast.FloorDiv, ast.Mod):
            return self._floored(how, a, b)
        raise Refusal(f"the operator {how.__name__}", "write it out in sums and products")

    def _power(self, base: Value, exponent: Value) -> Value:
        """Return a power: a product for small whole exponents, else as C's ``pow``."""
        if isinstance(exponent, Static) and exponent.object in range(1, _MOST_FACTORS + 1):
            return self._product_of(base, int(exponent.object))
        if self.code.number(base).kind != DOUBLE and self.code.number(exponent).kind != DOUBLE:
            raise Refusal("a power of two ints", "make one of them a float")
        a, b = (self.code.of_kind(each, DOUBLE).name for each in (base, exponent))
        text = f"call{self.code.contract} double @llvm.pow.f64(double {a}, double {b})"
        return Number(DOUBLE, self.code.do(text))

    def _product_of(self, base: Value, count: int) -> Value:
        """Return the product of ``count`` equal factors, by repeated squaring."""
        found, square = None, base
        while count:
            if count & 1:
                found = square if found is None else self.code.arithmetic("mul", found, square)
            count >>= 1
            square = self.code.arithmetic("mul", square, square) if count else square
        return self.code.number(found)  # type: ignore[arg-type]

    def _floored(self, how: type[ast.operator], a: Value, b: Value) -> Value:
        """Return the quotient or the remainder of two ints, rounded down as Python does."""
        if DOUBLE in (self.code.number(a).kind, self.code.number(b).kind):
            raise Refusal(
                "// or % of a float", "write floor(a / b), or a - floor(a / b) * b"
            )  # fmt: skip
        code = self.code
        top, bottom = code.of_kind(a, INTEGER), code.of_kind(b, INTEGER)
        rest = code.whole("srem", top, bottom)
        differ = code.compare("lt", code.whole("xor", rest, bottom), constant(0))
        below = code.whole("and", differ, code.compare("ne", rest, constant(0)))
        if how is ast.Mod:
            return code.select(below, code.whole("add", rest, bottom), rest)
        whole = code.whole("sdiv", top, bottom)
        return code.whole("sub", whole, code.of_kind(below, INTEGER))

    def _unary(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            truth = self.condition(node.operand)
            if isinstance(truth, Static):
                return Static(not truth.object)
            return self.code.whole("xor", truth, constant(True))
        value = self.evaluate(node.operand)
        if isinstance(value, Static) and is_number(value.object):
            sign = {ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Invert: operator.invert}
            return Static(sign[type(node.op)](value.object))  # type: ignore[index]
        number = self.code.number(value)
        if number.kind == BOOLEAN:
            number = self.code.of_kind(number, INTEGER)
        if isinstance(node.op, ast.UAdd):
            return number
        if isinstance(node.op, ast.Invert):
            return self.code.whole("xor", number, constant(-1))
        if number.kind == DOUBLE:
            return Number(DOUBLE, self.code.do(f"fneg{self.code.contract} double {number.name}"))
        return self.code.whole("sub", constant(0), number)

    # ---------------------------------------------------------------------------------- conditions

    def _truth(self, value: Value) -> Static | Number:
        if isinstance(value, Static):
            return Static(bool(value.object))
        if isinstance(value, Group):
            return Static(bool(value.items))
        return self.code.of_kind(value, BOOLEAN)

    def _compare(self, node: ast.Compare) -> Value:
        """Compare values; all operands of a chain are evaluated."""
        left, found = self.evaluate(node.left), Static(True)
        for how, right_node in zip(node.ops, node.comparators, strict=True):
            right = self.evaluate(right_node)
            found = self._both("and", found, self._compared(how, left, right))
            left = right
        return found

    def _compared(self, how: ast.cmpop, a: Value, b: Value) -> Any:
        if isinstance(how, (ast.In, ast.NotIn)):
            found: Any = Static(False)
            for item in self.items(b):
                found = self._both("or", found, self._compared(ast.Eq(), a, item))
            if isinstance(how, ast.In):
                return found
            if isinstance(found, Static):
                return Static(not found.object)
            return self.code.whole("xor", found, constant(True))
        if isinstance(how, (ast.Is, ast.IsNot)):
            if not (isinstance(a, Static) or isinstance(b, Static)):
                raise Refusal("`is` between values of run time", "write ==")
            same = isinstance(a, Static) and isinstance(b, Static) and a.object is b.object
            return Static(same == isinstance(how, ast.Is))
        name, python = _COMPARISONS[type(how)]
        if isinstance(a, Static) and isinstance(b, Static):
            return Static(bool(python(a.object, b.object)))
        if isinstance(a, Group) or isinstance(b, Group):
            raise Refusal("a comparison of tuples", "compare item by item")
        return self.code.compare(name, a, b)

    def _both(self, how: str, one: Any, other: Any) -> Any:
        """Return ``and`` or ``or`` of two truths, both of which are computed."""
        neutral = how == "and"
        for known, rest in ((one, other), (other, one)):
            if isinstance(known, Static):
                return rest if known.object == neutral else known
        return self.code.whole(how, one, other)

    def _and_or(self, node: ast.BoolOp) -> Value:
        """Translate ``and`` and ``or`` of conditions; later ones are reached only if they decide."""
        stops = isinstance(node.op, ast.Or)  # the truth that decides
        end, places = "", []
        for n, each in enumerate(node.values):
            value = self.evaluate(each)
            truth = self._truth(value)
            if isinstance(value, Number) and value.kind != BOOLEAN:
                raise Refusal("`and` or `or` of numbers", "compare them with 0")
            if isinstance(truth, Static) and truth.object != stops and n < len(node.values) - 1:
                continue
            if not end:
                if isinstance(truth, Static) or n == len(node.values) - 1:
                    return truth
                end, places = self.code.label("decided"), self.code.variable(BOOLEAN)
            self.code.store(at_run_time(truth), places)
            if isinstance(truth, Static) or n == len(node.values) - 1:
                break
            following = self.code.label("next")
            self.code.branch(truth, *((end, following) if stops else (following, end)))
            self.code.begin(following)
        self.code.jump(end)
        self.code.begin(end)
        return self.code.load(BOOLEAN, places)

    def _choice(self, node: ast.IfExp) -> Value:
        truth = self.condition(node.test)
        if isinstance(truth, Static):
            return self.evaluate(node.body if truth.object else node.orelse)
        code = self.code
        yes, no, end = (code.label(each) for each in ("yes", "no", "end"))
        code.branch(truth, yes, no)
        code.begin(yes)
        value = at_run_time(self.evaluate(node.body))
        after_yes = code.label("yes")
        code.jump(after_yes)
        code.begin(no)
        other = at_run_time(self.evaluate(node.orelse))
        type_ = joined(type_of(value), type_of(other))
        if type_ is None:
            found = f"{in_words(type_of(value))} or {in_words(type_of(other))}"
            raise Refusal(f"a value that is {found}", "give both the same type")
        places = code.variable(type_)
        code.store(code.of_type(other, type_), places)
        code.jump(end)
        code.begin(after_yes)
        code.store(code.of_type(value, type_), places)
        code.jump(end)
        code.begin(end)
        return code.load(type_, places)

    # --------------------------------------------------------------------------------------- calls

    def _call(self, node: ast.Call) -> Value:
        called = self.evaluate(node.func)
        if not isinstance(called, Static):
            raise Refusal(f"a call of {in_words(type_of(called))}", "call a kernel")
        function, arguments = called.object, self.each(node.args)
        named = {str(each.arg): self.evaluate(each.value) for each in node.keywords}
        if isinstance(function, _Method):
            return self._method(function, arguments, named)
        if isinstance(function, type) and hasattr(function, "_fields"):
            return _made(function, arguments, named)
        if isinstance(function, VectorFunction):
            self.scope.call_vectors(function, self._vectors(*arguments))
            return Group(None, ())
        if function is call_at:
            address, *where = arguments
            number = self.code.of_kind(address, INTEGER).name
            target = self.code.do(f"inttoptr i64 {number} to ptr")
            listed = ", ".join(f"ptr {each}" for each in self._vectors(*where))
            self.code.put(f"call void {target}({listed})")
            return Group(None, ())
        if marks_of(function) is not None:
            return self.scope.call(function, arguments, named)
        if is_builtin(function) and not named and _known(arguments) is None:
            return call_builtin(function, arguments, self)
        known = _known([*arguments, *named.values()])
        if known is not None and callable(function):
            names = known[len(arguments) :]
            return _static_result(
                function, known[: len(arguments)], dict(zip(named, names, strict=True))
            )
        name = getattr(function, "__name__", repr(function))
        raise Refusal(f"{name!r} is no kernel", "mark it with @kernel, or use another function")

    def _vectors(self, block: Value, places: Value) -> list[str]:
        """Return the addresses of vectors, from their numbers in an array."""
        if not isinstance(block, Array):
            raise Refusal("vectors of something else", "give an array and the places in it")
        offsets = [self.operate(ast.Mult, each, Static(WIDTH)) for each in self.items(places)]
        return [self.code.address(block, each) for each in offsets]

    def _method(self, method: "_Method", arguments: list[Value], named: dict[str, Value]) -> Value:
        value = method.of
        if isinstance(value, Group):
            fields = value.made_by._fields  # type: ignore[union-attr]
            unknown = sorted({*named} - {*fields})
            if arguments or unknown:
                raise Refusal(f"_replace of {', '.join(unknown) or 'no field'}", "name its fields")
            items = (named.get(name, item) for name, item in zip(fields, value.items, strict=True))
            return Group(value.made_by, tuple(items))
        if method.name == "view":
            return self._viewed(value, arguments)
        assert isinstance(value, Array)  # noqa: S101 - ``member`` makes no other methods
        lengths = self.items(arguments[0]) if len(arguments) == 1 else tuple(arguments)
        known = [each.object if isinstance(each, Static) else each for each in lengths]
        if not all(isinstance(each, int) for each in known[1:]):
            raise Refusal("a shape known at run time only", "only its first length may be so")
        return Array(value.pointer, value.kind, tuple(known), contiguous(known))

    def _viewed(self, value: Value, arguments: list[Value]) -> Value:
        """Return the bits of a number, or an array of them, as numbers of another kind."""
        (as_,) = arguments
        kinds = {np.int64: INTEGER, np.float64: DOUBLE}
        if not isinstance(as_, Static) or as_.object not in kinds:
            raise Refusal("a view of another type", "view as np.int64 or np.float64")
        kind = kinds[as_.object]
        if isinstance(value, Array):
            return value._replace(kind=kind)
        number = self.code.number(value)
        if number.kind == kind:
            return number
        return Number(kind, self.code.do(f"bitcast {number.kind} {number.name} to {kind}"))

    _translations: ClassVar[dict[type[ast.expr], Callable[[Any, Any], Any]]] = {
        ast.Attribute: _attribute, ast.BinOp: _binary, ast.BoolOp: _and_or, ast.Call: _call,
        ast.Compare: _compare, ast.Constant: _constant, ast.GeneratorExp: _comprehension,
        ast.IfExp: _choice, ast.List: _tuple, ast.ListComp: _comprehension, ast.Name: _name,
        ast.Subscript: _subscript, ast.Tuple: _tuple, ast.UnaryOp: _unary,
    }  # fmt: skip


class _Method:
    """A method of a value, about to be called."""

    def __init__(self, of: Value, name: str) -> None:
        self.of, self.name = of, name


def _shown(node: ast.AST) -> str:
    text = ast.unparse(node)
    return f"`{text}`" if len(text) < _LONGEST_SHOWN else f"a {type(node).__name__}"


def _length(length: int | Number) -> Value:
    return Static(length) if isinstance(length, int) else length


def _known_index(index: Value | None) -> int | None:
    if index is None:
        return None
    if not isinstance(index, Static):
        raise Refusal("a slice of a tuple at run time", "give ends that are known")
    return int(index.object)


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


def _made(made_by: type[Any], arguments: list[Value], named: dict[str, Value]) -> Value:
    """Return a named tuple of a class."""
    fields = made_by._fields  # type: ignore[attr-defined]
    defaults = made_by._field_defaults  # type: ignore[attr-defined]
    items = dict(zip(fields, arguments, strict=False)) | named
    missing = [each for each in fields if each not in items and each not in defaults]
    if missing or len(arguments) > len(fields) or {*named} - {*fields}:
        given = f"{len(arguments)} values and {', '.join(named) or 'no names'}"
        raise Refusal(
            f"{made_by.__name__} of {given}", f"give its fields {', '.join(fields)}"
        )  # fmt: skip
    found = (items.get(each, Static(defaults.get(each))) for each in fields)
    return Group(made_by, tuple(found))


def _known(values: list[Value]) -> list[Any] | None:
    """Return the objects of values that are all static; None if one is not."""
    if all(isinstance(each, Static) for each in values):
        return [each.object for each in values]  # type: ignore[union-attr]
    return None


def _static_result(
    function: Callable[..., Any], arguments: list[Any], named: dict[str, Any]
) -> Static:
    """Call a function of Python, when the kernel is compiled."""
    try:
        return Static(function(*arguments, **named))
    except (ArithmeticError, TypeError, ValueError, LookupError, AttributeError) as error:
        name = getattr(function, "__name__", repr(function))
        raise Refusal(f"{name}: {error}", "pass what it takes") from None
