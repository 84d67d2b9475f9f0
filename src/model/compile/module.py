"""Modules: kernels that become machine code together, as text in LLVM's language.

A module has one kernel that is called from outside, and all that it calls. A kernel that is marked
``separate_kernel`` becomes a module of its own, a *part*, which others call by its name.
"""

from collections.abc import Callable, Iterator
from typing import Any

from numpy.typing import NDArray

from model.compile.code import Code, aggregate
from model.compile.identity import digest_of, is_outside
from model.compile.kernels import marks_of, python_of
from model.compile.translate import Function
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    POINTER,
    Array,
    SubsetError,
    Type,
    Value,
    constant,
    contiguous,
    leaf_kinds,
    leaves,
    rebuilt,
    type_of,
)
from model.compile.vector_code import WIDTH, VectorFunction

_DECLARATIONS = """\
declare double @llvm.fabs.f64(double)
declare double @llvm.floor.f64(double)
declare double @llvm.sqrt.f64(double)
declare double @llvm.pow.f64(double, double)
declare i64 @llvm.abs.i64(i64, i1)
"""

Key = tuple[Callable[..., Any], tuple[Type, ...]]
"""A kernel, and the types of its arguments."""


def name_of(key: Key, *, is_entry: bool = False, contract: bool = True) -> str:
    """Return the name of the function that a module defines: the same in every process."""
    role = "entry" if is_entry else "part"
    return f"{python_of(key[0]).__name__}_{role}_{digest_of(key, contract)}"


class Module:
    """Text of kernels that become machine code together.

    Args:
        key: the kernel that is called from outside.
        parts: modules made so far, shared by all that are linked; None to write all kernels into
            this one.
        is_entry: True for a kernel that Python calls; see entries.py.
        contract: whether a product and a sum may become one operation.

    Attributes:
        name: name of its function.
        result: type of what the kernel returns.
        files: files outside the package from which it is made.
    """

    is_vector = False

    def __init__(
        self,
        key: Key,
        parts: "dict[Key, Module] | None",
        *,
        is_entry: bool = False,
        contract: bool = True,
    ) -> None:
        self.contract, self._parts = contract, parts
        self.name = name_of(key, is_entry=is_entry, contract=contract)
        self.files: set[str] = set()
        self._called: dict[str, Module | VectorFunction] = {}
        self._texts: list[str] = []
        self._functions: dict[Key, tuple[str, Type] | None] = {}
        self._arrays: dict[int, tuple[Array, Any]] = {}
        self._declared: dict[str, str] = {}
        self._loops = 0
        if is_entry:
            function, self.result = self._translated(key, "@whole", "internal")
            self._texts.append(_entry(self.name, function, key[1], self.result))
        else:
            _, self.result = self._translated(key, f"@{self.name}", "")

    def text(self) -> str:
        """Return the module in LLVM's language."""
        return "\n".join([_DECLARATIONS, *self._declared.values(), *self._texts])

    def linked(self) -> "Iterator[Module | VectorFunction]":
        """Yield all parts that it calls, directly or not, each once and before its callers; it."""
        seen: set[str] = set()

        def visit(module: "Module | VectorFunction") -> "Iterator[Module | VectorFunction]":
            if module.name not in seen:
                seen.add(module.name)
                for each in getattr(module, "_called", {}).values():
                    yield from visit(each)
                yield module

        return visit(self)

    def call(self, code: Code, function: Callable[..., Any], arguments: list[Value]) -> Value:
        """Call a kernel with these arguments, in the order of its parameters."""
        key = function, tuple(map(type_of, arguments))
        marks = marks_of(function)
        if self._parts is not None and marks is not None and marks.separate:
            name, result = self._part(key)
        elif key not in self._functions:
            inlined = " alwaysinline" if marks is not None and marks.inlined else ""
            name = f"@f{len(self._functions)}_{python_of(function).__name__}"
            name, result = self._translated(key, name, "internal", inlined)
        else:
            known = self._functions[key]
            if known is None:
                raise SubsetError(f"{python_of(function).__name__} calls itself", "write a loop")
            name, result = known
        return code.call(name, result, arguments)

    def _part(self, key: Key) -> tuple[str, Type]:
        """Return name and result of a kernel that is a module of its own."""
        parts: Any = self._parts
        if key not in parts:
            parts[key] = Module(key, parts, contract=self.contract)
        part: Module = parts[key]
        self._called[part.name] = part
        kinds = ", ".join(kind for each in key[1] for kind in leaf_kinds(each))
        head = f"{aggregate(leaf_kinds(part.result))} @{part.name}({kinds})"
        self._declared[part.name] = f"declare {head} nounwind"
        return f"@{part.name}", part.result

    def _translated(self, key: Key, name: str, linkage: str, rest: str = "") -> tuple[str, Type]:
        function, types = key
        self._functions[key] = None
        made = Function(self, name, function, [*types], linkage)
        self._texts.append(made.text(rest))
        self._functions[key] = name, made.result
        if is_outside(made.file):
            self.files.add(made.file)
        return name, made.result

    def array(self, known: NDArray[Any]) -> Array:
        """Return an array of numpy as constants."""
        if id(known) not in self._arrays:
            kind = {"f": DOUBLE, "i": INTEGER}.get(known.dtype.kind)
            if kind is None:
                raise SubsetError(f"an array of {known.dtype}", "give one of floats or of int64")
            name = f"@array{len(self._arrays)}"
            numbers = ", ".join(f"{kind} {constant(each).name}" for each in known.ravel().tolist())
            place = f"[{known.size} x {kind}]"
            self._declared[name] = f"{name} = internal constant {place} [{numbers}], align 64"
            found = Array(name, kind, known.shape, contiguous(known.shape))
            self._arrays[id(known)] = found, known
        return self._arrays[id(known)][0]

    def vectorized(self) -> tuple[str, str]:
        """Return metadata of accesses in a new loop over lanes, and of its jump back."""
        group = 2 * self._loops
        self._loops += 1
        hints = (
            '"llvm.loop.vectorize.enable", i1 true', f'"llvm.loop.vectorize.width", i32 {WIDTH}',
            '"llvm.loop.interleave.count", i32 1', '"llvm.loop.unroll.disable"',
            f'"llvm.loop.parallel_accesses", !{group}',
        )  # fmt: skip
        listed = ", ".join([f"!{group + 1}", *(f"!{{!{each}}}" for each in hints)])
        self._declared[f"!{group}"] = (
            f"!{group} = distinct !{{}}\n!{group + 1} = distinct !{{{listed}}}"
        )
        return f", !llvm.access.group !{group}", f", !llvm.loop !{group + 1}"

    def call_vectors(self, code: Code, function: VectorFunction, pointers: list[str]) -> None:
        """Call a function of vectors."""
        listed = ", ".join(["ptr"] * len(pointers))
        self._declared[function.name] = f"declare void @{function.name}({listed}) nounwind"
        self._called[function.name] = function
        code.put(f"call void @{function.name}({', '.join(f'ptr {each}' for each in pointers)})")


def _entry(name: str, function: str, types: tuple[Type, ...], result: Type) -> str:
    """Return the function that Python or a page calls; see entries.py."""
    code = Code(contract=False)
    code.begin("begin")
    kinds = [kind for each in types for kind in leaf_kinds(each)]
    leaf_names = iter([_word(code, n, kind) for n, kind in enumerate(kinds)])
    arguments = [rebuilt(each, leaf_names) for each in types]
    for n, leaf in enumerate(leaves(code.call(function, result, arguments))):
        place = code.do(f"getelementptr i64, ptr %result, i64 {n}")
        whole = code.of_kind(leaf, INTEGER) if leaf.kind == BOOLEAN else leaf
        code.put(f"store {whole.kind} {whole.name}, ptr {place}, align 1")
    code.leave("ret void")
    return code.text(f"define void @{name}(ptr %words, ptr %result) nounwind")


def _word(code: Code, n: int, kind: str) -> str:
    """Return the n-th word as a number of this kind, or as an address."""
    place = code.do(f"getelementptr i64, ptr %words, i64 {n}")
    if kind == DOUBLE:
        return code.do(f"load double, ptr {place}, align 1")
    word = code.do(f"load i64, ptr {place}, align 1")
    if kind == POINTER:
        return code.do(f"inttoptr i64 {word} to ptr")
    return code.do(f"icmp ne i64 {word}, 0") if kind == BOOLEAN else word
