"""Statements and functions: from the syntax tree of a kernel to the text of an LLVM function.

A variable has one type wherever branches meet. Where an assignment would give it a wider one, the
function is translated again with that type from the start. A name that is not assigned on every
way to its use is an error.
"""

import ast
import builtins
import inspect
import linecache
from collections import Counter
from collections.abc import Callable
from functools import cache
from types import CodeType
from typing import Any, ClassVar, NamedTuple, Protocol

from model.compile.code import Code, Places, aggregate
from model.compile.expressions import Expressions
from model.compile.kernels import python_of
from model.compile.values import (
    DOUBLE,
    INTEGER,
    Array,
    Group,
    Number,
    Refusal,
    Static,
    StaticType,
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
from model.compile.vector_code import WIDTH, VectorFunction, each_lane


class KernelError(Exception):
    """A kernel holds what the compiler cannot translate.

    The message gives file and line, the kernel, the problem, and what to write instead.
    """


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


class Source(NamedTuple):
    """Source of a kernel: its syntax tree, and the names that are assigned at one place only."""

    tree: ast.FunctionDef
    unchanging: frozenset[str]


@cache
def _functions_in(file: str) -> dict[int, ast.FunctionDef]:
    """Return the functions that a file defines, by the line on which each begins."""
    tree = ast.parse("".join(linecache.getlines(file)), file)
    functions = (each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef))
    return {(each.decorator_list or [each])[0].lineno: each for each in functions}


@cache
def source_of(code: CodeType) -> Source:
    """Return the source of a function, by its code: closures of the same function share it.

    Raises:
        KernelError: it has none, or it is no function of a ``def`` statement.
    """
    tree = _functions_in(code.co_filename).get(code.co_firstlineno)
    if tree is None or tree.name != code.co_name:
        raise KernelError(
            f"{code.co_filename}:{code.co_firstlineno}: kernel {code.co_name!r} has no source; "
            "define it by a def statement in a file"
        )
    return Source(tree, _assigned_once(tree))


@cache
def parameters_of(function: Callable[..., Any]) -> inspect.Signature:
    """Return the parameters of a function of Python."""
    return inspect.signature(function)


def _assigned_once(tree: ast.FunctionDef) -> frozenset[str]:
    """Return the names that are assigned at one place, which is translated once.

    The body of a loop over items is translated for each of them.
    """
    counts = Counter(each.arg for each in ast.walk(tree.args) if isinstance(each, ast.arg))
    counts.update(_assigned(tree))
    for loop in ast.walk(tree):
        if isinstance(loop, (ast.For, ast.comprehension)):
            counts.update(_assigned(loop))
    return frozenset(name for name, count in counts.items() if count == 1)


def _assigned(tree: ast.AST) -> list[str]:
    return [
        each.id
        for each in ast.walk(tree)
        if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)
    ]


class Variable(NamedTuple):
    """A variable: its type, and where it is on the stack or, if it never changes, its value."""

    type: Type
    places: Places
    value: Value | None = None


Names = dict[str, Variable]
"""The names that are assigned at a point of the function."""


class _Loop(NamedTuple):
    """A loop: where ``continue`` and ``break`` lead, and the names assigned at each."""

    following: str
    end: str
    at_following: list[Names]
    at_end: list[Names]


class _Restart(Exception):
    """A variable or the result has turned out to be wider."""


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
        self.source, self.file = source_of(self.function.__code__), self.function.__code__.co_filename
        self.at: ast.stmt = self.source.tree
        self._result: Type | None = None
        self._wider: dict[str, Type] = {}
        while True:
            try:
                self._translate()
                break
            except _Restart:
                pass
            except Refusal as refusal:
                raise self._error(refusal) from None

    def text(self, attributes: str) -> str:
        """Return the function in LLVM's language, with further attributes."""
        kinds = [kind for each in self.types for kind in leaf_kinds(each)]
        listed = ", ".join(f"{kind} %a{n}" for n, kind in enumerate(kinds))
        result = aggregate(leaf_kinds(self.result))
        head = f"define {self.linkage} {result} {self.name}({listed}) nounwind{attributes}"
        return self.code.text(head)

    def _error(self, refusal: Refusal) -> KernelError:
        node: Any = getattr(refusal, "node", None) or self.at
        where = f"{self.file}:{getattr(node, 'lineno', 1)}: in kernel {self.function.__name__!r}"
        return KernelError(f"{where}: {refusal.problem}; {refusal.remedy}")

    def _translate(self) -> None:
        self.code = Code(self.module.contract)
        self.expressions = Expressions(self)
        self.names: Names = {}
        self._places: dict[tuple[str, Type], Places] = {}
        self._loops: list[_Loop] = []
        self._conflicts: dict[str, str] = {}
        self.code.begin("begin")
        kinds = [kind for each in self.types for kind in leaf_kinds(each)]
        leaf_names = iter([f"%a{n}" for n in range(len(kinds))])
        values = [rebuilt(each, leaf_names) for each in self.types]
        parameters = self.source.tree.args
        plain = [each.arg for each in parameters.args]
        for name, value in zip(plain, values, strict=False):
            self._assign(name, value)
        if parameters.vararg:
            self._assign(parameters.vararg.arg, Group(None, tuple(values[len(plain) :])))
        self._body(self.source.tree.body)
        if not self.code.closed:
            self._give_back(Group(None, ()))

    # --------------------------------------------------------------------------------------- scope

    def look_up(self, name: str) -> Value:
        """Return the value of a name: a variable, or an object outside the function."""
        if name in self.names:
            variable = self.names[name]
            if variable.value is not None:
                return variable.value
            return self.code.load(variable.type, variable.places)
        code = self.function.__code__
        if name in code.co_varnames or name in code.co_cellvars:
            if name in self._conflicts:
                raise Refusal(f"{name!r} is {self._conflicts[name]}", "use two names")
            raise Refusal(
                f"{name!r} is not assigned on every way to here", "assign it before the branch"
            )
        if name in code.co_freevars:
            cell = self.function.__closure__[code.co_freevars.index(name)]  # type: ignore[index]
            return Static(cell.cell_contents)
        for known in (self.function.__globals__, vars(builtins)):
            if name in known:
                return Static(known[name])
        raise Refusal(f"{name!r} is not defined", "define or import it")

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
            raise Refusal(f"{name}: {error}", f"call {name}{parameters}") from None
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

    def _assign(self, name: str, value: Value, keep_static: bool = False) -> None:
        if not keep_static:
            value = at_run_time(value)
        type_ = type_of(value)
        if name in self.source.unchanging:
            self.names[name] = Variable(type_, [], value)
            return
        if name in self._wider:
            type_ = joined(self._wider[name], type_) or type_
            value = self.code.of_type(value, type_)
        if (name, type_) not in self._places:
            self._places[name, type_] = self.code.variable(type_)
        places = self._places[name, type_]
        self.code.store(value, places)
        self.names[name] = Variable(type_, places)

    def bind(self, target: ast.expr, value: Value) -> None:
        """Bind the target of a comprehension; static items stay static."""
        self._store(target, value, keep_static=True)

    # ----------------------------------------------------------------------------------- branches

    def _meet(self, ways: list[Names]) -> Names:
        """Return the names that are assigned on every way to a point where ways meet."""
        first, *others = ways
        found: Names = {}
        for name, variable in first.items():
            if not all(name in other for other in others):
                continue
            types = [variable.type, *(other[name].type for other in others)]
            if all(each == variable.type for each in types):
                found[name] = variable
                continue
            wider = None if any(isinstance(each, StaticType) for each in types) else types[0]
            for each in types[1:]:
                wider = None if wider is None else joined(wider, each)
            if wider is None:
                listed = " here and ".join(dict.fromkeys(map(in_words, types)))
                self._conflicts[name] = f"{listed} there"
                continue
            self._widen(name, wider)
        return found

    def _widen(self, name: str, wider: Type) -> None:
        self._wider[name] = wider
        raise _Restart

    def _body(self, statements: list[ast.stmt]) -> None:
        for each in statements:
            if self.code.closed:
                return
            self.at = each
            if type(each) not in self._statements:
                raise Refusal(
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
        before, ways = dict(self.names), []
        for label, statements in ((yes, node.body), (no, node.orelse)):
            self.names = dict(before)
            code.begin(label)
            self._body(statements)
            if not code.closed:
                ways.append(self.names)
                code.jump(end)
        if ways:
            self.names = self._meet(ways)
            code.begin(end)

    def _while(self, node: ast.While) -> None:
        code = self.code
        test, body, end = (code.label(each) for each in ("while", "round", "end"))
        code.jump(test)
        code.begin(test)
        before = dict(self.names)
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
            raise Refusal("a range whose step is 0 or not known", "give an int")
        labels = (code.label(each) for each in ("for", "round", "following", "end"))
        test, body, following, end = labels
        counter = code.variable(INTEGER)
        code.store(first, counter)
        code.jump(test)
        code.begin(test)
        before = dict(self.names)
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
            raise Refusal("a float as an end of a range", "take int(...) of it")
        return self.code.of_kind(number, INTEGER)

    def _round(
        self, node: ast.While | ast.For, loop: _Loop, before: Names, item: Value | None = None
    ) -> None:
        """Translate a round of a loop that is repeated at run time."""
        if node.orelse:
            raise Refusal("`else` of a loop", "write an if after it")
        self.names = dict(before)
        if item is not None:
            self._store(node.target, item)  # type: ignore[union-attr]
        self._inside(loop, node.body)
        for names in loop.at_following:
            self._repeats(before, names)

    def _inside(self, loop: _Loop, body: list[ast.stmt]) -> None:
        """Translate the body of a loop."""
        self._loops.append(loop)
        self._body(body)
        self._loops.pop()
        self._lead(loop.following, loop.at_following)

    def _lead(self, label: str, at_label: list[Names]) -> None:
        """Continue at a block of a loop, unless the present one has been left."""
        if not self.code.closed:
            at_label.append(self.names)
            self.code.jump(label)

    def _repeats(self, before: Names, after: Names) -> None:
        """Check that the variables with which a round begins have the same types after it."""
        for name, variable in before.items():
            if name not in after:
                raise Refusal(f"{name!r} is {self._conflicts[name]}", "use two names")
            if after[name].type == variable.type:
                continue
            wider = joined(after[name].type, variable.type)
            if wider is None:
                words = " and ".join(map(in_words, (variable.type, after[name].type)))
                raise Refusal(f"{name!r} is {words} after a round of the loop", "use two names")
            self._widen(name, wider)

    def _after(self, loop: _Loop) -> None:
        """Go on after a loop, if anything leads there."""
        if loop.at_end:
            self.names = self._meet(loop.at_end)
            self.code.begin(loop.end)

    def _for_each(self, node: ast.For, items: tuple[Value, ...]) -> None:
        """Translate a loop over items, each round by itself; static items stay static."""
        if node.orelse:
            raise Refusal("`else` of a loop", "write an if after it")
        end, at_end = self.code.label("end"), list[Names]()
        for item in items:
            loop = _Loop(self.code.label("following"), end, [], at_end)
            self._store(node.target, item, keep_static=True)
            self._inside(loop, node.body)
            if not loop.at_following:
                break
            self.names = self._meet(loop.at_following)
            self.code.begin(loop.following)
        self._lead(end, at_end)
        self._after(_Loop("", end, [], at_end))

    def _break(self, _node: ast.Break) -> None:
        loop = self._loops[-1]
        self._lead(loop.end, loop.at_end)

    def _continue(self, _node: ast.Continue) -> None:
        loop = self._loops[-1]
        self._lead(loop.following, loop.at_following)

    # ----------------------------------------------------------------------------- assignments, ends

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
            raise Refusal(f"the kernel returns {words}", "return values of one type")
        if self._result not in (None, result):
            self._result = result
            raise _Restart
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
            self._assign(node.target.id, self.expressions.operate(type(node.op), old, by))
            return
        place = self._element(node.target)
        self._put(place, self.expressions.operate(type(node.op), self.code.read(place), by))

    def _store(self, target: ast.expr, value: Value, keep_static: bool = False) -> None:
        if isinstance(target, ast.Name):
            self._assign(target.id, value, keep_static)
        elif isinstance(target, (ast.Tuple, ast.List)):
            items = self.expressions.items(value)
            if len(items) != len(target.elts):
                raise Refusal(
                    f"{len(items)} values for {len(target.elts)} names", "give each name a value"
                )
            for each, item in zip(target.elts, items, strict=True):
                self._store(each, item, keep_static)
        else:
            self._put(self._element(target), value)

    def _element(self, target: ast.expr) -> Array:
        """Return the elements of an array that are the target of an assignment."""
        if not isinstance(target, ast.Subscript):
            raise Refusal(
                "an assignment to a member", "replace the tuple: value._replace(name=...)"
            )
        array = self.expressions.evaluate(target.value)
        if not isinstance(array, Array):
            raise Refusal(
                f"an assignment into {in_words(type_of(array))}", "assign to elements of arrays"
            )
        return self.expressions.part(array, self.expressions.indices(target.slice))

    def _put(self, place: Array, value: Value) -> None:
        """Store a number into an element, or into all elements of a part of an array."""
        if not place.lengths:
            self.code.write(value, place)
            return
        number = self.code.of_kind(value, place.kind)
        length, *lengths = place.lengths
        count = Static(length) if isinstance(length, int) else length

        def fill(n: Number) -> None:
            offset = self.expressions.operate(ast.Mult, n, Static(place.strides[0]))
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
