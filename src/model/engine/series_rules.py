"""Taylor series by the rules by which their coefficients follow from others.

series.py makes them of the equations of motion; series_layout.py and series_code.py write them as
code. Tuples with equal members are equal: ``rule`` tells series of two rules apart.
"""

from typing import Any, NamedTuple

# Constant during a step: a number, ("given", line), or (operation, constant, constant).
Constant = float | tuple[Any, ...]


class StateVariable(NamedTuple):
    """A variable of the state, which follows from its rate."""

    number: int
    rule: str = "state"


class Time(NamedTuple):
    """Time."""

    rule: str = "time"


class Lack(NamedTuple):
    """Lack of the press, linear in time: step.py writes its coefficients."""

    rule: str = "lack"


class Sine(NamedTuple):
    """Sine of an angle: of the sum of a constant and multiples of series."""

    constant: Constant
    terms: "Terms"
    rule: str = "sine"


class Cosine(NamedTuple):
    """Cosine of an angle; see ``Sine``."""

    constant: Constant
    terms: "Terms"
    rule: str = "cosine"


class SumSeries(NamedTuple):
    """Sum of a constant and multiples of series."""

    constant: Constant
    terms: "Terms"
    rule: str = "sum"

    @property
    def inputs(self) -> "tuple[TaylorSeries, ...]":
        """Series whose coefficients of an order it needs for its own of it."""
        return tuple(each for each, _ in self.terms)


class Rate(NamedTuple):
    """Rate of a series."""

    of: "TaylorSeries"
    rule: str = "rate"

    @property
    def inputs(self) -> "tuple[TaylorSeries, ...]":
        """As of ``SumSeries``."""
        return (self.of,)


class Product(NamedTuple):
    """Product of two series; its coefficients are sums over those of its ``factors``."""

    one: "TaylorSeries"
    other: "TaylorSeries"
    rule: str = "product"

    @property
    def inputs(self) -> "tuple[TaylorSeries, ...]":
        """As of ``SumSeries``."""
        return self.one, self.other

    @property
    def factors(self) -> "tuple[TaylorSeries, TaylorSeries]":
        """Return its factors."""
        return self.one, self.other


class Quotient(NamedTuple):
    """Quotient of two series; its coefficients are sums over those of its ``factors``."""

    of: "TaylorSeries"
    by: "TaylorSeries"
    rule: str = "quotient"

    @property
    def inputs(self) -> "tuple[TaylorSeries, ...]":
        """As of ``SumSeries``."""
        return self.of, self.by

    @property
    def factors(self) -> "tuple[TaylorSeries, TaylorSeries]":
        """Return itself and its divisor."""
        return self, self.by


class Root(NamedTuple):
    """Square root of a series; its coefficients are sums over those of its ``factors``."""

    of: "TaylorSeries"
    rule: str = "root"

    @property
    def inputs(self) -> "tuple[TaylorSeries, ...]":
        """As of ``SumSeries``."""
        return (self.of,)

    @property
    def factors(self) -> "tuple[TaylorSeries, TaylorSeries]":
        """Return itself, twice."""
        return self, self


class Absolute(NamedTuple):
    """Absolute value of a sum, in levels of events (levels.py) only."""

    of: SumSeries
    rule: str = "absolute"


class Line(NamedTuple):
    """Line of the workspace, or its rate, in levels of events only."""

    number: int
    is_rate: bool
    rule: str = "line"


class Unknown(NamedTuple):
    """Quantity that levels of events may not contain."""

    rule: str = "unknown"


Convolved = Product | Quotient | Root
TaylorSeries = (
    StateVariable | Time | Lack | Sine | Cosine | SumSeries | Rate | Convolved | Absolute | Line
    | Unknown
)  # fmt: skip
Terms = tuple[tuple[TaylorSeries, Constant], ...]


def product(one: TaylorSeries, other: TaylorSeries) -> Product:
    """Return the product of two series, which is the same in either order."""
    first, second = sorted((one, other), key=repr)
    return Product(first, second)
