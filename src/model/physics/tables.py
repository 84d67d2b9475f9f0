"""Dataclasses that are tables: every field carries an entry with its meaning."""

import inspect
from collections import namedtuple
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, field, fields
from typing import Any


def field_of(entry: Any, default: Any = MISSING) -> Any:
    """Return a dataclass field that carries an ``entry``."""
    return field(default=default, metadata={"entry": entry})


def entries(table: Any) -> dict[str, Any]:
    """Return the entries of a dataclass by the names of their fields."""
    return {f.name: f.metadata["entry"] for f in fields(table) if "entry" in f.metadata}


def described(docstring: str | None, table: Mapping[str, Any]) -> str:
    """Return ``docstring`` with a section of attributes: the ``explanation`` of each entry."""
    attributes = "".join(f"    {name}: {each.explanation}.\n" for name, each in table.items())
    return f"{inspect.cleandoc(docstring or '')}\n\nAttributes:\n{attributes}"


def numbers(name: str, fields: Sequence[str]) -> Any:
    """Make a named tuple class of numbers, whose fields a table gives, as the base of a class."""
    return namedtuple(name, fields)
