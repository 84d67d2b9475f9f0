"""The shapes that most checks have: a number for each curve, for each figure, or one in all."""

import math
from collections.abc import Callable, Mapping, Sequence

from model.study.claims.ledger import Check, Part, labelled
from model.study.claims.reading import Array, Curve, Data, MissingDataError

ANY = math.inf


def one(number: Callable[[Data], float]) -> Check:
    """One number of all the datasets."""
    return lambda data: [Part("", number(data))]


def each_curve(
    name: str,
    symbol: str,
    number: Callable[[Curve], float],
    low: float = -ANY,
    high: float = ANY,
) -> Check:
    """A number for each curve of a figure whose parameter, ``symbol``, is in a range."""

    def check(data: Data) -> list[Part]:
        found = data.between(name, low, high)
        return [labelled(symbol, curve, number(curve)) for curve in found]

    return check


def each_figure(names: Sequence[str], number: Callable[[Data, str], float]) -> Check:
    """A number for each of some figures that there is a dataset of."""

    def check(data: Data) -> list[Part]:
        found = [name for name in names if data.has(name)]
        if not found:
            raise MissingDataError(f"there is no dataset of {', '.join(names)}")
        return [Part(f"Fig. {int(name[3:])}", number(data, name)) for name in found]

    return check


def of_points(number: Callable[[Mapping[str, Array]], float]) -> Callable[[Data, str], float]:
    """A number of a figure's regular points; see ``Data.regular``."""
    return lambda data, name: number(data.regular(name))
