"""Kernels that read a named tuple from an array or write it there, generated from its fields.

Runs are rows of numbers, in which a named tuple takes consecutive columns. numba cannot loop over
the fields of a tuple, so the statement that names them all is generated: whoever adds a field to a
tuple has nothing to edit where it is stored.
"""

import collections
from collections.abc import Callable, Sequence
from typing import Any

from model.compile.jit import inlined_kernel
from model.compile.source import defined

_FROM_NUMBER = {int: "int({})", bool: "({} != 0.0)"}


def numbers(name: str, fields: Sequence[str]) -> Any:
    """Make a named tuple class of floats, as the base of a class with a docstring."""
    return collections.namedtuple(name, fields)


def reader(tuple_class: Any, arguments: str, place: Callable[[int], str], **names: Any) -> Any:
    """Make the inlined kernel (``arguments``) that reads a named tuple.

    Args:
        tuple_class: class of the tuple; fields annotated as int or bool are converted from floats.
        arguments: names of the kernel's arguments, as "runs, i".
        place: expression of field n, as "runs[i, 3]" for n = 3.
        **names: other names in these expressions.
    """
    types = tuple_class.__annotations__
    values = [
        _FROM_NUMBER.get(types.get(field), "{}").format(place(n))
        for n, field in enumerate(tuple_class._fields)
    ]
    name = _name("read", tuple_class)
    code = f"def {name}({arguments}):\n    return made({', '.join(values)})\n"
    return inlined_kernel(defined(name, code, {"made": tuple_class, **names}))


def writer(tuple_class: Any, arguments: str, place: Callable[[int], str], **names: Any) -> Any:
    """Make the inlined kernel (``value``, ``arguments``) that writes a tuple, as ``reader``."""
    name = _name("write", tuple_class)
    lines = [f"    {place(n)} = value.{field}" for n, field in enumerate(tuple_class._fields)]
    code = "\n".join([f"def {name}(value, {arguments}):", *lines, ""])
    return inlined_kernel(defined(name, code, names))


def _name(verb: str, tuple_class: Any) -> str:
    return f"{verb}_{tuple_class.__name__.strip('_').lower()}"
