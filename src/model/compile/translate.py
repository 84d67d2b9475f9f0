"""Statements and functions: from the syntax tree of a kernel to the text of an LLVM function."""

import ast
from collections.abc import Callable
from types import FunctionType
from typing import Any, ClassVar, NamedTuple, cast

from model.compile.arithmetic import operate
from model.compile.code import Code, Declarations, aggregate
from model.compile.expressions import Call, Expressions
from model.compile.items import part_of
from model.compile.source import (
    KernelError,
    is_counted,
    parameters_of,
    refusal,
    source_of,
)
from model.compile.values import (
    INTEGER,
    NOTHING,
    Array,
    Group,
    Number,
    Static,
    SubsetError,
    Type,
    Value,
    at_run_time,
    constant,
    in_words,
    known_number,
    leaf_kinds,
    rebuilt,
    type_of,
)
from model.compile.variables import Names, Variables
from model.compile.vector_code import WIDTH, each_lane


class _Loop(NamedTuple):
    """A loop: where ``continue`` and ``break`` lead, and the names assigned at each."""

    following: str
    end: str
    at_following: list[Names]
    at_end: list[Names]


class Function(Expressions):
    """Translation of one kernel for arguments of certain types.

    Args:
        function: function of Python.
        types: of its arguments, in the order of its parameters.
        declared: declarations of the module into which it is written.
        call: writes calls of other kernels.

    Attributes:
        result: type of what it returns.

    Raises:
        KernelError: it is not in the subset.
    """

    def __init__(
        self, function: FunctionType, types: tuple[Type, ...], declared: Declarations, call: Call
    ) -> None:
        super().__init__(function, source_of(function.__code__), call)
        self.types, self._declared = types, declared
        self.at, self._last_return = self.source.tree, cast("ast.stmt", self.source.tree)
        self._result: Type | None = None
        try:
            self._translate()
        except SubsetError as error:
            raise self.error(error) from None
        self.result: Type = self._result or NOTHING
        self.at = self._last_return

    def text(self, name: str, linkage: str, attributes: str = "") -> str:
        """Return the function in LLVM's language."""
        listed = ", ".join(f"{kind} %a{n}" for n, kind in enumerate(leaf_kinds(*self.types)))
        result = aggregate(leaf_kinds(self.result))
        return self.code.text(f"define {linkage} {result} @{name}({listed}) nounwind{attributes}")

    def error(self, error: SubsetError) -> KernelError:
        """Return an error with its place."""
        where = self._where(getattr(error.node, "lineno", None))
        return KernelError(f"{where}: {error.problem}; {error.remedy}")

    def _where(self, line: int | None = None) -> str:
        file = self.function.__code__.co_filename
        return f"{file}:{line or self.at.lineno}: in kernel {self.function.__name__!r}"

    def _translate(self) -> None:
        self.code, self.at = Code(self._declared, self._where), self.source.tree
        self.variables = Variables(self.code, self.source.unchanging)
        self._loops: list[_Loop] = []
        self.code.begin("begin")
        leaf_names = iter([f"%a{n}" for n in range(len(leaf_kinds(*self.types)))])
        values = [rebuilt(each, leaf_names) for each in self.types]
        parameters = [*parameters_of(self.function).parameters.values()]
        others = len(values) - sum(each.kind is not each.VAR_POSITIONAL for each in parameters)
        for each in parameters:
            if each.kind is each.VAR_KEYWORD:
                raise SubsetError(f"the parameter **{each.name}", "name its parameters one by one")
            if each.kind is each.VAR_POSITIONAL:
                rest = [values.pop(0) for _ in range(others)]
                self.variables.assign(each.name, Group(None, tuple(rest)))
                others = min(others, 0)
            elif values:
                self.variables.assign(each.name, values.pop(0))
        if others:
            names = ", ".join(each.name for each in parameters)
            raise SubsetError(f"{len(self.types)} arguments", f"give its parameters {names}")
        self._body(self.source.tree.body)
        if not self.code.closed:
            self.at = self.source.tree
            self._give_back(NOTHING)

    # ----------------------------------------------------------------------------------- branches

    def _body(self, statements: list[ast.stmt]) -> None:
        for each in statements:
            if self.code.closed:
                return
            self.at = each
            if type(each) not in self._statements:
                raise refusal(each)
            self._statements[type(each)](self, each)

    def _if(self, node: ast.If) -> None:
        truth = self.condition(node.test)
        if isinstance(truth, Static):
            self._body(node.body if truth.object else node.orelse)
            return
        code = self.code
        yes, no, end = code.labels("then", "else", "end")
        code.branch(truth, yes, no)
        before, ways = dict(self.variables.assigned), list[Names]()
        for label, statements in ((yes, node.body), (no, node.orelse)):
            self.variables.assigned = dict(before)
            code.begin(label)
            self._body(statements)
            self._lead(end, ways)
        self._meet(end, ways)

    def _lead(self, label: str, at_label: list[Names]) -> None:
        """Continue at a block where ways meet, unless the present one has been left."""
        if not self.code.closed:
            at_label.append(self.variables.assigned)
            self.code.jump(label)

    def _meet(self, label: str, ways: list[Names]) -> None:
        """Go on where ways meet, if any leads there."""
        if ways:
            self.variables.meet(ways)
            self.code.begin(label)

    # -------------------------------------------------------------------------------------- loops

    def _while(self, node: ast.While) -> None:
        code = self.code
        test, body, end = code.labels("while", "round", "end")
        code.jump(test)
        code.begin(test)
        before = dict(self.variables.assigned)
        truth = code.number(self.condition(node.test))
        loop = _Loop(test, end, [], [])
        if known_number(truth):
            code.jump(body)
        else:
            code.branch(truth, body, end)
            loop.at_end.append(before)
        code.begin(body)
        self._round(node, loop, before)
        self._meet(end, loop.at_end)

    def _for(self, node: ast.For) -> None:
        call = node.iter if isinstance(node.iter, ast.Call) else None
        named = self.evaluate(call.func) if call and isinstance(call.func, ast.Name) else None
        called = named.object if isinstance(named, Static) else None
        if call and (called is range or called is each_lane):
            if call.keywords:
                raise SubsetError(f"{called.__name__} with names", "pass values by position")
            ends = [self.code.whole(each, "an end of a range") for each in self.each(call.args)]
            if not (0 < len(ends) < 4 if called is range else not ends):
                raise SubsetError(f"{called.__name__} of {len(ends)} values", "pass what it takes")
            outside, hint = self.code.group, ""
            if called is each_lane:
                ends = [constant(WIDTH)]
                self.code.group, hint = self._declared.lanes()
            self._for_range(node, ends, hint)
            self.code.group = outside
        elif is_counted(node.iter):
            raise SubsetError("`range` or `each_lane` with another meaning", "use another name")
        else:
            self._for_each(node, self.items_in_turn(node.iter))

    def _for_range(self, node: ast.For, ends: list[Number], metadata: str) -> None:
        """Translate a loop over a range, which counts at run time even if its ends are known."""
        code = self.code
        first, last = (constant(0), ends[0]) if len(ends) == 1 else ends[:2]
        step = ends[2] if len(ends) == 3 else constant(1)
        by = known_number(step)
        if not by:
            raise SubsetError("a range whose step is 0 or not known", "give an int")
        test, body, following, end = code.labels("for", "round", "following", "end")
        counter = code.variable(Number(INTEGER))
        code.store(first, counter)
        code.jump(test)
        code.begin(test)
        before = dict(self.variables.assigned)
        n = code.number(code.load(counter))
        code.branch(code.compare("lt" if by > 0 else "gt", n, last), body, end)
        code.begin(body)
        loop = _Loop(following, end, [], [before])
        self._round(node, loop, before, n)
        code.begin(following)
        code.store(code.integers("add", n, step), counter)
        code.jump(test, metadata)
        self._meet(end, loop.at_end)

    def _round(
        self, node: ast.While | ast.For, loop: _Loop, before: Names, item: Value | None = None
    ) -> None:
        """Translate a round of a loop that is repeated at run time."""
        self.variables.assigned = dict(before)
        self._inside(node, loop, item)
        self.at = node
        for names in loop.at_following:
            self.variables.check_round(before, names)

    def _inside(
        self, node: ast.While | ast.For, loop: _Loop, item: Value | None, keep_static: bool = False
    ) -> None:
        """Translate the body of a loop, for one item of a for loop."""
        if node.orelse:
            raise SubsetError("`else` of a loop", "write an if after it")
        if item is not None:
            self._store(node.target, item, keep_static)  # type: ignore[union-attr]
        self._loops.append(loop)
        self._body(node.body)
        self._loops.pop()
        self._lead(loop.following, loop.at_following)

    def _for_each(self, node: ast.For, items: tuple[Value, ...]) -> None:
        """Translate a loop over items, each round by itself; static items stay static."""
        (end,), at_end = self.code.labels("end"), list[Names]()
        for item in items:
            (following,) = self.code.labels("following")
            loop = _Loop(following, end, [], at_end)
            self._inside(node, loop, item, keep_static=True)
            self._meet(loop.following, loop.at_following)
            if self.code.closed:
                break
        self._lead(end, at_end)
        self._meet(end, at_end)

    def _break(self, _node: ast.Break) -> None:
        loop = self._loops[-1]
        self._lead(loop.end, loop.at_end)

    def _continue(self, _node: ast.Continue) -> None:
        loop = self._loops[-1]
        self._lead(loop.following, loop.at_following)

    # --------------------------------------------------------------------------- assignments, ends

    def _pass(self, _node: ast.Pass) -> None:
        pass

    def _expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.evaluate(node.value)

    def _return(self, node: ast.Return) -> None:
        self._give_back(self.evaluate(node.value) if node.value else NOTHING)

    def _give_back(self, value: Value) -> None:
        value = at_run_time(value)
        type_ = type_of(value)
        if self._result not in (None, type_):
            words = " and ".join(map(in_words, (self._result, type_)))
            raise SubsetError(f"the kernel returns {words}", "return values of one type")
        self._result, self._last_return = type_, self.at
        self.code.give_back(value)

    def _assignment(self, node: ast.Assign) -> None:
        value = self.evaluate(node.value)
        for target in node.targets:
            self._store(target, value)

    def _annassign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self._store(node.target, self.evaluate(node.value))

    def _augassign(self, node: ast.AugAssign) -> None:
        code, how = self.code, type(node.op)
        if isinstance(node.target, ast.Name):
            old = self.look_up(node.target.id)
            new = operate(code, how, old, self.evaluate(node.value))
            self.variables.assign(node.target.id, new)
            return
        place = self._part(node.target)
        if place.lengths:
            raise SubsetError("arithmetic on a part of an array", "write a loop over a range")
        old = code.load(Number(place.kind, place.pointer))
        self._fill(place, operate(code, how, old, self.evaluate(node.value)))

    def _store(self, target: ast.expr, value: Value, keep_static: bool = False) -> None:
        if isinstance(target, ast.Name):
            self.variables.assign(target.id, value, keep_static)
        elif isinstance(target, (ast.Tuple, ast.List)):
            for each, item in zip(target.elts, self.unpacked(value, target.elts), strict=True):
                self._store(each, item, keep_static)
        else:
            self._fill(self._part(target), value)

    def _part(self, target: ast.expr) -> Array:
        """Return the elements of an array that are the target of an assignment."""
        if not isinstance(target, ast.Subscript):
            raise SubsetError(
                "an assignment to a member", "replace the tuple: value._replace(name=...)"
            )
        array = self.evaluate(target.value)
        if not isinstance(array, Array) or array.is_constant:
            found = "a constant array" if isinstance(array, Array) else in_words(type_of(array))
            raise SubsetError(f"an assignment into {found}", "assign to elements of arrays")
        return part_of(self.code, array, self.indices(target.slice))

    def _fill(self, place: Array, value: Value) -> None:
        """Store a number into an element, or into all elements of a part of an array."""
        number = self.code.of_kind(value, place.kind)
        if not place.lengths:
            self.code.store(number, Number(place.kind, place.pointer))
            return
        length, *lengths = place.lengths
        count = Static(length) if isinstance(length, int) else length

        def fill(n: Number) -> None:
            offset = operate(self.code, ast.Mult, n, Static(place.strides[0]))
            address = self.code.address(place, offset)
            inner = place._replace(pointer=address, lengths=(*lengths,), strides=place.strides[1:])
            self._fill(inner, number)

        self.code.repeat(count, fill)

    _statements: ClassVar[dict[type[ast.stmt], Callable[[Any, Any], None]]] = {
        ast.AnnAssign: _annassign, ast.Assign: _assignment, ast.AugAssign: _augassign,
        ast.Break: _break, ast.Continue: _continue, ast.Expr: _expr, ast.For: _for, ast.If: _if,
        ast.Pass: _pass, ast.Return: _return, ast.While: _while,
    }  # fmt: skip
