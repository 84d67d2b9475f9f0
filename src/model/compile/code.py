"""Code of one function in LLVM's language, as it is written: blocks, instructions, variables.

Variables are places on the stack, which LLVM's optimiser turns into registers. A place is a value
with addresses in place of its numbers.
"""

import os
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    KINDS,
    Array,
    Number,
    SubsetError,
    Type,
    Value,
    at_run_time,
    check_same,
    constant,
    element_kind,
    element_strides,
    in_words,
    known_number,
    leaf_kinds,
    leaves,
    rebuilt,
    type_of,
)
from model.compile.vector_code import WIDTH, VectorFunction

_CONVERSIONS = {
    (BOOLEAN, INTEGER): "zext i1 {} to i64",
    (BOOLEAN, DOUBLE): "uitofp i1 {} to double",
    (INTEGER, DOUBLE): "sitofp i64 {} to double",
    (DOUBLE, INTEGER): "fptosi double {} to i64",
    (DOUBLE, BOOLEAN): "fcmp une double {}, 0.0",
    (INTEGER, BOOLEAN): "icmp ne i64 {}, 0",
}
CHECKED = os.environ.get("VIBRALIGN_CHECKED", "0") not in ("", "0")
"""True if machine code tells of every index beyond its array: with ``VIBRALIGN_CHECKED=1``."""
BEYOND = "index_beyond_its_array"
"""Function (where, index, length) that it calls, provided by entries.py."""
_SCRATCH = "@scratch"  # what is written in place of what lies beyond
PYTHON_KINDS = {BOOLEAN: bool, INTEGER: int, DOUBLE: float}


class Declarations:
    """Parts that the functions of a module share: constants, functions elsewhere, loops over lanes.

    Attributes:
        contract: whether a product and a sum may become one operation.
        checked: whether indices of run time are checked.
        texts: each declaration in LLVM's language, by its name.
        vectors: functions of vectors that are called, by their names.
    """

    def __init__(self, contract: bool, checked: bool = False) -> None:
        self.contract, self.checked = contract, checked
        self.texts: dict[str, str] = {}
        self.vectors: dict[str, VectorFunction] = {}
        self._arrays: dict[int, tuple[Array, Any]] = {}

    def array(self, known: NDArray[Any]) -> Array:
        """Return an array of numpy as constants."""
        if id(known) not in self._arrays:
            kind, name = element_kind(known), f"@array{len(self._arrays)}"
            numbers = ", ".join(f"{kind} {constant(each).name}" for each in known.ravel().tolist())
            place = f"[{known.size} x {kind}]"
            self.texts[name] = f"{name} = internal constant {place} [{numbers}], align 64"
            strides = element_strides(np.ascontiguousarray(known))
            found = Array(name, kind, known.shape, strides, is_constant=True)
            self._arrays[id(known)] = found, known
        return self._arrays[id(known)][0]

    def lanes(self) -> tuple[str, str]:
        """Return metadata of accesses in a new loop over lanes, and of its jump back.

        LLVM unrolls a loop of two rounds, and tells on standard error that it is no vector then.
        """
        if self.checked or WIDTH <= 2:
            return "", ""
        group = 2 * len(self.texts)
        hints = (
            '"llvm.loop.vectorize.enable", i1 true', f'"llvm.loop.vectorize.width", i32 {WIDTH}',
            '"llvm.loop.interleave.count", i32 1', '"llvm.loop.unroll.disable"',
            f'"llvm.loop.parallel_accesses", !{group}',
        )  # fmt: skip
        loop = f"!{group + 1}"
        listed = ", ".join([loop, *(f"!{{!{each}}}" for each in hints)])
        self.texts[loop] = f"!{group} = distinct !{{}}\n{loop} = distinct !{{{listed}}}"
        return f", !llvm.access.group !{group}", f", !llvm.loop {loop}"

    def told(self, text: str) -> str:
        """Return the address of a text for ``BEYOND``."""
        name = f"@told{len(self.texts)}"
        held = "".join(f"\\{each:02X}" for each in (*text.encode(), 0))
        kind = f"[{len(held) // 3} x i8]"
        self.texts[name] = f'{name} = internal constant {kind} c"{held}"'
        self.texts[_SCRATCH] = f"{_SCRATCH} = internal global [{1 << 16} x i64] zeroinitializer"
        self.function(BEYOND, ["ptr", "i64", "i64"])
        return name

    def function(self, name: str, kinds: list[str], result: str = "void") -> None:
        """Declare a function of another module."""
        self.texts[name] = f"declare {result} @{name}({', '.join(kinds)}) nounwind"


class Code:
    """The code of one function.

    Attributes:
        declared: declarations of the module.
        closed: True after an instruction that leaves the block: what follows is never reached.
        contract: flag of instructions that may become fused multiply-adds, or nothing.
        group: metadata of accesses to memory in a loop over lanes, or nothing.
        where: tells file, line and kernel of what is translated.
    """

    def __init__(self, declared: Declarations, where: Callable[[], str] = str) -> None:
        self.declared, self.where = declared, where
        self.contract = " contract" if declared.contract else ""
        self.group = ""
        self.closed = True
        self._count = 0
        self._variables: list[str] = []
        self._lines: list[str] = []

    # ------------------------------------------------------------------------------------- blocks

    def text(self, head: str) -> str:
        """Return the whole function, after its ``head``."""
        return "\n".join(
            [head + " {\nentry:", *self._variables, "br label %begin", *self._lines, "}"]
        )

    def labels(self, *what: str) -> list[str]:
        """Return names of new blocks."""
        self._count += 1
        return [f"{each}{self._count}" for each in what]

    def begin(self, label: str) -> None:
        """Begin a block."""
        self._lines.append(f"{label}:")
        self.closed = False

    def put(self, text: str) -> None:
        """Write an instruction without a result."""
        self._lines.append(text)

    def do(self, text: str) -> str:
        """Write an instruction and return the name of its result."""
        self._count += 1
        name = f"%v{self._count}"
        self._lines.append(f"{name} = {text}")
        return name

    def leave(self, text: str) -> None:
        """Write the last instruction of a block."""
        self._lines.append(text)
        self.closed = True

    def jump(self, label: str, metadata: str = "") -> None:
        """Continue at a block, unless the present one has been left."""
        if not self.closed:
            self.leave(f"br label %{label}{metadata}")

    def branch(self, condition: Number, yes: str, no: str) -> None:
        """Continue at one of two blocks."""
        self.leave(f"br i1 {condition.name}, label %{yes}, label %{no}")

    # ---------------------------------------------------------------------------- places in memory

    def variable(self, type_: Type) -> Value:
        """Return a new place for values of this type."""
        names = []
        for kind in leaf_kinds(type_):
            self._count += 1
            names.append(f"%v{self._count}")
            self._variables.append(f"{names[-1]} = alloca {kind}")
        return rebuilt(type_, iter(names))

    def store(self, value: Value, place: Value) -> None:
        """Store a value of the place's type."""
        for leaf, at in zip(leaves(value), leaves(place), strict=True):
            self.put(f"store {at.kind} {leaf.name}, ptr {at.name}{self.group}")

    def load(self, place: Value) -> Value:
        """Load the value of a place."""
        names = [self.do(f"load {at.kind}, ptr {at.name}{self.group}") for at in leaves(place)]
        return rebuilt(place, iter(names))

    def address(self, array: Array, offset: Value) -> str:
        """Return the address of a number of an array, ``offset`` numbers after the first."""
        place = self.number(offset)
        if known_number(place) == 0:
            return array.pointer
        return self.do(f"getelementptr {array.kind}, ptr {array.pointer}, i64 {place.name}")

    def checked(self, index: Number, length: Number) -> Number:
        """Return whether an index lies in an array of this length; if not, it is told."""
        inside = Number(BOOLEAN, self.do(f"icmp ult i64 {index.name}, {length.name}"))
        beyond, after = self.labels("beyond", "after")
        self.branch(inside, after, beyond)
        self.begin(beyond)
        told = self.declared.told(self.where())
        self.put(f"call void @{BEYOND}(ptr {told}, i64 {index.name}, i64 {length.name})")
        self.jump(after)
        self.begin(after)
        return inside

    def instead(self, inside: Number, address: str) -> str:
        """Return an address, or another that may be written if what is there lies beyond."""
        return self.do(f"select i1 {inside.name}, ptr {address}, ptr {_SCRATCH}")

    # ------------------------------------------------------------------------------------ numbers

    def number(self, value: Value, what: str = "this") -> Number:
        """Return a value that must be a number."""
        found = at_run_time(value)
        if not isinstance(found, Number):
            raise SubsetError(
                f"{what} must be a number, and is {in_words(type_of(found))}", "pass one"
            )
        return found

    def whole(self, value: Value, what: str) -> Number:
        """Return a value that must be an int or a bool, as an int."""
        number = self.number(value, what)
        if number.kind == DOUBLE:
            raise SubsetError(f"a float as {what}", "take int(...) of it")
        return self.of_kind(number, INTEGER)

    def of_kind(self, value: Value, kind: str) -> Number:
        """Return a number as one of another kind, as Python converts it."""
        number = self.number(value)
        if number.kind == kind:
            return number
        if (known := known_number(number)) is not None:
            return constant(PYTHON_KINDS[kind](known))
        return Number(kind, self.do(_CONVERSIONS[number.kind, kind].format(number.name)))

    def widened(self, one: Value, other: Value, least: str = BOOLEAN) -> tuple[Number, Number]:
        """Return two numbers as numbers of the wider kind, and at least of the kind ``least``."""
        kind = max(self.number(one).kind, self.number(other).kind, least, key=KINDS.index)
        return self.of_kind(one, kind), self.of_kind(other, kind)

    def arithmetic(self, operation: str, one: Value, other: Value) -> Number:
        """Return a sum, difference, product or quotient: "add", "sub", "mul" or "div"."""
        a, b = self.widened(one, other, DOUBLE if operation == "div" else INTEGER)
        if a.kind == DOUBLE:
            text = f"f{operation}{self.contract} double {a.name}, {b.name}"
            return Number(DOUBLE, self.do(text))
        return self.integers(operation, a, b)

    def integers(self, operation: str, one: Value, other: Value) -> Number:
        """Return the result of an instruction on integers, or on two booleans."""
        a, b = self.number(one), self.number(other)
        if a.kind != BOOLEAN or b.kind != BOOLEAN or operation not in ("and", "or", "xor"):
            a, b = (self.whole(each, "an operand of this") for each in (a, b))
        return Number(a.kind, self.do(f"{operation} {a.kind} {a.name}, {b.name}"))

    def compare(self, how: str, one: Value, other: Value) -> Number:
        """Compare two numbers: "eq", "ne", "lt", "le", "gt" or "ge"."""
        is_equality = how in ("eq", "ne")
        a, b = self.widened(one, other, BOOLEAN if is_equality else INTEGER)
        if a.kind == DOUBLE:
            text = f"fcmp {'une' if how == 'ne' else f'o{how}'} double {a.name}, {b.name}"
        else:
            text = f"icmp {how if is_equality else f's{how}'} {a.kind} {a.name}, {b.name}"
        return Number(BOOLEAN, self.do(text))

    def select(self, condition: Number, yes: Value, no: Value) -> Value:
        """Return one of two values of the same type, both of which are computed."""
        check_same(type_of(yes), type_of(no))
        head, both = f"select i1 {condition.name}", zip(leaves(yes), leaves(no), strict=True)
        names = [self.do(f"{head}, {a.kind} {a.name}, {b.kind} {b.name}") for a, b in both]
        return rebuilt(yes, iter(names))

    # -------------------------------------------------------------------------------------- calls

    def intrinsic(self, name: str, *values: Value) -> Number:
        """Return the result of a function of floats that LLVM knows."""
        numbers = ", ".join(f"double {self.of_kind(each, DOUBLE).name}" for each in values)
        return Number(DOUBLE, self.do(f"call{self.contract} double @llvm.{name}.f64({numbers})"))

    def call(self, function: str, result: Type, arguments: Iterable[Value]) -> Value:
        """Call a function: a name of the module, or an address."""
        found = [leaf for each in arguments for leaf in leaves(each)]
        listed = ", ".join(f"{each.kind} {each.name}" for each in found)
        kinds = leaf_kinds(result)
        text = f"call {aggregate(kinds)} {function}({listed}){self.group}"
        if not kinds:
            self.put(text)
            return result
        if len(kinds) == 1:
            return rebuilt(result, iter([self.do(text)]))
        whole = f"extractvalue {aggregate(kinds)} {self.do(text)}"
        return rebuilt(result, iter([self.do(f"{whole}, {n}") for n in range(len(kinds))]))

    def call_vectors(self, function: VectorFunction | str, pointers: list[str]) -> None:
        """Call a function of vectors: one of the package, or an address."""
        if isinstance(function, VectorFunction):
            self.declared.vectors[function.name] = function
            self.declared.function(function.name, ["ptr"] * len(pointers))
            function = f"@{function.name}"
        self.put(f"call void {function}({', '.join(f'ptr {each}' for each in pointers)})")

    def give_back(self, value: Value) -> None:
        """Return a value from the function."""
        found = [*leaves(value)]
        if len(found) < 2:
            self.leave(f"ret {found[0].kind} {found[0].name}" if found else "ret void")
            return
        whole, kind = "undef", aggregate(leaf_kinds(value))
        for n, each in enumerate(found):
            whole = self.do(f"insertvalue {kind} {whole}, {each.kind} {each.name}, {n}")
        self.leave(f"ret {kind} {whole}")

    # -------------------------------------------------------------------------------------- loops

    def repeat(self, count: Value, write: Callable[[Number], None]) -> None:
        """Write a loop of ``count`` rounds without a break; ``write(n)`` writes the n-th round."""
        counter = self.variable(Number(INTEGER))
        test, body, end = self.labels("test", "round", "end")
        self.store(constant(0), counter)
        self.jump(test)
        self.begin(test)
        n = self.number(self.load(counter))
        self.branch(self.compare("lt", n, count), body, end)
        self.begin(body)
        write(n)
        self.store(self.integers("add", n, constant(1)), counter)
        self.jump(test)
        self.begin(end)


def aggregate(kinds: list[str]) -> str:
    """Return the type of a function's result with these leaves."""
    return "void" if not kinds else kinds[0] if len(kinds) == 1 else f"{{{', '.join(kinds)}}}"
