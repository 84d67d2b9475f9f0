"""Expressions of a kernel: from a node of Python's syntax tree to a ``Value`` and its code."""

import ast
import builtins
from collections.abc import Callable
from types import FunctionType
from typing import Any, ClassVar

import numpy as np

from model.compile.arithmetic import (
    boolean,
    both,
    compared,
    negation,
    operate,
    signed,
    truth_of,
)
from model.compile.builtins import call_builtin, is_builtin
from model.compile.code import Code
from model.compile.items import (
    Index,
    Method,
    Slice,
    element,
    items_of,
    lasting_items,
    member,
    replaced,
)
from model.compile.kernels import marks_of, python_of
from model.compile.source import KernelError, Source, parameters_of, refusal
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    Array,
    Generated,
    Group,
    Number,
    Static,
    SubsetError,
    Value,
    at_run_time,
    check_same,
    in_words,
    is_iterator,
    known_objects,
    static_result,
    type_of,
)
from model.compile.variables import Variables

_PLAIN = (tuple.__new__, object.__new__)  # of classes that are made of their fields

Call = Callable[[Code, Any, list[Value]], Value]
"""Writes the call of a kernel with arguments in the order of its parameters."""


class Expressions:
    """Translates the expressions of one function, a kernel of Python.

    Attributes:
        code: the code of the function.
        variables: its variables.
        source: its source.
        at: the statement that is translated.
    """

    code: Code
    variables: Variables
    at: ast.stmt

    def __init__(self, function: FunctionType, source: Source, call: Call) -> None:
        self.function, self.source, self.write_call = function, source, call
        self._items: dict[str, Value] = {}  # of the comprehensions around the present point

    def evaluate(self, node: ast.expr) -> Value:
        """Translate an expression and return its value."""
        found = self._evaluated(node)
        if is_iterator(found):
            error = SubsetError("an iterator that is kept", "make a tuple of it: tuple(...)")
            error.node = node
            raise error
        return found

    def _evaluated(self, node: ast.expr) -> Value:
        """Return the value of an expression, perhaps one that can be gone through once."""
        try:
            if type(node) not in self._translations:
                raise refusal(node)
            found: Value = self._translations[type(node)](self, node)
        except SubsetError as error:
            error.node = error.node or node
            raise
        return found

    def condition(self, node: ast.expr) -> Static | Number:
        """Translate an expression and return its truth, static if it is known."""
        return truth_of(self.code, self.evaluate(node))

    def items_in_turn(self, node: ast.expr) -> tuple[Value, ...]:
        """Return the items over which a loop or a comprehension goes."""
        return lasting_items(self.code, self._evaluated(node))

    # ----------------------------------------------------------------------------- names, members

    def _constant(self, node: ast.Constant) -> Value:
        return Static(node.value)

    def look_up(self, name: str) -> Value:
        """Return the value of a name: a variable, or an object outside the function."""
        if name in self._items:
            return self._items[name]
        if name in self.source.local:
            return self.variables.value(name)
        code = self.function.__code__
        if name in code.co_freevars:
            cell = (self.function.__closure__ or ())[code.co_freevars.index(name)]
            return static_result(lambda: cell.cell_contents)
        for known in (self.function.__globals__, vars(builtins)):
            if name in known:
                return Static(known[name])
        raise SubsetError(f"{name!r} is not defined", "define or import it")

    def _name(self, node: ast.Name) -> Value:
        return self.look_up(node.id)

    def _attribute(self, node: ast.Attribute) -> Value:
        return member(self.code, self.evaluate(node.value), node.attr)

    # ------------------------------------------------------------------------------ tuples, items

    def _tuple(self, node: ast.Tuple) -> Value:
        return Group(None, tuple(self.each(node.elts)))

    def each(self, nodes: list[ast.expr], evaluate: Any = None) -> list[Value]:
        """Return the values of expressions; a starred one gives its items."""
        found: list[Value] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                found += items_of(self.code, self._evaluated(node.value))
            else:
                found.append((evaluate or self.evaluate)(node))
        return found

    def _comprehension(self, node: ast.GeneratorExp) -> Value:
        """A generator over the items of a tuple is computed where it stands."""
        found: list[Value] = []
        outside = self._items

        def go_through(generators: list[ast.comprehension]) -> None:
            if not generators:
                found.append(self.evaluate(node.elt))
                return
            first, *rest = generators
            for item in self.items_in_turn(first.iter):
                self._items = self._items | self._named(first.target, item)
                tests = [self.condition(each) for each in first.ifs]
                if not all(isinstance(each, Static) for each in tests):
                    raise SubsetError(
                        "a comprehension that leaves out items at run time",
                        "test what is known when the kernel is compiled",
                    )
                if all(each.object for each in tests):  # type: ignore[union-attr]
                    go_through(rest)

        go_through(node.generators)
        self._items = outside
        return Group(Generated, tuple(found))

    def _named(self, target: ast.expr, item: Value) -> dict[str, Value]:
        """Return the names of a comprehension's target with their values."""
        if isinstance(target, ast.Name):
            return {target.id: item}
        if not isinstance(target, ast.Tuple):
            raise refusal(target)
        pairs = zip(target.elts, self.unpacked(item, target.elts), strict=True)
        return {name: found for pair in pairs for name, found in self._named(*pair).items()}

    def unpacked(self, value: Value, targets: list[ast.expr]) -> tuple[Value, ...]:
        """Return one item of a value for each target."""
        items = items_of(self.code, value)
        if len(items) != len(targets) or any(isinstance(each, ast.Starred) for each in targets):
            raise SubsetError(
                f"{len(items)} values for {len(targets)} names", "give each name a value"
            )
        return items

    def _subscript(self, node: ast.Subscript) -> Value:
        return element(self.code, self.evaluate(node.value), self.indices(node.slice))

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

    # --------------------------------------------------------------------- operations, conditions

    def _binary(self, node: ast.BinOp) -> Value:
        left = self.evaluate(node.left)
        return operate(self.code, type(node.op), left, self.evaluate(node.right))

    def _unary(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            return negation(self.code, self.condition(node.operand))
        return signed(self.code, type(node.op), self.evaluate(node.operand))

    def _compare(self, node: ast.Compare) -> Value:
        """Compare values; all operands of a chain are evaluated."""
        left: Value = self.evaluate(node.left)
        found: Static | Number = Static(True)
        for how, right_node in zip(node.ops, node.comparators, strict=True):
            right = self.evaluate(right_node)
            if isinstance(how, ast.In):
                here = self._is_among(left, right)
            elif isinstance(how, ast.NotIn):  # codespell:ignore
                here = negation(self.code, self._is_among(left, right))
            else:
                here = compared(self.code, how, left, right)
            found, left = both(self.code, "and", found, here), right
        return found

    def _is_among(self, value: Value, items: Value) -> Static | Number:
        if isinstance(value, Static) and isinstance(items, Static):
            return static_result(lambda: value.object in items.object)
        found: Static | Number = Static(False)
        for item in items_of(self.code, items):
            found = both(self.code, "or", found, compared(self.code, ast.Eq(), value, item))
        return found

    def _and_or(self, node: ast.BoolOp) -> Value:
        """Translate ``and`` and ``or`` of booleans; a later one is computed if it decides."""
        code, stops = self.code, isinstance(node.op, ast.Or)  # the truth that decides
        place: Value | None = None
        (end,) = code.labels("decided")
        for n, each in enumerate(node.values):
            truth, is_last = boolean(self.evaluate(each)), n == len(node.values) - 1
            if isinstance(truth, Static):
                if truth.object != stops and not is_last:
                    continue
                is_last = True
            if place is None:
                if is_last:
                    return truth
                place = code.variable(Number(BOOLEAN))
            code.store(at_run_time(truth), place)
            if is_last:
                break
            (following,) = code.labels("next")
            code.branch(truth, *((end, following) if stops else (following, end)))  # type: ignore[arg-type]
            code.begin(following)
        code.jump(end)
        code.begin(end)
        return code.load(place)  # type: ignore[arg-type]

    def _choice(self, node: ast.IfExp) -> Value:
        truth = self.condition(node.test)
        if isinstance(truth, Static):
            return self.evaluate(node.body if truth.object else node.orelse)
        code = self.code
        yes, after_yes, no, end = code.labels("yes", "after_yes", "no", "end")
        code.branch(truth, yes, no)
        code.begin(yes)
        value = at_run_time(self.evaluate(node.body))
        code.jump(after_yes)
        code.begin(no)
        other = at_run_time(self.evaluate(node.orelse))
        check_same(type_of(value), type_of(other))
        place = code.variable(type_of(value))
        code.store(other, place)
        code.jump(end)
        code.begin(after_yes)
        code.store(value, place)
        code.jump(end)
        code.begin(end)
        return code.load(place)

    # -------------------------------------------------------------------------------------- calls

    def _call(self, node: ast.Call) -> Value:
        called = self.evaluate(node.func)
        if not isinstance(called, Static):
            raise SubsetError(f"a call of {in_words(type_of(called))}", "call a kernel")
        if any(each.arg is None for each in node.keywords):
            raise SubsetError("arguments by **", "name them one by one")
        function = called.object
        is_kernel = marks_of(function) is not None
        takes_iterators = is_builtin(function) and not is_kernel
        arguments = self.each(node.args, self._evaluated if takes_iterators else None)
        named = {str(each.arg): self.evaluate(each.value) for each in node.keywords}
        if isinstance(function, Method):
            return self._method(function, arguments, named)
        if is_kernel:
            return self._called(function, arguments, named)
        if takes_iterators:
            return call_builtin(self.code, function, arguments, named)
        values = [*arguments, *named.values()]
        if isinstance(function, type) and hasattr(function, "_fields"):
            derived = (vars(each) for each in function.__mro__ if "_fields" not in vars(each))
            if any("__new__" in each and each["__new__"] not in _PLAIN for each in derived):
                raise SubsetError(
                    f"a class with a __new__ of its own, {function.__name__}", "write a kernel"
                )
            return Group(function, tuple(_bound(function, arguments, named)))
        known = known_objects(values)
        if callable(function) and known is not None:
            names = dict(zip(named, known[len(arguments) :], strict=True))
            found = static_result(function, *known[: len(arguments)], **names)
            if found.object is not None:
                return found
        name = getattr(function, "__name__", repr(function))
        raise SubsetError(f"{name!r} is no kernel", "mark it with @kernel, or use another function")

    def _called(self, function: Any, arguments: list[Value], named: dict[str, Value]) -> Value:
        """Call a kernel."""
        if not isinstance(function, FunctionType):
            raise SubsetError(f"the kernel {function!r}", "define it outside of a class")
        try:
            given = [at_run_time(each) for each in _bound(function, arguments, named)]
            return self.write_call(self.code, function, given)
        except KernelError as error:
            error.add_note(f"called at {self.function.__code__.co_filename}:{self.at.lineno}")
            raise

    def _method(self, method: Method, arguments: list[Value], named: dict[str, Value]) -> Value:
        if method.name == "_replace" and not arguments:
            return replaced(method.of, named)
        kinds: dict[Any, str] = {np.int64: INTEGER, np.float64: DOUBLE}
        as_ = arguments[0] if len(arguments) == 1 and not named else None
        if method.name != "view" or not isinstance(as_, Static) or as_.object not in kinds:
            raise SubsetError(
                f"{method.name} with such arguments", "write view(np.int64), view(np.float64)"
            )
        kind, value = kinds[as_.object], method.of
        if isinstance(value, Array):
            return value._replace(kind=kind)
        number = self.code.number(value)
        text = f"bitcast {number.kind} {number.name} to {kind}"
        return number if number.kind == kind else Number(kind, self.code.do(text))

    _translations: ClassVar[dict[type[ast.expr], Callable[[Any, Any], Any]]] = {
        ast.Attribute: _attribute, ast.BinOp: _binary, ast.BoolOp: _and_or, ast.Call: _call,
        ast.Compare: _compare, ast.Constant: _constant, ast.GeneratorExp: _comprehension,
        ast.IfExp: _choice, ast.Name: _name, ast.Subscript: _subscript, ast.Tuple: _tuple,
        ast.UnaryOp: _unary,
    }  # fmt: skip


def _bound(function: Any, arguments: list[Value], named: dict[str, Value]) -> list[Value]:
    """Return the values of a function's parameters, in their order."""
    python = python_of(function)
    parameters = parameters_of(python)
    try:
        bound = parameters.bind(*arguments, **named)
    except TypeError as error:
        raise SubsetError(
            f"{python.__name__}: {error}", f"call {python.__name__}{parameters}"
        ) from None
    given: list[Value] = []
    for each in parameters.parameters.values():
        if each.kind is each.VAR_POSITIONAL:
            given += bound.arguments.get(each.name, ())
        elif each.kind is each.VAR_KEYWORD:
            raise SubsetError(f"{python.__name__} takes **{each.name}", "name its parameters")
        else:
            given.append(bound.arguments.get(each.name, Static(each.default)))
    return given
