"""Source of kernels: their syntax trees, and errors that name a place in it."""

import ast
import inspect
import linecache
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from types import CodeType
from typing import Any, NamedTuple

from model.compile.values import SubsetError

_LONGEST_SHOWN = 60  # characters of a statement or an expression in an error
_REMEDIES = {
    "Assert": "test it where Python calls the kernel",
    "AsyncFor": "write a plain loop",
    "AsyncWith": "leave it to the caller",
    "Await": "leave it to the caller",
    "ClassDef": "define it outside of the kernel",
    "Delete": "leave the name as it is",
    "Dict": "write a tuple, or look up a table from outside",
    "DictComp": "write a tuple, or look up a table from outside",
    "FunctionDef": "define it outside of the kernel",
    "Global": "return the value",
    "Import": "import at the top of the file",
    "ImportFrom": "import at the top of the file",
    "JoinedStr": "leave text to the caller",
    "Lambda": "define a kernel outside",
    "List": "write a tuple",
    "ListComp": "write a tuple: tuple(... for ...)",
    "Match": "write if and elif",
    "NamedExpr": "assign before",
    "Nonlocal": "return the value",
    "Raise": "return a number that tells the caller",
    "Set": "write a tuple",
    "SetComp": "write a tuple: tuple(... for ...)",
    "Slice": "slice between the brackets of a tuple or an array",
    "Starred": "unpack into arguments or a tuple only",
    "Try": "test before",
    "TryStar": "test before",
    "With": "leave it to the caller",
    "Yield": "write into an array, or return a tuple",
    "YieldFrom": "write into an array, or return a tuple",
}


class KernelError(Exception):
    """A kernel holds what the compiler cannot translate.

    The message gives file and line, the kernel, the problem, and what to write instead.
    """


class Source(NamedTuple):
    """Source of a kernel.

    Attributes:
        tree: its syntax tree.
        local: names of its variables, without those of comprehensions.
        unchanging: variables that are assigned at one place only, which is translated once.
    """

    tree: ast.FunctionDef
    local: frozenset[str]
    unchanging: frozenset[str]


def refusal(node: ast.AST) -> SubsetError:
    """Return the error that a statement or an expression is not in the subset."""
    shown, kind = ast.unparse(node).partition("\n")[0], type(node).__name__
    what = f"`{shown}`" if len(shown) < _LONGEST_SHOWN else f"{kind} (a node of Python's syntax)"
    return SubsetError(f"{what} in a kernel", _REMEDIES.get(kind, "see docs/reference/kernels.md"))


@cache
def source_of(code: CodeType) -> Source:
    """Return the source of a function, by its code: closures of the same function share it.

    Raises:
        KernelError: it has none, or it is no function of a ``def`` statement.
    """
    file, no_function = code.co_filename, inspect.CO_GENERATOR | inspect.CO_COROUTINE
    linecache.checkcache(file)
    found = _functions_in(file, "".join(linecache.getlines(file))).get(code.co_firstlineno)
    if found is None or found.name != code.co_name or code.co_flags & no_function:
        raise KernelError(
            f"{file}:{code.co_firstlineno}: kernel {code.co_name!r} has no source that returns a "
            "value; define it by a def statement in a file, without yield and async"
        )
    names = Counter(_assigned(found))
    for each in ast.walk(found):
        if isinstance(each, (ast.Global, ast.Nonlocal)):
            error = refusal(each)
            where = f"{file}:{each.lineno}: in kernel {code.co_name!r}"
            raise KernelError(f"{where}: {error.problem}; {error.remedy}")
    arguments = [each.arg for each in ast.walk(found.args) if isinstance(each, ast.arg)]
    local = frozenset([*arguments, *names])
    for loop in ast.walk(found):
        if isinstance(loop, ast.For) and not is_counted(loop.iter):
            names.update(_assigned(loop))  # it is translated for each of its items
    names.update(arguments)
    return Source(found, local, frozenset(name for name in names if names[name] == 1))


@cache
def parameters_of(function: Callable[..., Any]) -> inspect.Signature:
    """Return the parameters of a function of Python."""
    return inspect.signature(function)


@cache
def _functions_in(file: str, text: str) -> dict[int, ast.FunctionDef]:
    """Return the functions that a file defines, by the line on which each begins."""
    functions = (
        each for each in ast.walk(ast.parse(text, file)) if isinstance(each, ast.FunctionDef)
    )
    return {
        min([each.lineno, *(d.lineno for d in each.decorator_list)]): each for each in functions
    }


def _assigned(tree: ast.AST) -> Iterator[str]:
    """Yield the names that are assigned in a function, once for each place."""
    if isinstance(tree, ast.comprehension):
        return
    if isinstance(tree, ast.Name) and isinstance(tree.ctx, ast.Store):
        yield tree.id
    for each in ast.iter_child_nodes(tree):
        yield from _assigned(each)


def is_counted(over: ast.expr) -> bool:
    """Return whether a for statement over this expression counts at run time."""
    called = over.func if isinstance(over, ast.Call) else None
    return isinstance(called, ast.Name) and called.id in ("range", "each_lane")
