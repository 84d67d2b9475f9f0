"""The checks of claims: how a number of a curve, of a figure or of a claim becomes parts to judge.

``NUMBERS`` holds every number by name. A number is one of

- ``of_curve``: a number of one curve. The table adds ``curves`` (a range of the family's parameter:
  one part for each curve), or ``curve`` (one of them), and may ``combine`` the numbers into one, or
  ask how far they are ``beyond`` the largest number of other curves;
- ``of_figure``: a number of one figure's points, map or trajectory, one part for each figure;
- ``of_claim``: parts of all the claim's figures together.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from model.study.claims.reading import Curve, Data, MissingDataError
from model.study.claims.statistics import NAN, Array, median


class Part(NamedTuple):
    """A number of one part of a claim; ``where`` names the part, such as "k_φ = 5".

    NaN says that what the paper describes is not there to be measured, as the duration of a part
    that never aligns: that contradicts the claim as far as it goes.
    """

    where: str
    value: float


Check = Callable[[Data, Sequence[str]], Sequence[Part]]
NUMBERS: dict[str, Callable[..., Check]] = {}


def check_of(number: str, arguments: Mapping[str, Any]) -> Check:
    """Return the check that takes data and the claim's figures to parts.

    Raises:
        ValueError: no measure of that name.
        TypeError: arguments that it does not take.
    """
    if number not in NUMBERS:
        raise ValueError(f"number = {number!r}: must be one of {', '.join(NUMBERS)}")
    return NUMBERS[number](**arguments)


def _bound(number: Callable[..., Any], arguments: Mapping[str, Any], given: int) -> None:
    inspect.signature(number).bind(*[None] * given, **arguments)


def _difference(values: Array) -> float:
    return float(values.max() - values.min()) if values.size > 1 else NAN


def _relative_difference(values: Array) -> float:
    if values.size < 2 or values.mean() == 0.0:
        return NAN
    return float(np.ptp(values) / abs(values.mean()))


_COMBINED: Mapping[str, Callable[[Array], float]] = {
    "difference": _difference,
    "relative difference": _relative_difference,
    "median": median,
    "largest": lambda values: float(values.max()) if values.size else NAN,
}


def of_curve(number: Callable[..., float]) -> Callable[..., float]:
    """Register a number of one curve."""

    def made(
        *,
        curves: str | list[float] = "any",
        curve: float | None = None,
        combine: str = "",
        beyond: str = "",
        **arguments: Any,
    ) -> Check:
        _bound(number, arguments, 1)

        def known(found: Sequence[Curve]) -> Array:
            values = np.array([number(each, **arguments) for each in found])
            return values[~np.isnan(values)]

        def check(data: Data, figures: Sequence[str]) -> Sequence[Part]:
            name = figures[0]
            if curve is not None:
                return [Part("", number(data.curves(name, curve)[0], **arguments))]
            if combine:
                found = [each for name in figures for each in data.curves(name, curves)]
                return [Part("", _COMBINED[combine](known(found)))]
            parts = [Part(c.name, number(c, **arguments)) for c in data.curves(name, curves)]
            if not beyond:
                return parts
            largest = max(known(data.curves(name, beyond)), default=NAN)
            return [Part(where, float(value - largest)) for where, value in parts]

        return check

    NUMBERS[number.__name__] = made
    return number


def of_figure(
    view: Callable[[Data, str], Any],
) -> Callable[[Callable[..., float]], Callable[..., float]]:
    """Register a number of one figure's ``view``; figures without a dataset are left out.

    With ``all`` among its arguments, the claim cannot be checked without any of its figures.
    """

    def register(number: Callable[..., float]) -> Callable[..., float]:
        def made(*, all: bool = False, **arguments: Any) -> Check:  # noqa: A002
            _bound(number, arguments, 1)

            def check(data: Data, figures: Sequence[str]) -> Sequence[Part]:
                needed = all or len(figures) == 1
                found = [name for name in figures if needed or data.has(name)]
                if not found:
                    raise MissingDataError(f"there is no dataset of {', '.join(figures)}")
                return [
                    Part(
                        f"Fig. {int(name[3:])}" if len(figures) > 1 else "",
                        number(view(data, name), **arguments),
                    )
                    for name in found
                ]

            return check

        NUMBERS[number.__name__] = made
        return number

    return register


def of_claim(number: Callable[..., Sequence[Part]]) -> Callable[..., Sequence[Part]]:
    """Register parts of all figures together."""

    def made(**arguments: Any) -> Check:
        _bound(number, arguments, 2)
        return lambda data, figures: number(data, figures, **arguments)

    NUMBERS[number.__name__] = made
    return number
