"""Identity of kernels and of the objects for which they are compiled, as text for the cache.

A function of the package is identified by its instructions and by what its names stand for now, in
this process: numbers and tables by their values, functions and classes in the same way again. What
a file says, or said when it was imported, does not matter. The compiler and libraries are known by
name, since the name of the cache folder stands for their contents. Nothing stands for other code.
"""

import dataclasses
import functools
import hashlib
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

import numpy as np

from model.compile.values import Static

PACKAGE = Path(__file__).resolve().parents[1]
_COMPILER, _, _ = __name__.rpartition(".")
_PACKAGE, _, _ = _COMPILER.partition(".")
_LIBRARIES = {"numpy", *sys.stdlib_module_names}
_WALKED = f"{_COMPILER}.webassembly"  # imported later than the compiler, perhaps after an edit
_DIGITS = 16
_DATA = (bool, int, float, complex, str, bytes, range, np.generic, type(None), type(...))
_CHANGEABLE = (np.ndarray, list, dict, set)
_MADE_BY_PYTHON = "<"  # what the file of a generated method begins with


class OutsideError(TypeError):
    """An object is from outside of the package: its name does not stand for its contents."""


class _Part(NamedTuple):
    """A function, a class or a frozen object that others refer to.

    Attributes:
        known: it.
        text: its identity, in which further parts are named.
        parts: these.
        uses: (names, name, value): it is described again where a name stands for another object,
            or for one that can change.
    """

    known: Any
    text: str
    parts: list[Any]
    uses: list[tuple[Mapping[str, Any], str, Any]]

    def is_as_described(self) -> bool:
        return all(
            names.get(name) is value and not isinstance(value, _CHANGEABLE)
            for names, name, value in self.uses
        )


_PARTS: dict[int, _Part] = {}  # by id; they live as long as the process
_DESCRIBED: set[int] = set()  # ids of what is being described: where it holds itself


def digest_of(*objects: Any) -> str:
    """Return a digest of objects and of all that they refer to: 16 hexadecimal digits.

    Raises:
        OutsideError: one is neither data nor a function, a class or an object of the package.
    """
    waiting: list[Any] = []
    found, seen = {_told(objects, waiting)}, set[int]()
    while waiting:
        known = waiting.pop()
        if id(known) not in seen:
            seen.add(id(known))
            part = _described(known)
            found.add(part.text)
            waiting += part.parts
    return _hash("\n".join(sorted(found)))


def is_inside(known: Any) -> bool:
    """Return whether a class or a function is one of the package, or of a library of it."""
    return _standing(getattr(known, "__module__", None))[0]


def _is_walked(known: Any) -> bool:
    """Return whether its name does not stand for a function or a class of the package."""
    return _standing(getattr(known, "__module__", None))[1]


@functools.cache
def _standing(module: str | None) -> tuple[bool, bool]:
    """Return whether a module ``is_inside``, and whether what it defines ``_is_walked``."""
    package = str(module).partition(".")[0]
    in_compiler = f"{module}.".startswith(f"{_COMPILER}.") and module != _WALKED
    return package in (_PACKAGE, *_LIBRARIES), package == _PACKAGE and not in_compiler


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def _told(known: Any, parts: list[Any]) -> str:
    """Return text that is the same for the same object in every process; add to its ``parts``."""
    if isinstance(known, _DATA):
        return repr(known)
    if id(known) in _DESCRIBED:
        return "itself"
    _DESCRIBED.add(id(known))
    try:
        return _told_object(known, parts)
    finally:
        _DESCRIBED.remove(id(known))


def _told_object(known: Any, parts: list[Any]) -> str:
    if isinstance(known, (tuple, list)):
        return f"{_told(type(known), parts)}({', '.join(_told(each, parts) for each in known)})"
    if isinstance(known, (dict, set, frozenset)):
        items = known.items() if isinstance(known, dict) else known
        return f"{type(known).__name__}({sorted(_told(each, parts) for each in items)})"
    if isinstance(known, np.ndarray):
        return f"array {known.dtype} {known.shape} {_hash(known.tobytes().hex())}"
    if isinstance(known, Static):
        return f"static {_told(known.object, parts)}"
    if isinstance(known, ModuleType):
        return f"module {known.__name__}"
    if isinstance(known, type):
        return _place(known, parts)
    known = _function_in(known) or known
    if isinstance(known, FunctionType) and _is_walked(known):
        held = [getattr(each, "cell_contents", "nothing yet") for each in known.__closure__ or ()]
        outside = _told((held, known.__defaults__, known.__kwdefaults__), parts)
        return f"{_place(known, parts)} {_code_of(known).digest} {outside}"
    if isinstance(known, np.ufunc):
        return f"numpy.{known.__name__}"
    if callable(known) and hasattr(known, "__self__"):  # a method, or a function written in C
        return f"{_told(known.__self__, parts)}.{known.__qualname__}"
    if callable(known) and hasattr(known, "__qualname__"):
        return _place(known, parts)
    return _told_instance(known, parts)


def _told_instance(known: Any, parts: list[Any]) -> str:
    if hasattr(known, "identity"):
        return _told((type(known), known.identity), parts)
    if not _is_walked(type(known)):
        text = f"{_place(type(known), parts)} {repr(known).partition(' at 0x')[0]}"
        if " at 0x" in repr(known) and getattr(known, "__dict__", None):
            raise OutsideError(f"{known!r}: neither data nor a function or class of the package")
        return text
    if dataclasses.is_dataclass(known) and _is_frozen(type(known)):
        part = _described(known)
        parts += part.parts
        return part.text
    return f"{_place(type(known), parts)} {_told(vars(known), parts)}"


def _is_frozen(made_by: Any) -> bool:
    return bool(made_by.__dataclass_params__.frozen)


def _place(known: Any, parts: list[Any]) -> str:
    """Return the place of a class or a function; it is a part if that does not identify it."""
    if not is_inside(known):
        raise OutsideError(f"{known!r}: neither data nor a function or class of the package")
    if _is_walked(known):
        parts.append(known)
    return f"{known.__module__}.{known.__qualname__}"


def _described(known: Any) -> _Part:
    """Return a part as it is now."""
    kept = _PARTS.get(id(known))
    if kept is None or not kept.is_as_described():
        kept = _PARTS[id(known)] = _new_part(known)
    return kept


def _new_part(known: Any) -> _Part:
    parts: list[Any] = []
    if isinstance(known, FunctionType):
        uses, head = [*_names_in(known)], _told(known, parts)
    elif isinstance(known, type):
        uses, head = [*_members_of(known)], _told((known.__qualname__, known.__mro__[1:]), parts)
    else:  # frozen
        values = {each.name: getattr(known, each.name) for each in dataclasses.fields(known)}
        return _Part(known, _hash(_told((type(known), values), parts)), parts, [])
    told = (f"{name} = {_told(value, parts)}" for _, name, value in uses)
    return _Part(known, "\n  ".join([head, *told]), parts, uses)


def _names_in(function: FunctionType) -> Iterator[tuple[Mapping[str, Any], str, Any]]:
    """Yield the names of a function that stand for something outside of it."""
    known, names = function.__globals__, _code_of(function).names
    for name in names:
        if name in known:
            value = known[name]
            yield known, name, value
            if isinstance(value, ModuleType) and _standing(value.__name__)[1]:
                yield from ((vars(value), n, vars(value)[n]) for n in names if n in vars(value))


def _members_of(known: type) -> Iterator[tuple[Mapping[str, Any], str, Any]]:
    """Yield what a class defines: functions, properties and data; not what Python adds to it."""
    for name, value in sorted(vars(known).items()):
        function = _function_in(value)
        is_data = isinstance(value, (*_DATA, tuple, dict)) and not name.startswith("__")
        if is_data or (function and function.__code__.co_filename[0] != _MADE_BY_PYTHON):
            yield vars(known), name, value


def _function_in(known: Any) -> FunctionType | None:
    """Return the function that a decorator, a property or a method wraps, or that it is."""
    for name in ("__wrapped__", "fget", "func", "__func__"):
        known = getattr(known, name, known)
    return known if isinstance(known, FunctionType) else None


# --- Code -----------------------------------------------------------------------------------------


class _Code(NamedTuple):
    """Digest of what a function does, and the names in it, those of functions in it too."""

    digest: str
    names: tuple[str, ...]


def _code_of(function: FunctionType) -> _Code:
    return _read(function.__code__, function.__doc__)


@functools.cache
def _read(code: CodeType, docstring: str | None = None) -> _Code:
    names, held = dict.fromkeys(code.co_names), []
    for each in code.co_consts:
        if isinstance(each, CodeType):
            inner = _read(each)
            names |= dict.fromkeys(inner.names)
            held.append(inner.digest)
        elif docstring is None or each != docstring:
            held.append(str(sorted(map(repr, each))) if isinstance(each, frozenset) else repr(each))
    own = code.co_names, code.co_varnames, code.co_freevars
    return _Code(_hash(" ".join([code.co_code.hex(), str(own), *held])), tuple(names))
