"""Entries of the table of parameters: symbol, meaning, quantity and rule of each."""

import math
from dataclasses import MISSING, dataclass
from typing import Any, Literal, TypeVar, dataclass_transform

from model.physics.quantities import Quantity
from model.physics.tables import field_of

Bound = Literal["", "> 0", ">= 0"]
Table = TypeVar("Table")


@dataclass(frozen=True)
class Field:
    """Entry of one parameter.

    Attributes:
        symbol: symbol in the paper.
        description: meaning in a few words.
        quantity: physical quantity, for devices in SI units.
        bound: admissible range; any finite number where empty.
        derived: parameter whose value replaces ``None``; without one, ``None`` is refused.
        measured: True if a device in SI units must state the parameter although it has a default.
        optional: True if the parameter may be None, which leaves out what it describes.
    """

    symbol: str
    description: str
    quantity: Quantity
    bound: Bound = ""
    derived: str | None = None
    measured: bool = False
    optional: bool = False

    @property
    def rule(self) -> str:
        """The admissible range in words."""
        rule = f"must be a finite number {self.bound}".strip()
        if self.optional:
            return f"{rule}, or None"
        return f"{rule}, or None for {self.derived}" if self.derived else rule

    @property
    def explanation(self) -> str:
        """Meaning and symbol, in a line."""
        return f"{self.description}, {self.symbol}"

    def admits(self, values: Any) -> Any:
        """Return whether ``values``, a float or an array, obey the rule; NaN stands for None."""
        inside = abs(values) < math.inf
        if self.bound:
            inside = inside & (values > 0.0 if self.bound == "> 0" else values >= 0.0)
        may_be_none = self.derived or self.optional
        return inside | (values != values) if may_be_none else inside  # noqa: PLR0124 - NaN


def entry(
    symbol: str,
    description: str,
    quantity: Quantity,
    bound: Bound = "",
    *,
    default: Any = MISSING,
    **rest: Any,
) -> Any:
    """Return a field of ``Parameters``, with a ``Field`` of these arguments and a default."""
    return field_of(Field(symbol, description, quantity, bound, **rest), default)


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(entry,))
def parameter_table(table: type[Table]) -> type[Table]:
    """Make a frozen class of values whose fields are entries."""
    return dataclass(frozen=True, kw_only=True, eq=False, repr=False)(table)
