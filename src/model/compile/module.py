"""Modules: kernels that become machine code together, as text in LLVM's language.

A module has one kernel that is called from outside, and all that it calls. A kernel that is marked
``separate_kernel`` becomes a module of its own, a *part*, which others call by its name.
"""

import hashlib
import re
from collections.abc import Callable, Iterator
from typing import Any, cast

from model.compile.code import CHECKED, Code, Declarations, aggregate
from model.compile.identity import OutsideError, digest_of
from model.compile.kernels import Marks, marks_of, python_of
from model.compile.translate import Function
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    NOTHING,
    POINTER,
    Group,
    Number,
    SubsetError,
    Type,
    Value,
    in_words,
    leaf_kinds,
    leaves,
    rebuilt,
    type_of,
)
from model.compile.vector_code import VectorFunction

_INTRINSICS = """\
declare double @llvm.fabs.f64(double)
declare double @llvm.floor.f64(double)
declare double @llvm.sqrt.f64(double)
declare double @llvm.pow.f64(double, double)
declare i64 @llvm.abs.i64(i64, i1)
"""
_MOST_NESTED = 40  # kernels, each called by the one before

Key = tuple[Callable[..., Any], tuple[Type, ...]]
"""A kernel, and the types of its arguments."""


def name_of(key: Key, is_entry: bool, contract: bool) -> str | None:
    """Return the name of the function that a module defines: the same in every process.

    None if something outside of the package is part of it: a name cannot stand for its code.
    """
    try:
        return f"{_head(key, is_entry)}_{digest_of(key, contract)}"
    except OutsideError:
        return None


def _head(key: Key, is_entry: bool) -> str:
    return f"{_ascii(python_of(key[0]).__name__)}_{'entry' if is_entry else 'part'}"


def _ascii(name: str) -> str:
    return re.sub("[^A-Za-z0-9_]", "_", name)


class Module:
    """Text of kernels that become machine code together.

    Args:
        key: the kernel that is called from outside.
        parts: modules made so far, shared by all that are linked; None to write all kernels into
            this one, which is never ``CHECKED``.
        is_entry: True for a kernel that Python calls; see entries.py.
        contract: whether a product and a sum may become one operation.
        callers: keys of kernels that are being translated, since they call this one.

    Attributes:
        name: name of its function.
        lasting: True if the name is known before the kernel is translated.
        result: type of what the kernel returns.

    Raises:
        KernelError: a kernel is not in the subset.
    """

    is_vector = False

    def __init__(
        self,
        key: Key,
        parts: "dict[Key, Module] | None",
        *,
        is_entry: bool = False,
        contract: bool = True,
        callers: tuple[Key, ...] = (),
    ) -> None:
        self._key, self._parts, self._callers = key, parts, callers
        self._declared = Declarations(contract, checked=CHECKED and parts is not None)
        self._linked: dict[str, Module | VectorFunction] = {}
        self._texts: list[str] = []
        self._functions: dict[Key, tuple[str, Type]] = {}
        root = self._translated(key)
        self.result = root.result
        if is_entry and not _is_plain(self.result):
            found = f"{in_words(self.result)} is returned to Python"
            raise root.error(SubsetError(found, "return numbers and tuples"))
        name = name_of(key, is_entry, contract)
        self.name, self.lasting = name or self._name_of_text(key, root, is_entry), name is not None
        if is_entry:
            self._texts.append(root.text("whole", "internal"))
            self._texts.append(_entry(self.name, key[1], self.result))
        else:
            self._texts.append(root.text(self.name, ""))

    def is_as_named(self, contract: bool) -> bool:
        """Return whether its name still stands for what it is made of: nothing else does."""
        return not self.lasting or name_of(self._key, False, contract) == self.name

    def text(self) -> str:
        """Return the module in LLVM's language."""
        return "\n".join([_INTRINSICS, *self._declared.texts.values(), *self._texts])

    def _name_of_text(self, key: Key, root: Function, is_entry: bool) -> str:
        """Return a name that stands for the code, where its source is outside of the package."""
        text = "\n".join([self.text(), root.text("", "")])
        return f"{_head(key, is_entry)}_{hashlib.sha256(text.encode()).hexdigest()[:16]}"

    def linked(self) -> "Iterator[Module | VectorFunction]":
        """Yield all parts that it calls, directly or not, each once and before its callers; it."""
        seen: set[str] = set()

        def visit(module: "Module | VectorFunction") -> "Iterator[Module | VectorFunction]":
            if module.name not in seen:
                seen.add(module.name)
                if isinstance(module, Module):
                    for each in (*module._declared.vectors.values(), *module._linked.values()):
                        yield from visit(each)
                yield module

        return visit(self)

    def _call(self, code: Code, function: Any, arguments: list[Value]) -> Value:
        """Call a kernel with these arguments, in the order of its parameters."""
        key = function, tuple(map(type_of, arguments))
        marks = marks_of(function) or Marks()
        if key in self._callers or len(self._callers) == _MOST_NESTED:
            if any(function is caller for caller, _ in self._callers):
                raise SubsetError(f"{function.__name__} calls itself", "write a loop")
            raise SubsetError(
                f"{function.__name__} is called through {_MOST_NESTED} other kernels",
                "call fewer of them one from another",
            )
        if self._parts is not None and marks.separate:
            name, result = self._part(key, self._parts)
        else:
            if key not in self._functions:
                made = self._translated(key)
                name = f"f{len(self._functions)}_{_ascii(function.__name__)}"
                inlined = " alwaysinline" if marks.inlined else ""
                self._texts.append(made.text(name, "internal", inlined))
                self._functions[key] = name, made.result
            name, result = self._functions[key]
        return code.call(f"@{name}", result, arguments)

    def _part(self, key: Key, parts: "dict[Key, Module]") -> tuple[str, Type]:
        """Return name and result of a kernel that is a module of its own."""
        contract, part = self._declared.contract, parts.get(key)
        if part is None or (part.name not in self._linked and not part.is_as_named(contract)):
            part = parts[key] = Module(key, parts, contract=contract, callers=self._callers)
        self._linked[part.name] = part
        kinds = leaf_kinds(part.result)
        self._declared.function(part.name, leaf_kinds(*key[1]), aggregate(kinds))
        return part.name, part.result

    def _translated(self, key: Key) -> Function:
        outside, self._callers = self._callers, (*self._callers, key)
        made = Function(cast("Any", python_of(key[0])), key[1], self._declared, self._call)
        self._callers = outside
        return made


def _is_plain(result: Type) -> bool:
    """Return whether Python can take a result: numbers, tuples of them, or nothing."""
    if isinstance(result, Group):
        return all(_is_plain(each) for each in result.items)
    return isinstance(result, Number) or result == NOTHING


def _entry(name: str, types: tuple[Type, ...], result: Type) -> str:
    """Return the function that Python or a page calls; see entries.py."""
    code = Code(Declarations(contract=False))
    code.begin("begin")
    words = iter([_word(code, n, kind) for n, kind in enumerate(leaf_kinds(*types))])
    arguments = [rebuilt(each, words) for each in types]
    for n, leaf in enumerate(leaves(code.call("@whole", result, arguments))):
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
