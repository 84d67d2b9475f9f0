"""Source of kernels: their syntax trees, and errors that name a place in it."""

import ast
import inspect
import linecache
from collections import Counter
from collections.abc import Callable
from functools import cache
from types import CodeType
from typing import Any, NamedTuple


class KernelError(Exception):
    """A kernel holds what the compiler cannot translate.

    The message gives file and line, the kernel, the problem, and what to write instead.
    """


class Source(NamedTuple):
    """Source of a kernel: its syntax tree, and the names that are assigned at one place only."""

    tree: ast.FunctionDef
    unchanging: frozenset[str]


@cache
def source_of(code: CodeType) -> Source:
    """Return the source of a function, by its code: closures of the same function share it.

    Raises:
        KernelError: it has none, or it is no function of a ``def`` statement.
    """
    tree = _functions_in(code.co_filename).get(code.co_firstlineno)
    if tree is None or tree.name != code.co_name:
        raise KernelError(
            f"{code.co_filename}:{code.co_firstlineno}: kernel {code.co_name!r} has no source; "
            "define it by a def statement in a file"
        )
    return Source(tree, _assigned_once(tree))


@cache
def parameters_of(function: Callable[..., Any]) -> inspect.Signature:
    """Return the parameters of a function of Python."""
    return inspect.signature(function)


@cache
def _functions_in(file: str) -> dict[int, ast.FunctionDef]:
    """Return the functions that a file defines, by the line on which each begins."""
    tree = ast.parse("".join(linecache.getlines(file)), file)
    functions = (each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef))
    return {
        min([each.lineno, *(d.lineno for d in each.decorator_list)]): each for each in functions
    }


def _assigned_once(tree: ast.FunctionDef) -> frozenset[str]:
    """Return the names that are assigned at one place, which is translated once.

    The body of a loop over items is translated for each of them.
    """
    counts = Counter(each.arg for each in ast.walk(tree.args) if isinstance(each, ast.arg))
    counts.update(_assigned(tree))
    for loop in ast.walk(tree):
        is_repeated = isinstance(loop, ast.For) and not _is_counted(loop.iter)
        if is_repeated or isinstance(loop, ast.comprehension):
            counts.update(_assigned(loop))
    return frozenset(name for name, count in counts.items() if count == 1)


def _assigned(tree: ast.AST) -> list[str]:
    return [
        each.id
        for each in ast.walk(tree)
        if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)
    ]


def _is_counted(over: ast.expr) -> bool:
    """Return whether a for statement over this expression counts at run time."""
    called = over.func if isinstance(over, ast.Call) else None
    return isinstance(called, ast.Name) and called.id in ("range", "each_lane")
