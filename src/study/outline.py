"""Source code without what changes nothing that runs: comments, layout, docstrings."""

import ast
from typing import Any

_WITH_DOCSTRING = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def outline(node: Any, imported: list[str]) -> list[Any]:
    """Return a syntax tree as nested lists of fields, without docstrings and line numbers.

    Names that may be imported modules are added to ``imported``. Imports for type checkers only
    are left out.
    """
    kind = node.__class__
    fields: list[Any] = [kind.__name__]
    typing_only = kind is ast.If and getattr(node.test, "id", None) == "TYPE_CHECKING"
    for name in kind._fields:
        value = getattr(node, name, None)
        seen = [] if typing_only and name == "body" else imported
        if value.__class__ is list:
            if name == "body" and kind in _WITH_DOCSTRING and ast.get_docstring(node, clean=False):
                value = value[1:]
            value = [outline(v, seen) if isinstance(v, ast.AST) else v for v in value]
        elif isinstance(value, ast.AST):
            value = outline(value, seen)
        if value not in (None, []):  # as later versions of Python have more fields
            fields.append((name, value))
    if kind is ast.Import:
        imported += [alias.name for alias in node.names]
    elif kind is ast.ImportFrom and node.module and node.level == 0:
        imported += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return fields
