"""Statements and functions: from the syntax tree of a kernel to the text of an LLVM function."""

import ast
import builtins
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple, Protocol

from model.compile.arithmetic import operate
from model.compile.code import Code, aggregate
from model.compile.expressions import Expressions
from model.compile.indexing import part_of
from model.compile.kernels import python_of
from model.compile.source import KernelError, parameters_of, source_of
from model.compile.values import (
    DOUBLE,
    INTEGER,
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
    joined,
    known_number,
    leaf_kinds,
    rebuilt,
    type_of,
)
from model.compile.variables import Names, Variables, WidenedError
from model.compile.vector_code import WIDTH, VectorFunction, each_lane


class Module(Protocol):
    """What the translation of a function needs of the module into which it is written."""

    contract: bool

    def call(self, code: Code, function: Callable[..., Any], arguments: list[Value]) -> Value:
        """Call a kernel with these arguments, in the order of its parameters."""

    def call_vectors(self, code: Code, function: VectorFunction, pointers: list[str]) -> None:
        """Call a function of vectors."""

    def array(self, known: Any) -> Array:
        """Return an array of numpy as constants."""

    def vectorized(self) -> tuple[str, str]:
        """Return metadata of accesses in a new loop over lanes, and of its jump back."""


class _Loop(NamedTuple):
    """A loop: where ``continue`` and ``break`` lead, and the names assigned at each."""

    following: str
    end: str
    at_following: list[Names]
    at_end: list[Names]


class Function:
    """Translation of one kernel for arguments of certain types.

    Attributes:
        result: type of what it returns.
    """

    result: Type

    def __init__(
        self,
        module: Module,
        name: str,
        function: Callable[..., Any],
        types: list[Type],
        linkage: str,
    ) -> None:
        self.module, self.name, self.linkage = module, name, linkage
        self.function, self.types = python_of(function), types
        self.source, self.file = (
            source_of(self.function.__code__),
            self.function.__code__.co_filename,
        )
        self.at: ast.stmt = self.source.tree
        self._result: Type | None = None
        self._wider: dict[str, Type] = {}
        while True:
            try:
                self._translate()
                break
            except WidenedError:
                pass
            except SubsetError as error:
                raise self._with_place(error) from None

    def text(self, attributes: str) -> str:
        """Return the function in LLVM's language, with further attributes."""
        kinds = [kind for each in self.types for kind in leaf_kinds(each)]
        listed = ", ".join(f"{kind} %a{n}" for n, kind in enumerate(kinds))
        result = aggregate(leaf_kinds(self.result))
        head = f"define {self.linkage} {result} {self.name}({listed}) nounwind{attributes}"
        return self.code.text(head)

    def _with_place(self, error: SubsetError) -> KernelError:
        line = getattr(error.node or self.at, "lineno", self.at.lineno)
        where = f"{self.file}:{line}: in kernel {self.function.__name__!r}"
        return KernelError(f"{where}: {error.problem}; {error.remedy}")

    def _translate(self) -> None:
        self.code = Code(self.module.contract)
        self.expressions = Expressions(self)
        self.variables = Variables(self.code, self.source.unchanging, self._wider)
        self._loops: list[_Loop] = []
        self.code.begin("begin")
        kinds = [kind for each in self.types for kind in leaf_kinds(each)]
        leaf_names = iter([f"%a{n}" for n in range(len(kinds))])
        values = [rebuilt(each, leaf_names) for each in self.types]
        parameters = self.source.tree.args
        plain = [each.arg for each in parameters.args]
        for name, value in zip(plain, values, strict=False):
            self.variables.assign(name, value)
        if parameters.vararg:
            rest = Group(None, tuple(values[len(plain) :]))
            self.variables.assign(parameters.vararg.arg, rest)
        self._body(self.source.tree.body)
        if not self.code.closed:
            self._give_back(Group(None, ()))

    # --------------------------------------------------------------------------------------- scope

    def look_up(self, name: str) -> Value:
        """Return the value of a name: a variable, or an object outside the function."""
        code = self.function.__code__
        local = name in code.co_varnames or name in code.co_cellvars
        if local or name in self.variables.assigned:
            return self.variables.value(name)
        if name in code.co_freevars:
            cell = self.function.__closure__[code.co_freevars.index(name)]  # type: ignore[index]
            return Static(cell.cell_contents)
        for known in (self.function.__globals__, vars(builtins)):
            if name in known:
                return Static(known[name])
        raise SubsetError(f"{name!r} is not defined", "define or import it")

    def call_vectors(self, function: VectorFunction, pointers: list[str]) -> None:
        """Call a function of vectors."""
        self.module.call_vectors(self.code, function, pointers)

    def array(self, known: Any) -> Array:
        """Return an array of numpy as constants of the module."""
        return self.module.array(known)

    def call(self, function: Any, arguments: list[Value], named: dict[str, Value]) -> Value:
        """Call a kernel."""
        parameters = parameters_of(python_of(function))
        try:
            bound = parameters.bind(*arguments, **named)
        except TypeError as error:
            name = python_of(function).__name__
            raise SubsetError(f"{name}: {error}", f"call {name}{parameters}") from None
        given: list[Value] = []
        for each in parameters.parameters.values():
            if each.kind is each.VAR_POSITIONAL:
                given += bound.arguments.get(each.name, ())
            else:
                given.append(bound.arguments.get(each.name, Static(each.default)))
        try:
            return self.module.call(self.code, function, [at_run_time(each) for each in given])
        except KernelError as error:
            error.add_note(f"called at {self.file}:{self.at.lineno}")
            raise

    def bind(self, target: ast.expr, value: Value) -> None:
        """Bind the target of a comprehension; static items stay static."""
        self._store(target, value, keep_static=True)

    # ----------------------------------------------------------------------------------- branches

    def _body(self, statements: list[ast.stmt]) -> None:
        for each in statements:
            if self.code.closed:
                return
            self.at = each
            if type(each) not in self._statements:
                raise SubsetError(
                    f"`{type(each).__name__.lower()}` in a kernel",
                    "use the statements of the subset",
                )
            self._statements[type(each)](self, each)

    def _if(self, node: ast.If) -> None:
        truth = self.expressions.condition(node.test)
        if isinstance(truth, Static):
            self._body(node.body if truth.object else node.orelse)
            return
        code = self.code
        yes, no, end = (code.label(each) for each in ("then", "else", "end"))
        code.branch(truth, yes, no)
        before, ways = dict(self.variables.assigned), []
        for label, statements in ((yes, node.body), (no, node.orelse)):
            self.variables.assigned = dict(before)
            code.begin(label)
            self._body(statements)
            if not code.closed:
                ways.append(self.variables.assigned)
                code.jump(end)
        if ways:
            self.variables.meet(ways)
            code.begin(end)

    def _while(self, node: ast.While) -> None:
        code = self.code
        test, body, end = (code.label(each) for each in ("while", "round", "end"))
        code.jump(test)
        code.begin(test)
        before = dict(self.variables.assigned)
        truth = self.expressions.condition(node.test)
        loop = _Loop(test, end, [], [])
        if isinstance(truth, Number):
            code.branch(truth, body, end)
            loop.at_end.append(before)
        else:
            code.jump(body if truth.object else end)
            loop.at_end.extend([] if truth.object else [before])
        code.begin(body)
        self._round(node, loop, before)
        self._after(loop)

    def _for(self, node: ast.For) -> None:
        called = self._called(node.iter)
        if called is range:
            self._for_range(node, [self._end_of_range(each) for each in node.iter.args])  # type: ignore[attr-defined]
        elif called is each_lane:
            outside, (self.code.group, loop) = self.code.group, self.module.vectorized()
            self._for_range(node, [constant(WIDTH)], loop)
            self.code.group = outside
        else:
            self._for_each(node, self.expressions.items(self.expressions.evaluate(node.iter)))

    def _called(self, node: ast.expr) -> Any:
        """Return the function that is called where it is a static object, else None."""
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            found = self.look_up(node.func.id)
            return found.object if isinstance(found, Static) else None
        return None

    def _for_range(self, node: ast.For, ends: list[Number], metadata: str = "") -> None:
        """Translate a loop over a range, which counts at run time even if its ends are known."""
        code = self.code
        first, last = (constant(0), ends[0]) if len(ends) == 1 else ends[:2]
        step = ends[2] if len(ends) == 3 else constant(1)
        by = known_number(step)
        if not by:
            raise SubsetError("a range whose step is 0 or not known", "give an int")
        labels = (code.label(each) for each in ("for", "round", "following", "end"))
        test, body, following, end = labels
        counter = code.variable(INTEGER)
        code.store(first, counter)
        code.jump(test)
        code.begin(test)
        before = dict(self.variables.assigned)
        n = code.number(code.load(INTEGER, counter))
        code.branch(code.compare("lt" if by > 0 else "gt", n, last), body, end)
        code.begin(body)
        loop = _Loop(following, end, [], [before])
        self._round(node, loop, before, n)
        code.begin(following)
        code.store(code.whole("add", n, step), counter)
        code.leave(f"br label %{test}{metadata}")
        self._after(loop)

    def _end_of_range(self, node: ast.expr) -> Number:
        number = self.code.number(self.expressions.evaluate(node), "an end of a range")
        if number.kind == DOUBLE:
            raise SubsetError("a float as an end of a range", "take int(...) of it")
        return self.code.of_kind(number, INTEGER)

    def _round(
        self, node: ast.While | ast.For, loop: _Loop, before: Names, item: Value | None = None
    ) -> None:
        """Translate a round of a loop that is repeated at run time."""
        if node.orelse:
            raise SubsetError("`else` of a loop", "write an if after it")
        self.variables.assigned = dict(before)
        if item is not None:
            self._store(node.target, item)  # type: ignore[union-attr]
        self._inside(loop, node.body)
        for names in loop.at_following:
            self.variables.check_round(before, names)

    def _inside(self, loop: _Loop, body: list[ast.stmt]) -> None:
        """Translate the body of a loop."""
        self._loops.append(loop)
        self._body(body)
        self._loops.pop()
        self._lead(loop.following, loop.at_following)

    def _lead(self, label: str, at_label: list[Names]) -> None:
        """Continue at a block of a loop, unless the present one has been left."""
        if not self.code.closed:
            at_label.append(self.variables.assigned)
            self.code.jump(label)

    def _after(self, loop: _Loop) -> None:
        """Go on after a loop, if anything leads there."""
        if loop.at_end:
            self.variables.meet(loop.at_end)
            self.code.begin(loop.end)

    def _for_each(self, node: ast.For, items: tuple[Value, ...]) -> None:
        """Translate a loop over items, each round by itself; static items stay static."""
        if node.orelse:
            raise SubsetError("`else` of a loop", "write an if after it")
        end, at_end = self.code.label("end"), list[Names]()
        for item in items:
            loop = _Loop(self.code.label("following"), end, [], at_end)
            self._store(node.target, item, keep_static=True)
            self._inside(loop, node.body)
            if not loop.at_following:
                break
            self.variables.meet(loop.at_following)
            self.code.begin(loop.following)
        self._lead(end, at_end)
        self._after(_Loop("", end, [], at_end))

    def _break(self, _node: ast.Break) -> None:
        loop = self._loops[-1]
        self._lead(loop.end, loop.at_end)

    def _continue(self, _node: ast.Continue) -> None:
        loop = self._loops[-1]
        self._lead(loop.following, loop.at_following)

    # ---------------------------------------------------------------------------- assignments, ends

    def _pass(self, _node: ast.Pass) -> None:
        pass

    def _expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.expressions.evaluate(node.value)

    def _return(self, node: ast.Return) -> None:
        value = self.expressions.evaluate(node.value) if node.value else Group(None, ())
        self._give_back(value)

    def _give_back(self, value: Value) -> None:
        value = at_run_time(value)
        type_ = type_of(value)
        result = type_ if self._result is None else joined(self._result, type_)
        if result is None:
            words = " and ".join(map(in_words, (self._result, type_)))  # type: ignore[arg-type]
            raise SubsetError(f"the kernel returns {words}", "return values of one type")
        if self._result not in (None, result):
            self._result = result
            raise WidenedError
        self._result = self.result = result
        self.code.give_back(self.code.of_type(value, result))

    def _assignment(self, node: ast.Assign) -> None:
        value = self.expressions.evaluate(node.value)
        for target in node.targets:
            self._store(target, value)

    def _annassign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self._store(node.target, self.expressions.evaluate(node.value))

    def _augassign(self, node: ast.AugAssign) -> None:
        by = self.expressions.evaluate(node.value)
        if isinstance(node.target, ast.Name):
            old = self.look_up(node.target.id)
            self.variables.assign(node.target.id, operate(self.code, type(node.op), old, by))
            return
        place = self._element(node.target)
        self._put(place, operate(self.code, type(node.op), self.code.read(place), by))

    def _store(self, target: ast.expr, value: Value, keep_static: bool = False) -> None:
        if isinstance(target, ast.Name):
            self.variables.assign(target.id, value, keep_static)
        elif isinstance(target, (ast.Tuple, ast.List)):
            items = self.expressions.items(value)
            if len(items) != len(target.elts):
                raise SubsetError(
                    f"{len(items)} values for {len(target.elts)} names", "give each name a value"
                )
            for each, item in zip(target.elts, items, strict=True):
                self._store(each, item, keep_static)
        else:
            self._put(self._element(target), value)

    def _element(self, target: ast.expr) -> Array:
        """Return the elements of an array that are the target of an assignment."""
        if not isinstance(target, ast.Subscript):
            raise SubsetError(
                "an assignment to a member", "replace the tuple: value._replace(name=...)"
            )
        array = self.expressions.evaluate(target.value)
        if not isinstance(array, Array):
            raise SubsetError(
                f"an assignment into {in_words(type_of(array))}", "assign to elements of arrays"
            )
        return part_of(self.code, array, self.expressions.indices(target.slice))

    def _put(self, place: Array, value: Value) -> None:
        """Store a number into an element, or into all elements of a part of an array."""
        if not place.lengths:
            self.code.write(value, place)
            return
        number = self.code.of_kind(value, place.kind)
        length, *lengths = place.lengths
        count = Static(length) if isinstance(length, int) else length

        def fill(n: Number) -> None:
            offset = operate(self.code, ast.Mult, n, Static(place.strides[0]))
            inner = place._replace(
                pointer=self.code.address(place, offset), lengths=tuple(lengths),
                strides=place.strides[1:],
            )  # fmt: skip
            self._put(inner, number)

        self.code.repeat(count, fill)

    _statements: ClassVar[dict[type[ast.stmt], Callable[[Any, Any], None]]] = {
        ast.AnnAssign: _annassign, ast.Assign: _assignment, ast.AugAssign: _augassign,
        ast.Break: _break, ast.Continue: _continue, ast.Expr: _expr, ast.For: _for, ast.If: _if,
        ast.Pass: _pass, ast.Return: _return, ast.While: _while,
    }  # fmt: skip
