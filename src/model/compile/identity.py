"""Identity of kernels and of the objects for which they are compiled, as text for the cache.

A function of the package is identified by its name and its instructions, since the name of the
cache folder stands for the contents of its files. Nothing stands for those of other files.
"""

import dataclasses
import hashlib
from pathlib import Path
from types import CodeType, FunctionType, MethodType
from typing import Any

import numpy as np

from model.compile.kernels import python_of
from model.compile.values import Static

PACKAGE = Path(__file__).resolve().parents[1]
_KNOWN = (__name__.partition(".")[0], "builtins", "math", "numpy")  # packages
_DIGITS = 16
_LASTING: dict[int, tuple[Any, str]] = {}  # objects that live as long as the process, by id


class OutsideError(TypeError):
    """An object is from outside of the package: its name does not stand for its contents."""


def digest_of(*objects: Any) -> str:
    """Return a digest of the identity of objects: 16 hexadecimal digits."""
    return hashlib.sha256(identity_of(objects).encode()).hexdigest()[:_DIGITS]


def identity_of(known: Any) -> str:
    """Return text that is the same for the same object in every process.

    Raises:
        OutsideError: an object that is neither data nor a function or class of the package.
    """
    if known is None or isinstance(known, (bool, int, float, str, np.generic, range)):
        return repr(known)
    if isinstance(known, (tuple, list)):
        return f"{identity_of(type(known))}({', '.join(map(identity_of, known))})"
    if isinstance(known, type):
        return _place(known)
    if isinstance(known, dict):
        return f"dict({', '.join(sorted(map(identity_of, known.items())))})"
    if hasattr(known, "identity"):
        return str(known.identity)
    if id(known) not in _LASTING:
        _LASTING[id(known)] = known, getattr(known, "__qualname__", "")  # where it holds itself
        try:
            _LASTING[id(known)] = known, _lasting(known)
        except OutsideError:
            del _LASTING[id(known)]
            raise
    return _LASTING[id(known)][1]


def is_inside(known: Any) -> bool:
    """Return whether a class or a function is one of the package, or of a library of it."""
    return str(getattr(known, "__module__", "")).partition(".")[0] in _KNOWN


def _place(known: Any) -> str:
    """Return the place of a class or a function in the package."""
    if not (is_inside(known) and hasattr(known, "__qualname__")) or isinstance(known, MethodType):
        raise OutsideError(f"{known!r}: neither data nor a function or class of the package")
    return f"{known.__module__}.{known.__qualname__}"


def _lasting(known: Any) -> str:
    """Return the identity of an object that lives as long as the process."""
    if isinstance(known, Static):
        return f"static {identity_of(known.object)}"
    if dataclasses.is_dataclass(known):
        fields = (getattr(known, each.name) for each in dataclasses.fields(known))
        return f"{identity_of(type(known))}({', '.join(map(identity_of, fields))})"
    python = python_of(known)
    place = _place(python)
    if not isinstance(python, FunctionType):
        return place  # of a library
    held = [getattr(each, "cell_contents", "nothing yet") for each in python.__closure__ or ()]
    outside = identity_of((held, python.__defaults__, python.__kwdefaults__))
    return f"{place} {_instructions(python.__code__, python.__doc__)} {outside}"


def _instructions(code: CodeType, docstring: str | None = None) -> str:
    """Return a digest of what a function does, since another may have its name: a lambda."""
    held = (
        _instructions(each) if isinstance(each, CodeType)
        else str(sorted(map(repr, each))) if isinstance(each, frozenset)
        else repr(each)
        for each in code.co_consts if docstring is None or each != docstring
    )  # fmt: skip
    names = code.co_names, code.co_varnames, code.co_freevars
    text = " ".join([code.co_code.hex(), str(names), *held])
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]
