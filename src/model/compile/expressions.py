"""Expressions of a kernel: from a node of Python's syntax tree to a ``Value`` and its code."""

import ast
from collections.abc import Callable
from typing import Any, ClassVar, Protocol

import numpy as np

from model.compile.arithmetic import both, compared, negation, operate, signed, truth_of
from model.compile.builtins import call_builtin, is_builtin
from model.compile.code import Code
from model.compile.indexing import Index, Slice, item_of, length_of, part_of
from model.compile.kernels import marks_of
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
    at_run_time,
    in_words,
    joined,
    type_of,
)
from model.compile.variables import Variables
from model.compile.vector_code import WIDTH, VectorFunction, call_at

_LONGEST_SHOWN = 60  # characters of an expression in an error
_MOST_UNROLLED = 1024  # items of a comprehension or a loop over static items


class Scope(Protocol):
    """What expressions need of the function in which they stand."""

    code: Code
    variables: Variables

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
        translate = self._translations.get(type(node), _refuse)
        try:
            found: Value = translate(self, node)
        except SubsetError as error:
            error.node = error.node or node
            raise
        return found

    def condition(self, node: ast.expr) -> Static | Number:
        """Translate an expression and return its truth, static if it is known."""
        return truth_of(self.code, self.evaluate(node))

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
                raise SubsetError(
                    f"{in_words(type_of(value))} has no items", "give a tuple"
                ) from None
            if len(found) > _MOST_UNROLLED:
                raise SubsetError(f"{len(found)} items to be unrolled", "write a loop over a range")
            return found
        if isinstance(value, Array) and isinstance(value.lengths[0], int):
            return tuple(self.element(value, [Static(n)]) for n in range(value.lengths[0]))
        raise SubsetError(
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
            if name in vars(value.made_by or object):  # an attribute of the class
                return Static(getattr(value.made_by, name))
        elif isinstance(value, Array):
            if name == "shape":
                return Group(None, tuple(map(length_of, value.lengths)))
            if name == "size":
                size = length_of(value.lengths[0])
                for length in value.lengths[1:]:
                    size = operate(self.code, ast.Mult, size, length_of(length))
                return size
            if name == "view":
                return Static(_Method(value, name))
        elif isinstance(value, Static) and hasattr(value.object, name):
            found = getattr(value.object, name)
            is_method = name == "_replace" and isinstance(value.object, tuple)
            return Static(_Method(at_run_time(value), name)) if is_method else Static(found)
        elif isinstance(value, Number) and name == "view":
            return Static(_Method(value, name))
        raise SubsetError(f"{in_words(type_of(value))} has no {name!r}", "name a field that it has")

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
        names = dict(self.scope.variables.assigned)

        def go_through(generators: list[ast.comprehension]) -> None:
            if not generators:
                found.append(self.evaluate(node.elt))
                return
            first, *rest = generators
            for item in self.items(self.evaluate(first.iter)):
                self.scope.bind(first.target, item)
                tests = [self.condition(each) for each in first.ifs]
                if not all(isinstance(each, Static) for each in tests):
                    raise SubsetError(
                        "a comprehension that leaves out items at run time",
                        "test what is known when the kernel is compiled",
                    )
                if all(each.object for each in tests):  # type: ignore[union-attr]
                    go_through(rest)

        go_through(node.generators)
        self.scope.variables.assigned = names
        return Group(None, tuple(found))

    def _subscript(self, node: ast.Subscript) -> Value:
        return self.element(self.evaluate(node.value), self.indices(node.slice))

    def indices(self, node: ast.expr) -> list[Index]:
        """Return the indices between brackets."""
        found: list[Index] = []
        for each in node.elts if isinstance(node, ast.Tuple) else [node]:
            if isinstance(each, ast.Slice):
                if each.step is not None:
                    raise SubsetError("a slice with a step", "loop over a range with a step")
                ends = each.lower, each.upper
                found.append(Slice(*(None if end is None else self.evaluate(end) for end in ends)))
            else:
                found.append(self.evaluate(each))
        return found

    def element(self, value: Value, indices: list[Index]) -> Value:
        """Return an item of a tuple, or an element or a part of an array."""
        if isinstance(value, Static) and isinstance(value.object, np.ndarray):
            value = self.scope.array(value.object)
        if isinstance(value, Array):
            found = part_of(self.code, value, indices)
            return found if found.lengths else self.code.read(found)
        if len(indices) > 1:
            raise SubsetError(f"{len(indices)} indices of a tuple", "give one")
        (index,) = indices
        if isinstance(value, Static) and isinstance(index, Static):
            try:
                return Static(value.object[index.object])
            except (LookupError, TypeError) as error:
                raise SubsetError(
                    f"{error} ({index.object!r})", "give an index that exists"
                ) from None
        return item_of(self.code, self.items(value), index)

    # ---------------------------------------------------------------------------------- operations

    def _binary(self, node: ast.BinOp) -> Value:
        return operate(
            self.code, type(node.op), self.evaluate(node.left), self.evaluate(node.right)
        )

    def _unary(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            return negation(self.code, self.condition(node.operand))
        return signed(self.code, type(node.op), self.evaluate(node.operand))

    # ---------------------------------------------------------------------------------- conditions

    def _compare(self, node: ast.Compare) -> Value:
        """Compare values; all operands of a chain are evaluated."""
        left: Value = self.evaluate(node.left)
        found: Static | Number = Static(True)
        for how, right_node in zip(node.ops, node.comparators, strict=True):
            right = self.evaluate(right_node)
            if isinstance(how, (ast.In, ast.NotIn)):
                here = self._is_among(left, right)
                here = negation(self.code, here) if isinstance(how, ast.NotIn) else here
            else:
                here = compared(self.code, how, left, right)
            found, left = both(self.code, "and", found, here), right
        return found

    def _is_among(self, value: Value, items: Value) -> Static | Number:
        found: Static | Number = Static(False)
        for item in self.items(items):
            found = both(self.code, "or", found, compared(self.code, ast.Eq(), value, item))
        return found

    def _and_or(self, node: ast.BoolOp) -> Value:
        """Translate ``and`` and ``or`` of conditions; a later one is computed if it decides."""
        stops = isinstance(node.op, ast.Or)  # the truth that decides
        end, places = "", []
        for n, each in enumerate(node.values):
            value = self.evaluate(each)
            truth = truth_of(self.code, value)
            if isinstance(value, Number) and value.kind != BOOLEAN:
                raise SubsetError("`and` or `or` of numbers", "compare them with 0")
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
            raise SubsetError(f"a value that is {found}", "give both the same type")
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
            raise SubsetError(f"a call of {in_words(type_of(called))}", "call a kernel")
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
        if is_builtin(function) and _known(arguments) is None:
            return call_builtin(function, arguments, named, self)
        known = _known([*arguments, *named.values()])
        if known is not None and callable(function):
            names = known[len(arguments) :]
            return _static_result(
                function, known[: len(arguments)], dict(zip(named, names, strict=True))
            )
        name = getattr(function, "__name__", repr(function))
        raise SubsetError(f"{name!r} is no kernel", "mark it with @kernel, or use another function")

    def _vectors(self, block: Value, places: Value) -> list[str]:
        """Return the addresses of vectors, from their numbers in an array."""
        if not isinstance(block, Array):
            raise SubsetError("vectors of something else", "give an array and the places in it")
        offsets = [operate(self.code, ast.Mult, each, Static(WIDTH)) for each in self.items(places)]
        return [self.code.address(block, each) for each in offsets]

    def _method(self, method: "_Method", arguments: list[Value], named: dict[str, Value]) -> Value:
        value = method.of
        if isinstance(value, Group):
            fields = value.made_by._fields  # type: ignore[union-attr]
            unknown = sorted({*named} - {*fields})
            if arguments or unknown:
                raise SubsetError(
                    f"_replace of {', '.join(unknown) or 'no field'}", "name its fields"
                )
            items = (named.get(name, item) for name, item in zip(fields, value.items, strict=True))
            return Group(value.made_by, tuple(items))
        return self._viewed(value, arguments)

    def _viewed(self, value: Value, arguments: list[Value]) -> Value:
        """Return the bits of a number, or an array of them, as numbers of another kind."""
        (as_,) = arguments
        kinds = {np.int64: INTEGER, np.float64: DOUBLE}
        if not isinstance(as_, Static) or as_.object not in kinds:
            raise SubsetError("a view of another type", "view as np.int64 or np.float64")
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


def _refuse(_: Expressions, node: ast.expr) -> Value:
    text = ast.unparse(node)
    shown = f"`{text}`" if len(text) < _LONGEST_SHOWN else f"a {type(node).__name__}"
    raise SubsetError(f"{shown} in a kernel", "use the expressions of the subset")


def _made(made_by: type[Any], arguments: list[Value], named: dict[str, Value]) -> Value:
    """Return a named tuple of a class."""
    fields = made_by._fields
    defaults = made_by._field_defaults
    items = dict(zip(fields, arguments, strict=False)) | named
    missing = [each for each in fields if each not in items and each not in defaults]
    if missing or len(arguments) > len(fields) or {*named} - {*fields}:
        given = f"{len(arguments)} values and {', '.join(named) or 'no names'}"
        raise SubsetError(
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
        raise SubsetError(f"{name}: {error}", "pass what it takes") from None
