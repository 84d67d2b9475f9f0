"""Functions of vectors, written in LLVM's language, and how many numbers a vector has."""

import ctypes
import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from model.compile.identity import OutsideError, digest_of
from model.compile.machine_code import floats_in_a_vector
from model.compile.values import constant

WIDTHS = (8, 4, 2, 1)


def _width() -> int:
    stated = os.environ.get("VIBRALIGN_WIDTH") or str(floats_in_a_vector())
    if stated not in map(str, WIDTHS):
        raise ValueError(f"VIBRALIGN_WIDTH = {stated!r}: must be 8, 4, 2 or 1")
    return int(stated)


WIDTH = _width()
"""Numbers in a vector: one for all code of a process, that of the processor's vectors, unless
``VIBRALIGN_WIDTH`` states it (decision 61)."""

_VECTOR = f"<{WIDTH} x double>"
_ALIGNMENT = 8 * WIDTH  # bytes


class VectorWriter:
    """Writer of a function in LLVM's language, whose arguments are pointers to vectors.

    Methods that compute return the name of the result in the code; their operands are such names,
    or constants. The text is written here, since llvmlite takes seven times as long. Loads are
    cached within a block: code must not change a vector that it has loaded, except by ``store``.
    """

    def __init__(self, name: str, pointers: int) -> None:
        self.arguments = [f"%argument{n}" for n in range(pointers)]
        arguments = ", ".join(f"ptr noalias {each}" for each in self.arguments)
        self.lines = [
            f"declare {_VECTOR} @llvm.fmuladd.v{WIDTH}f64({_VECTOR}, {_VECTOR}, {_VECTOR})",
            f"declare {_VECTOR} @llvm.fabs.v{WIDTH}f64({_VECTOR})",
            f"declare {_VECTOR} @llvm.sqrt.v{WIDTH}f64({_VECTOR})",
            f"define void @{name}({arguments}) nounwind {{",
        ]
        self.begin("entry")

    def code(self) -> str:
        """Return the code of the function, with the declarations that it needs."""
        return "\n".join((*self.lines, "ret void", "}"))

    def begin(self, block: str) -> None:
        """Begin a new block."""
        self.block = block
        self.bases: dict[tuple[str, str, int], str] = {}
        self.loaded: dict[tuple[str, str | int], str] = {}
        self.lines.append(f"{block}:")

    def name(self, what: str) -> str:
        """A name that the code does not contain yet."""
        return f"{what}{len(self.lines)}"

    def result(self, operation: str) -> str:
        """The result of an operation."""
        name = self.name("%v")
        self.lines.append(f"{name} = {operation}")
        return name

    def count(self, operation: str, a: str, b: str) -> str:
        """The result of an operation on integers."""
        return self.result(f"{operation} i64 {a}, {b}")

    def do(self, operation: str, *of: str) -> str:
        """The result of an operation on vectors."""
        return self.result(f"{operation} {_VECTOR} {', '.join(of)}")

    def call(self, function: str, *of: str) -> str:
        """The result of a function of vectors."""
        listed = ", ".join(f"{_VECTOR} {each}" for each in of)
        return self.result(f"call {_VECTOR} @llvm.{function}.v{WIDTH}f64({listed})")

    def fma(self, a: str, b: str, c: str) -> str:
        """The sum ``a * b + c``."""
        return self.call("fmuladd", a, b, c)

    def vector(self, number: float) -> str:
        """A vector with ``number`` in every lane."""
        each = f"double {constant(float(number)).name}"
        return f"<{', '.join([each] * WIDTH)}>"

    def everywhere(self, count: str) -> str:
        """A vector with an integer in every lane; ``count`` is its name in the code."""
        number = self.result(f"sitofp i64 {count} to double")
        one = self.result(f"insertelement {_VECTOR} undef, double {number}, i64 0")
        first = f"<{WIDTH} x i32> zeroinitializer"
        return self.result(f"shufflevector {_VECTOR} {one}, {_VECTOR} undef, {first}")

    def address(self, pointer: str, row: str | int) -> str:
        """The address of a vector: of a row, from a pointer on."""
        return self.result(f"getelementptr {_VECTOR}, ptr {pointer}, i64 {row}")

    def base(self, pointer: str, index: str, rows: int = 1) -> str:
        """The address of the vector at ``index`` times ``rows``, computed once in a block."""
        key = pointer, index, rows
        if key not in self.bases:
            row = index if rows == 1 else self.count("mul", index, str(rows))
            self.bases[key] = self.address(pointer, row)
        return self.bases[key]

    def load(self, pointer: str, row: str | int) -> str:
        """The vector in a row, loaded once in a block."""
        if (pointer, row) not in self.loaded:
            address = self.address(pointer, row)
            loaded = self.result(f"load {_VECTOR}, ptr {address}, align {_ALIGNMENT}")
            self.loaded[pointer, row] = loaded
        return self.loaded[pointer, row]

    def store(self, value: str, pointer: str, row: str | int) -> None:
        """Write the vector in a row."""
        address = self.address(pointer, row)
        self.lines.append(f"store {_VECTOR} {value}, ptr {address}, align {_ALIGNMENT}")
        self.loaded[pointer, row] = value

    def whole_number(self, pointer: str) -> str:
        """The number at ``pointer``, as an integer."""
        number = self.result(f"load double, ptr {pointer}")
        return self.result(f"fptosi double {number} to i64")

    def merged(self, *cases: tuple[str, str]) -> str:
        """The vector of the case (block, vector) whose block has just run: LLVM's phi."""
        listed = ", ".join(f"[{value}, %{block}]" for block, value in cases)
        return self.result(f"phi {_VECTOR} {listed}")

    def repeat(self, count: str, write: Callable[..., Sequence[str]], *starts: str) -> list[str]:
        """Write a loop of ``count`` rounds, >= 1, and return the last values that it carries.

        ``write(index, *carried)`` writes the body and returns the values of the next round, from
        ``starts`` on.
        """
        before, body, after = self.block, self.name("loop"), self.name("after")
        self.lines.append(f"br label %{body}")
        self.begin(body)
        first = len(self.lines)
        carried = [self.result("") for _ in ("0", *starts)]
        values = list(write(*carried))
        following = self.count("add", carried[0], "1")
        kinds = "i64", *[_VECTOR] * len(starts)
        phis = zip(kinds, ("0", *starts), (following, *values), strict=True)
        for n, (kind, start, value) in enumerate(phis, first):
            self.lines[n] += f"phi {kind} [{start}, %{before}], [{value}, %{self.block}]"
        goes_on = self.count("icmp slt", following, count)
        self.lines.append(f"br i1 {goes_on}, label %{body}, label %{after}")
        self.begin(after)
        return values


def each_lane() -> range:
    """Return the numbers of the lanes of a vector; a loop over them becomes vector code.

    A round of the loop must not read what another one writes.
    """
    return range(WIDTH)


class VectorFunction:
    """A function of vectors: a kernel calls it with an array whose rows are vectors.

    ``function(block, rows)`` passes the addresses of these rows of a block of shape (n, WIDTH).

    Args:
        label: begins its name.
        write: (name) -> writer of the function.
    """

    is_vector = True

    def __init__(self, label: str, write: Callable[[str], VectorWriter]) -> None:
        self._label, self._write = label, write

    @property
    def name(self) -> str:
        """Its name, which stands for its code."""
        try:
            return f"{self._label}_{digest_of(self._write)}"
        except OutsideError:
            return f"{self._label}_{digest_of(self._write(self._label).code())}"

    @property
    def identity(self) -> str:
        """Its name, for the cache."""
        return self.name

    def text(self) -> str:
        """Return the function in LLVM's language."""
        return self._write(self.name).code()

    def __call__(self, block: Any, rows: Sequence[int]) -> None:
        """Call its machine code; for kernels that run as Python."""
        from model.compile.entries import address_of  # noqa: PLC0415 - it builds upon this module

        call_at(address_of(self), block, rows)

    def linked(self) -> "Iterator[VectorFunction]":
        """Yield itself: it calls no others."""
        yield self


def call_at(address: int, block: Any, rows: Sequence[int]) -> None:
    """Call the function of vectors at an address, from a kernel; see ``VectorFunction``.

    Called as Python, too, it calls machine code.
    """
    function = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(rows))(int(address))
    function(*(block.ctypes.data + _ALIGNMENT * row for row in rows))
