"""Dataclasses: tables, whose fields carry entries with their meanings, and public values."""

import html
import inspect
from collections import namedtuple
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import MISSING, field, fields
from enum import Enum
from typing import Any

import numpy as np


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


class Value:
    """Base of public dataclasses, made with ``eq=False`` and ``repr=False``.

    They are equal, and have equal hashes, if their fields hold the same, NaN and arrays included,
    but for fields made with ``compare=False``.
    They print in a line, without fields that have their defaults, and as a table in notebooks.
    """

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and _content(self) == _content(other)

    def __hash__(self) -> int:
        return hash(_content(self))

    def __repr__(self) -> str:
        given = (
            f"{f.name}={value!r}"
            for f, value in zip(fields(self), vars_of(self).values(), strict=True)  # type: ignore[arg-type]
            if f.repr and _content(value) not in (f.default, _made(f.default_factory))
        )
        return f"{type(self).__name__}({', '.join(given)})"

    def _shown(self) -> dict[str, Any]:
        """Return the rows of the table by name."""
        return vars_of(self)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{name}</th><td>{html.escape(_words(value))}</td></tr>"
            for name, value in self._shown().items()
        )
        return f"<table><caption>{html.escape(repr(self))}</caption>{rows}</table>"


def vars_of(value: Any) -> dict[str, Any]:
    """Return the fields of a dataclass by name, without what it has computed besides."""
    return {f.name: getattr(value, f.name) for f in fields(value)}


def _made(factory: Any) -> Any:
    return MISSING if factory is MISSING else _content(factory())


def _content(value: Any) -> Hashable:
    """Return what is equal for equal values; -0.0 and 0.0 are equal, and all NaN."""
    if isinstance(value, np.ndarray):
        plain = np.where(np.isnan(value), np.nan, value + 0.0) if value.dtype.kind == "f" else value
        return value.dtype.str, value.shape, plain.tobytes()
    if isinstance(value, Value):
        compared = {f.name: getattr(value, f.name) for f in fields(value) if f.compare}  # type: ignore[arg-type]
        return type(value), _content(compared)
    if isinstance(value, Mapping):
        return frozenset((name, _content(each)) for name, each in value.items())
    if isinstance(value, (list, tuple)):
        return tuple(map(_content, value))
    return "NaN" if isinstance(value, float) and value != value else value  # noqa: PLR0124


def _words(value: Any) -> str:
    """Return a value in some words: an array as its shape and the range of its values."""
    if isinstance(value, np.ndarray):
        known = value[np.isfinite(value)]
        span = f"{known.min():.6g} to {known.max():.6g}" if known.size else "no number"
        return f"{span}, shape {value.shape}"
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {_words(each)}" for name, each in value.items()) or "none"
    if isinstance(value, (tuple, list)):
        return ", ".join(map(_words, value)) or "none"
    if isinstance(value, Enum):
        return value.name.lower()
    return f"{value:.7g}" if isinstance(value, float) else str(value)
