"""Kernels that read named tuples from arrays and write them there, made from the tuples' fields.

Runs are rows of numbers, in which a named tuple takes consecutive places. numba cannot loop over
the fields of a tuple: the one statement that names all of them is written here, from the fields
themselves, so that a field that is added to a tuple needs no edit where the tuple is stored.
"""

import collections
from collections.abc import Callable, Sequence
from typing import Any

from model.compile.jit import inlined_kernel
from model.compile.source import defined

_FROM_NUMBER = {int: "int({})", bool: "({} != 0.0)"}


def numbers(name: str, fields: Sequence[str]) -> Any:
    """Make a named tuple class of floats, to be the base of a class with a docstring."""
    return collections.namedtuple(name, fields)


def reader(kind: Any, arguments: str, place: Callable[[int], str], **names: Any) -> Any:
    """Make the inlined kernel (``arguments``) that reads a ``kind``.

    Args:
        kind: a named tuple class; fields annotated as int or bool are converted from floats.
        arguments: names of the kernel's arguments, as "runs, i".
        place: expression of field n, as "runs[i, 3]" for n = 3.
        **names: other names in these expressions.
    """
    types = kind.__annotations__
    values = [
        _FROM_NUMBER.get(types.get(field), "{}").format(place(n))
        for n, field in enumerate(kind._fields)
    ]
    lines = [f"return kind({', '.join(values)})"]
    return _made("read", kind, arguments, lines, {"kind": kind, **names})


def writer(kind: Any, arguments: str, place: Callable[[int], str], **names: Any) -> Any:
    """Make the inlined kernel (``value``, ``arguments``) that writes a ``kind``, as ``reader``."""
    lines = [f"{place(n)} = value.{field}" for n, field in enumerate(kind._fields)]
    return _made("write", kind, f"value, {arguments}", lines, names)


def _made(does: str, kind: Any, arguments: str, lines: list[str], names: dict[str, Any]) -> Any:
    name = f"{does}_{kind.__name__.strip('_').lower()}"
    code = "\n    ".join([f"def {name}({arguments}):", *lines])
    return inlined_kernel(defined(name, f"{code}\n", names))
