"""Checks of claims: which rows of which tables a number is computed from, and how.

A check computes a number for each part of its claim: each figure, each curve.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from model.physics.parameters import FIELDS
from study.claims.data import MissingDataError, Rows, Tables
from study.claims.measures import MEASURES
from study.claims.statistics import NAN

Parts = Mapping[str, float]


def _largest(parts: Parts) -> Parts:
    """Return the largest of the known numbers, by a name that says of which part it is."""
    known = {name: value for name, value in parts.items() if not math.isnan(value)}
    best = max(known, key=known.__getitem__, default="")
    return {f"at most, for {best}": known[best]} if known else {"": NAN}


def _one_way(parts: Parts) -> Parts:
    """Return the least of the numbers, or of their negatives if that is more; NaN if any is."""
    numbers = [*parts.values()]
    return {"": NAN if any(map(math.isnan, numbers)) else max(min(numbers), -max(numbers))}


_COMBINED: Mapping[str, Callable[[Parts], Parts]] = {
    "": lambda parts: parts,
    "largest": _largest,
    "one way": _one_way,
}


@dataclass(frozen=True)
class Check:
    """The numbers of a claim, computed from the tables of its figures.

    Attributes:
        number: function of ``measures``.
        arguments: of the function: numbers, or expressions of columns as texts. Rows that meet the
            one named ``beside`` are added to each part.
        where: query of pandas for the rows of which the claim speaks; "" for all.
        each: column by whose values these rows are divided into parts.
        among: query for the rows of a part that count. A part may have none.
        parts: arguments that differ between further parts of the claim, by the part's name.
        together: True if its figures are compared: they are read as one table, with the place of a
            figure among them in the column ``figure``. Otherwise each that has a dataset is a part.
        combine: "largest" of the numbers of all parts, or "one way", the least if all have one
            sign; else "", where each part must meet the limit.
    """

    number: Callable[..., float]
    arguments: Mapping[str, Any] = field(default_factory=dict)
    where: str = ""
    each: str = ""
    among: str = ""
    parts: Mapping[str, Mapping[str, Any]] = field(default_factory=lambda: {"": {}})
    together: bool = False
    combine: str = ""

    def numbers(self, tables: Tables, figures: Sequence[str]) -> Parts:
        """Return the number of each part of the claim by its name, "" for the whole.

        NaN where the data lack what the paper describes, such as the duration of a part that never
        aligns; this counts against the claim.

        Raises:
            MissingDataError: a dataset, a column or rows that the claim needs are missing.
        """
        found = {}
        for figure, names in self._sources(tables, figures).items():
            for value, rows in tables.rows(names, self.where, self.each).items():
                of_curve = f"{_symbol(self.each)} = {value:g}" if self.each else ""
                for words, changes in self.parts.items():
                    part = ", ".join(filter(None, (figure, of_curve, words)))
                    found[part] = self._number(tables, names, rows, {**self.arguments, **changes})
        return _COMBINED[self.combine](found)

    def _sources(self, tables: Tables, figures: Sequence[str]) -> dict[str, tuple[str, ...]]:
        """Return the names of the tables that are read as one, by the name of the part."""
        if self.together or len(figures) == 1:
            return {"": tuple(figures)}
        if not any(name in tables.frames for name in figures):
            raise MissingDataError(f"there is no dataset of {', '.join(figures)}")
        return {_words(name): (name,) for name in figures if name in tables.frames}

    def _number(
        self, tables: Tables, names: tuple[str, ...], rows: Rows, arguments: Mapping[str, Any]
    ) -> float:
        if "beside" in arguments:
            (others,) = tables.rows(names, arguments["beside"]).values()
            rows = np.concatenate([rows, others])
        if self.among:
            rows = rows[tables.column(names, self.among)[rows]]
        return self.number(**{
            name: tables.column(names, value)[rows] if isinstance(value, str) else value
            for name, value in arguments.items()
        })  # fmt: skip


def _words(name: str) -> str:
    """Return "Fig. 6" for "fig06", and "by frequency" for the run "by_frequency"."""
    return f"Fig. {int(name[3:])}" if name.startswith("fig") else name.replace("_", " ")


def _symbol(column: str) -> str:
    return FIELDS[column].symbol if column in FIELDS else column


def check_of(stated: Mapping[str, Any]) -> Check:
    """Return the check that is stated as the attributes of ``Check`` and the arguments.

    Raises:
        KeyError: there is no number.
        TypeError: the function does not take the arguments.
        ValueError: there is no function, or no way to combine numbers, of a name.
    """
    own = {each.name for each in fields(Check)} - {"number", "arguments"}
    chosen = {name: value for name, value in stated.items() if name in own}
    for key, known in {"number": MEASURES, "combine": _COMBINED}.items():
        if stated.get(key, "") not in known:
            raise ValueError(
                f"{key} = {stated[key]!r}: must be one of {', '.join(filter(None, known))}"
            )
    arguments = {name: value for name, value in stated.items() if name not in {*own, "number"}}
    check = Check(MEASURES[stated["number"]], arguments, **chosen)
    for changes in check.parts.values():
        inspect.signature(check.number).bind(**{**arguments, **changes})
    return check
