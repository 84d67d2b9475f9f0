"""Identity of kernels and of the objects for which they are compiled, as text for the cache.

A function of the package is identified by its place in it, since the name of the cache folder
stands for the contents of its files; a function outside, by the contents of its file too.
"""

import dataclasses
import enum
import hashlib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from model.compile.kernels import python_of
from model.compile.values import ArrayType, GroupType, StaticType

PACKAGE = Path(__file__).resolve().parents[1]
_DIGITS = 16


def digest_of(*objects: Any) -> str:
    """Return a digest of the identity of objects: 16 hexadecimal digits."""
    return hashlib.sha256(identity_of(objects).encode()).hexdigest()[:_DIGITS]


def identity_of(known: Any) -> str:
    """Return text that is the same for the same object in every process.

    Raises:
        TypeError: an object that is neither data nor a function.
    """
    if isinstance(known, StaticType):
        return f"static {identity_of(known.object)}"
    if known is None or isinstance(known, (bool, int, float, str, np.generic, range)):
        return repr(known)
    if isinstance(known, (ArrayType, GroupType, tuple, list)):
        return f"{type(known).__name__}({', '.join(map(identity_of, known))})"
    if isinstance(known, type):
        return f"{known.__module__}.{known.__qualname__}"
    if isinstance(known, enum.Enum):
        return f"{identity_of(type(known))}.{known.name}"
    if isinstance(known, np.ndarray):
        values = hashlib.sha256(np.ascontiguousarray(known).tobytes()).hexdigest()
        return f"array({known.dtype}, {known.shape}, {values})"
    if isinstance(known, (dict, frozenset, set)):
        items = known.items() if isinstance(known, dict) else known
        return f"{type(known).__name__}({', '.join(sorted(map(identity_of, items)))})"
    if hasattr(known, "identity"):
        return str(known.identity)
    return _lasting(known)


@cache
def _lasting(known: Any) -> str:
    """Return the identity of an object that lives as long as the process."""
    if dataclasses.is_dataclass(known):
        fields = (getattr(known, each.name) for each in dataclasses.fields(known))
        return f"{identity_of(type(known))}({', '.join(map(identity_of, fields))})"
    python = python_of(known)
    if hasattr(python, "__code__"):
        cells = [each.cell_contents for each in python.__closure__ or ()]
        inside = identity_of((cells, python.__defaults__))
        return f"{file_identity(python.__code__.co_filename)}:{python.__qualname__}{inside}"
    if callable(known) and hasattr(known, "__module__"):
        return f"{known.__module__}.{known.__name__}"  # of a library
    raise TypeError(f"{known!r}: a kernel is compiled for data and functions only")


def is_outside(file: str) -> bool:
    """Return whether a file is outside of the package."""
    return PACKAGE not in Path(file).resolve().parents


@cache
def file_identity(file: str) -> str:
    """Return the place of a file in the package, or a digest of its contents if it is outside."""
    path = Path(file).resolve()
    if is_outside(file):
        return hashlib.sha256(path.read_bytes()).hexdigest()[:_DIGITS]
    return path.relative_to(PACKAGE).as_posix()
