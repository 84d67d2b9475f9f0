"""Random programs of the subset, as text for the compiler and as a reference for Python.

The texts differ in two marks. ``as_int(`` is a parenthesis for the compiler; the reference wraps at
64 bits there. ``as_float(`` is where the compiler makes a float of an int by itself.
Every name has one type: ``x0`` .. are floats, ``n0`` .. ints, ``b0`` .. bools, ``p0`` a named
tuple, ``w`` an array of floats and ``k`` one of ints.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from hypothesis import strategies as st

LENGTH = 4  # of the arrays
PARAMETERS = "x0, x1, n0, n1, b0, p0, w, k"
_FLOATS, _INTS, _BOOLS = ("x0", "x1", "x2", "p0.x"), ("n0", "n1", "n2", "p0.n"), ("b0", "b1")

REFERENCE = '''\
def as_int(value):
    return (int(value) + 2**63) % 2**64 - 2**63


class Numbers:
    """An array of numbers of one kind, as numpy's but for its elements."""

    def __init__(self, kind, values, first=0):
        self.kind, self.values, self.first = kind, values, first

    def __getitem__(self, index):
        if isinstance(index, slice):
            return Numbers(self.kind, self.values, self.first + index.start)
        return self.values[self.first + index]

    def __setitem__(self, index, value):
        self.values[self.first + index] = self.kind(value)


'''


class Program(NamedTuple):
    """A module of kernels, of which ``main`` is called: for the compiler, and for Python."""

    text: str

    def reference(self) -> str:
        """Return the text for Python."""
        return REFERENCE + self.text.replace("as_float(", "float(")

    def kernels(self) -> str:
        """Return the text for the compiler."""
        return self.text.replace("as_float(", "(").replace("as_int(", "(")


@st.composite
def programs(draw: Callable[..., Any]) -> Program:
    """Draw a program."""
    return _Writer(draw).program()


class _Writer:
    """Draws the parts of a program."""

    def __init__(self, draw: Callable[..., Any]) -> None:
        self.draw = draw
        self.counters = 0
        self.may_call = False

    def one_of(self, *choices: Any) -> Any:
        """Draw one of several things; functions are called."""
        found = self.choice(*choices)
        return found() if callable(found) else found

    def choice(self, *choices: Any) -> Any:
        """Draw one of several things."""
        return self.draw(st.sampled_from(choices))

    # ------------------------------------------------------------------------------ expressions

    def number(self, depth: int) -> str:
        """Draw a float."""
        e, n, b = self.number, self.integer, self.truth
        d = depth - 1
        if depth <= 0:
            return self.one_of(*_FLOATS, "0.5", "-1.25", "3.0", f"w[{self.index()}]")
        return self.one_of(
            lambda: f"({e(d)} {self.one_of('+', '-', '*', '/')} {e(d)})",
            lambda: f"({e(d)} {self.one_of('+', '-', '*', '/')} {n(d)})",
            lambda: f"({n(d)} {self.one_of('+', '-', '*', '/')} {e(d)})",
            lambda: f"(as_float({n(d)}) / as_float({n(d)}))",
            lambda: f"({b(d)} * {e(d)})",
            lambda: f"(-{e(d)})",
            lambda: f"({e(d)}) ** 2",
            lambda: f"abs({e(d)})",
            lambda: f"sqrt(abs({e(d)}))",
            lambda: f"(floor({e(d)}) + 0.0)",
            lambda: f"float({self.choice(n, b)(d)})",
            lambda: f"{self.one_of('min', 'max')}({e(d)}, {e(d)}, {e(0)})",
            lambda: f"({self.one_of('min', 'max')}({e(d)}, as_float({n(d)})) * 1.0)",
            lambda: f"({e(d)} if {b(d)} else {e(d)})",
            lambda: f"({e(d)}, {e(0)}, 0.75)[{self.index(3)}]",
            lambda: f"Pair({e(d)}, y={e(0)}).{self.one_of('x', 'y')}",
            lambda: f"max(v * {e(0)} for v in ({e(d)}, {e(0)}, 2.0))",
            lambda: self.call(0, d),
        )

    def integer(self, depth: int) -> str:
        """Draw an int."""
        e, n, b = self.number, self.integer, self.truth
        d = depth - 1
        if depth <= 0:
            return self.one_of(*_INTS, "1", "-7", "3", "11", f"k[{self.index()}]")
        return self.one_of(
            lambda: f"as_int({n(d)} {self.one_of('+', '-', '*', '&', '|', '^')} {n(d)})",
            lambda: f"({n(d)} {self.one_of('//', '%')} (({n(d)} & 7) + 1))",
            lambda: f"as_int({n(d)} {self.one_of('//', '%')} (({n(d)} & 7) - 9))",
            lambda: f"as_int({n(d)} {self.one_of('<<', '>>')} ({self.one_of(*_INTS)} & 31))",
            lambda: f"as_int({self.one_of('-', '~', '+')}{n(d)})",
            lambda: f"as_int({b(d)} + {n(d)})",
            lambda: f"({b(d)} {self.one_of('+', '-', '*')} {b(d)})",
            lambda: f"as_int(({n(d)}) ** {self.one_of('1', '2')})",
            lambda: f"int({b(d)})",
            lambda: f"int(max(min({e(d)}, 1e6), -1e6))",
            lambda: f"as_int(abs({n(d)}))",
            lambda: f"{self.one_of('min', 'max')}({n(d)}, {n(d)}, {n(0)})",
            lambda: f"({n(d)} if {b(d)} else {n(d)})",
            lambda: f"({n(d)}, 5, {n(0)}, -2)[{self.index()}]",
            lambda: f"len(({n(d)}, {n(0)}))",
            lambda: self.call(1, d),
        )

    def truth(self, depth: int) -> str:
        """Draw a bool."""
        e, n, b = self.number, self.integer, self.truth
        d = depth - 1
        if depth <= 0:
            return self.one_of(*_BOOLS, "p0.flag", "True", "False")
        compare = self.one_of("<", "<=", ">", ">=", "==", "!=")
        return self.one_of(
            lambda: f"({e(d)} {compare} {e(d)})",
            lambda: f"({n(d)} {compare} {n(d)})",
            lambda: f"(as_float({n(d)}) {compare} {e(d)})",
            lambda: f"({b(d)} {compare} {b(d)})",
            lambda: f"({e(d)} <= {e(0)} {compare} as_float({n(0)}))",
            lambda: f"({b(d)} {self.one_of('and', 'or')} {b(d)} {self.one_of('and', 'or')} {b(d)})",
            lambda: f"({b(d)} {self.one_of('&', '|', '^')} {b(d)})",
            lambda: f"(not {self.choice(e, n, b)(d)})",
            lambda: f"bool({self.choice(e, n)(d)})",
            lambda: f"({n(d)} {self.one_of('in', 'not in')} (1, {n(0)}, {n(0)}))",
            lambda: f"{self.one_of('any', 'all')}(v > {e(0)} for v in ({e(d)}, {e(0)}))",
            lambda: f"{self.one_of('isnan', 'isfinite')}({e(d)})",
        )

    def index(self, most: int = LENGTH) -> str:
        """Draw an index below ``most``."""
        known = str(self.draw(st.integers(0, most - 1)))
        return self.one_of(known, f"({self.one_of(*_INTS)} & 3) % {most}")

    def call(self, item: int, depth: int) -> str:
        """Draw the item of a call's result."""
        if not self.may_call:
            return "0.125" if item == 0 else "11"
        arguments = f"{self.number(depth)}, {self.integer(depth)}"
        return f"helped({arguments}, w[{self.one_of('0', '1')}:], k)[{item}]"

    # ------------------------------------------------------------------------------- statements

    def statements(self, depth: int, inside_loop: bool = False) -> list[str]:
        """Draw some statements."""
        lines: list[str] = []
        for _ in range(self.draw(st.integers(1, 3))):
            lines += self.statement(depth, inside_loop)
        return lines

    def statement(self, depth: int, inside_loop: bool) -> list[str]:
        """Draw a statement."""
        e, n, b = self.number, self.integer, self.truth
        x, m = f"x{self.draw(st.integers(0, 2))}", f"n{self.draw(st.integers(0, 2))}"
        simple: list[Callable[[], list[str]]] = [
            lambda: [f"{x} = {e(2)}"],
            lambda: [f"{m} = {n(2)}"],
            lambda: [f"b1 = {b(2)}"],
            lambda: [f"{x} {self.one_of('+=', '-=', '*=', '/=')} {e(1)}"],
            lambda: [f"{m} {self.one_of('+=', '-=', '*=', '&=')} {n(1)}", f"{m} = as_int({m})"],
            lambda: [f"{x}, {m} = {e(1)}, {n(1)}"],
            lambda: ["x0, x1 = x1, x0"],
            lambda: [f"w[{self.index(3)}] {self.one_of('=', '+=', '*=')} {self.choice(e, n)(1)}"],
            lambda: [f"i = {self.index()}", f"k[i] {self.one_of('=', '+=', '-=')} {n(1)}",
                     "k[i] = as_int(k[i])"],
            lambda: [f"p0 = p0._replace(x={e(1)}, flag={b(1)})"],
            lambda: [f"p0 = Point({e(1)}, {n(1)}, flag={b(1)})"],
            lambda: [f"{x}, {m} = helped({e(1)}, {n(1)}, w, k)"] if self.may_call else ["pass"],
        ]  # fmt: skip
        nested = [self._branch, self._loop, self._while, self._unrolled, self._early]
        is_nested = depth > 0 and self.draw(st.booleans())
        lines: list[str] = self.choice(*nested)(depth) if is_nested else self.choice(*simple)()
        if inside_loop and self.draw(st.booleans()):
            lines += [f"if {b(1)}:", f"    {self.one_of('break', 'continue')}"]
        return lines

    def block(self, depth: int, inside_loop: bool = False) -> list[str]:
        """Draw statements, indented."""
        return [f"    {line}" for line in self.statements(depth - 1, inside_loop)]

    def _branch(self, depth: int) -> list[str]:
        lines = [f"if {self.choice(self.truth, self.integer, self.number)(2)}:", *self.block(depth)]
        if self.draw(st.booleans()):
            lines += [f"elif {self.truth(1)}:", *self.block(depth)]
        if self.draw(st.booleans()):
            lines += ["else:", *self.block(depth)]
        return lines

    def _counter(self) -> str:
        self.counters += 1
        return f"i{self.counters}"

    def _loop(self, depth: int) -> list[str]:
        i = self._counter()
        over = self.one_of(
            f"range({self.integer(1)} & 3)",
            f"range(1, {self.integer(0)} & 7, 2)",
            "range(5, 1, -2)",
        )
        first = self.one_of(f"n2 = as_int(n2 + {i})", f"x2 = x2 + {i}", f"{i} = {i} + 3")
        return [f"for {i} in {over}:", f"    {first}", *self.block(depth, inside_loop=True)]

    def _while(self, depth: int) -> list[str]:
        i = self._counter()
        head = [f"{i} = 0", f"while {i} < 4 and {self.truth(1)}:", f"    {i} += 1"]
        return [*head, *self.block(depth, inside_loop=True)]

    def _unrolled(self, depth: int) -> list[str]:
        i = self._counter()
        head = self.one_of(
            f"for {i} in ({self.number(1)}, {self.number(0)}):\n    x2 = x2 - {i}",
            f"for {i} in ({self.integer(1)}, 3):\n    n2 = n2 ^ {i}",
            f"for {i} in (0, 1, 3):\n    n2 = as_int(n2 + (7, -5, 3, n1)[{i}])",
            f"for {i}, (v{i}, _) in enumerate(zip((x0, x1), (n0, b0))):\n    x2 = v{i} * {i}",
            f"for {i} in reversed((x0, x1)):\n    x2 = {i}",
        )
        return [*head.splitlines(), *self.block(depth, inside_loop=True)]

    def _early(self, _depth: int) -> list[str]:
        return [f"if {self.truth(2)}:", f"    {self._return()}"]

    def _return(self) -> str:
        return f"return {self.number(1)}, {self.integer(1)}"

    # --------------------------------------------------------------------------------- programs

    def function(self, name: str, parameters: str, before: list[str], depth: int) -> str:
        """Draw a kernel; it returns a float and an int."""
        mark = self.one_of("kernel", "inlined_kernel", "separate_kernel")
        body = [*before, "x2, n2, b1 = 0.5, 1, False", *self.statements(depth), self._return()]
        lines = "\n    ".join(body)
        return f"@{mark}\ndef {name}({parameters}):\n    {lines}\n"

    def program(self) -> Program:
        """Draw a program of one or two kernels; each returns a float and an int."""
        texts = []
        if self.draw(st.booleans()):
            before = ["x1, n1, b0, p0 = x0, n0, x0 > 1.0, Point(x0, n0)"]
            texts.append(self.function("helped", "x0, n0, w, k", before, 1).replace("w[", "w[0 * "))
            self.may_call = True
        texts.append(self.function("main", PARAMETERS, [], 3))
        return Program("\n\n".join(texts))
