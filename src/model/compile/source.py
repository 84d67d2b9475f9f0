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
    same = [
        found
        for written, found in _functions_in(file, "".join(linecache.getlines(file)))
        if found.name == code.co_name and _does_the_same(written, code)
    ]
    if code.co_flags & no_function or not same:
        raise KernelError(
            f"{file}:{code.co_firstlineno}: kernel {code.co_name!r} has no source that returns a "
            "value; define it by a def statement in a file, without yield and async. If the file "
            "was edited since it was imported, start Python again"
        )
    found = same[0]
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
def _functions_in(file: str, text: str) -> list[tuple[CodeType, ast.FunctionDef]]:
    """Return the functions that a file defines, with their code."""
    tree = ast.parse(text, file)
    trees = {
        (each.name, min([each.lineno, *(d.lineno for d in each.decorator_list)])): each
        for each in ast.walk(tree) if isinstance(each, ast.FunctionDef)
    }  # fmt: skip
    codes = _codes_in(compile(tree, file, "exec", dont_inherit=True))
    places = ((each, (each.co_name, each.co_firstlineno)) for each in codes)
    return [(code, trees[place]) for code, place in places if place in trees]


def _codes_in(code: CodeType) -> Iterator[CodeType]:
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield each
            yield from _codes_in(each)


def _without_docstring(code: CodeType) -> tuple[Any, ...]:
    first, *others = code.co_consts or (None,)
    return (None if isinstance(first, str) else first, *others)


def _does_the_same(one: CodeType, other: CodeType) -> bool:
    """Return whether two functions are the same but for their lines and docstrings."""
    if (one.co_code, one.co_names, one.co_varnames, one.co_freevars) != (
        other.co_code, other.co_names, other.co_varnames, other.co_freevars
    ):  # fmt: skip
        return False
    return _are_same(_without_docstring(one), _without_docstring(other))


def _are_same(some: tuple[Any, ...], others: tuple[Any, ...]) -> bool:
    """Return whether two lists of constants are the same, functions in functions too."""
    return len(some) == len(others) and all(
        _are_same((a.co_code, *a.co_consts), (b.co_code, *b.co_consts))
        if isinstance(a, CodeType) and isinstance(b, CodeType)
        else repr(a) == repr(b)
        for a, b in zip(some, others, strict=True)
    )


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
