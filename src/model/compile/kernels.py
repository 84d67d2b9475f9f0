"""Kernels: functions in the subset of Python that the compiler translates to machine code.

Called from Python, a kernel is the Python function that it looks like: for tests, for a debugger,
and for symbols (``Symbol``). Machine code is made of it where ``compiled`` (entries.py) is asked
for, with all kernels that it calls. docs/reference/kernels.md says what a kernel may contain.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Marks:
    """Marks that a decorator sets on a kernel.

    Attributes:
        inlined: it becomes part of the code of its callers.
        separate: it has machine code of its own, compiled once for all that call it.
        python: the function whose source it is, if it is a wrapper.
    """

    inlined: bool = False
    separate: bool = False
    python: Callable[..., Any] | None = None


def kernel(function: Function, marks: Marks = Marks()) -> Function:
    """Mark a function as a kernel, which other kernels call.

    Arithmetic is IEEE, but a product and a sum may become one operation (fused multiply-add).
    """
    function.__kernel__ = marks  # type: ignore[attr-defined]
    return function


def inlined_kernel(function: Function) -> Function:
    """Mark a kernel that becomes part of its callers: a call would copy some forty numbers."""
    return kernel(function, Marks(inlined=True))


def separate_kernel(function: Function) -> Function:
    """Mark a kernel with machine code of its own: all scenes share it."""
    return kernel(function, Marks(separate=True))


class Symbol:
    """Operand that stands for a number where a kernel is traced instead of computed."""

    def rule_of(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return what is called in place of an ``operation``, here given as Python's function."""
        return function


def _first_symbol(value: Any) -> Symbol | None:
    if isinstance(value, tuple):
        return next((found for each in value if (found := _first_symbol(each))), None)
    return value if isinstance(value, Symbol) else None


def operation(function: Function) -> Function:
    """Mark an inlined kernel that a ``Symbol`` among its arguments may replace by its own rule."""

    @functools.wraps(function)
    def called(*arguments: Any) -> Any:
        symbol = _first_symbol(arguments)
        return (function if symbol is None else symbol.rule_of(function))(*arguments)

    return kernel(called, Marks(inlined=True, python=function))  # type: ignore[return-value]


def marks_of(function: Any) -> Marks | None:
    """Return what a decorator says of a kernel; None for any other object."""
    marks = getattr(function, "__kernel__", None)
    return marks if isinstance(marks, Marks) else None


def python_of(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function whose source a kernel is, without the wrapper of an ``operation``."""
    marks = marks_of(function)
    return function if marks is None or marks.python is None else marks.python
