"""The claims of the paper, as ``claims.yaml`` states them; its form is checked here.

A check takes its number of each curve of the first figure (``measures.OF_CURVE``), of each figure
(``measures.OF_FIGURE``) or of all figures together (``comparisons.OF_CLAIM``); ``ledger`` holds
what it finds against the claim's limit. Of curves it may take those in a range (``curves``), or one
(``curve``); ``combine`` makes one number of the curves of all figures, and ``beyond`` takes off the
largest number of other curves. Thresholds follow from the wording and from the resolution of a
printed figure, never from the outcome.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import resources
from typing import Any

import numpy as np
import yaml

from model.study.claims.comparisons import OF_CLAIM, Parts
from model.study.claims.data import NAN, Array, Curve, Data, MissingDataError
from model.study.claims.measures import OF_CURVE, OF_FIGURE, Number, View, median

Check = Callable[[Data, Sequence[str]], Parts]
EVERY_FIGURE = tuple(f"fig{number:02}" for number in range(5, 15))
_KINDS = {
    "stated": "stated in figure text",
    "concluded": "conclusion",
    "interpreted": "interpretation",
}


class ClaimsError(ValueError):
    """A table of claims that breaks a rule; the message names the claim."""


@dataclass(frozen=True)
class Limit:
    """The demand on a number.

    Attributes:
        threshold: NaN where there is nothing to measure.
        is_least: True if the number must be above the threshold, else below.
        scale: one unit of margin.
        reason: reason for the threshold, or for having nothing to measure.
    """

    threshold: float
    is_least: bool
    scale: float
    reason: str

    def margin(self, value: float) -> float:
        """Signed distance from the threshold, in (-1, 1), positive where met; -1 for NaN."""
        if math.isnan(value):
            return -1.0
        distance = (value - self.threshold) / self.scale * (1.0 if self.is_least else -1.0)
        if math.isinf(distance):
            return math.copysign(1.0, distance)
        return distance / (1.0 + abs(distance))

    @property
    def demand(self) -> str:
        """The threshold in words."""
        return f"at {'least' if self.is_least else 'most'} {self.threshold:.3g}"


@dataclass(frozen=True)
class Claim:
    """One statement of the paper.

    Attributes:
        id: identifier, such as "F6a".
        place: place in the paper.
        kind: stated of a figure, concluded, or one interpretation of an unclear sentence.
        statement: the paper's words, shortened.
        figures: figures and own runs of the ledger that it is judged by; the first shows it.
        measure: the number in words.
        limit: the demand on the number.
        check: function of the data and figures that returns the number of each part of the claim
            by the part's name, "" for the whole; None if nothing can be measured. NaN says that
            what the paper describes is not there to be measured, as the duration of a part that
            never aligns: that contradicts the claim as far as it goes.
    """

    id: str
    place: str
    kind: str
    statement: str
    figures: tuple[str, ...]
    measure: str
    limit: Limit
    check: Check | None


# --- The check ----------------------------------------------------------------------------------


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
}


def _of_curves(
    number: Callable[[Curve], float],
    data: Data,
    figures: Sequence[str],
    curves: str | list[float] = "any",
    curve: float | None = None,
    combine: str = "",
    beyond: str = "",
) -> Parts:
    def known(found: Sequence[Curve]) -> Array:
        values = np.array([number(each) for each in found])
        return values[~np.isnan(values)]

    if curve is not None:
        return {"": number(data.curves(figures[0], curve)[0])}
    if combine:
        found = [each for name in figures for each in data.curves(name, curves)]
        return {"": _COMBINED[combine](known(found))}
    parts = {each.name: number(each) for each in data.curves(figures[0], curves)}
    if not beyond:
        return parts
    largest = max(known(data.curves(figures[0], beyond)), default=NAN)
    return {where: float(value - largest) for where, value in parts.items()}


def _of_figures(
    view: View, number: Number, data: Data, figures: Sequence[str], needs_all: bool
) -> Parts:
    """Numbers of the figures that have a dataset, of all of them with ``needs_all``."""
    needed = needs_all or len(figures) == 1
    found = [name for name in figures if needed or data.has(name)]
    if not found:
        raise MissingDataError(f"there is no dataset of {', '.join(figures)}")
    return {
        f"Fig. {int(name[3:])}" if len(figures) > 1 else "": number(view(data, name))
        for name in found
    }


def _of_claim(number: Callable[..., Parts | float], data: Data, figures: Sequence[str]) -> Parts:
    found = number(data, *figures)
    return {"": found} if isinstance(found, float) else found


def _check_of(name: str, figures: Sequence[str], arguments: dict[str, Any]) -> Check:
    """Return the check by the number of this name.

    Raises:
        ValueError: no number of that name.
        TypeError: arguments that it does not take.
    """

    def bound(number: Callable[..., Any], *given: Any) -> Callable[..., Any]:
        inspect.signature(number).bind(*given, **arguments)
        return partial(number, **arguments)

    if name in OF_CURVE:
        of_curves = ("curves", "curve", "combine", "beyond")
        chosen = {key: arguments.pop(key) for key in of_curves if key in arguments}
        return partial(_of_curves, bound(OF_CURVE[name], None), **chosen)
    if name in OF_FIGURE:
        needs_all = arguments.pop("all", False)
        view, number = OF_FIGURE[name]
        return partial(_of_figures, view, bound(number, None), needs_all=needs_all)
    if name in OF_CLAIM:
        return partial(_of_claim, bound(OF_CLAIM[name], None, *figures))
    names = ", ".join((*OF_CURVE, *OF_FIGURE, *OF_CLAIM))
    raise ValueError(f"number = {name!r}: must be one of {names}")


# --- The table ----------------------------------------------------------------------------------


def limit_of(stated: Mapping[str, Any]) -> Limit:
    """Return the limit stated as {least or most, scale, reason}."""
    least = "least" in stated
    (threshold,) = (stated[name] for name in ("least", "most") if name in stated)
    extra = set(stated) - {"least", "most", "scale", "reason"}
    if extra or not stated["scale"] > 0.0:
        raise ValueError(f"limit {dict(stated)}: must be {{least or most, scale > 0, reason}}")
    return Limit(float(threshold), least, float(stated["scale"]), str(stated["reason"]))


def _demanded(must: str | Mapping[str, Any], named: Mapping[str, Limit]) -> Limit:
    if isinstance(must, str):
        return named[must]
    if "be" not in must:
        return limit_of(must)
    found = named[must["be"]]
    return replace(found, reason=f"{found.reason}; {must['also']}")


def _claim(name: str, stated: dict[str, Any], named: Mapping[str, Limit]) -> Claim:
    (kind,) = set(_KINDS) & set(stated)
    place, statement = stated.pop(kind), stated.pop("statement")
    if "unmeasured" in stated:
        limit = Limit(math.nan, True, 1.0, stated.pop("unmeasured"))
        claim = Claim(name, place, _KINDS[kind], statement, (), "", limit, None)
    else:
        arguments = dict(stated.pop("check"))
        limit = _demanded(arguments.pop("must"), named)
        figures = arguments.pop("figures")
        figures = EVERY_FIGURE if figures == "every figure" else tuple(figures)
        claim = Claim(
            id=name,
            place=place,
            kind=_KINDS[kind],
            statement=statement,
            figures=figures,
            measure=stated.pop("measure"),
            limit=limit,
            check=_check_of(arguments.pop("number"), figures, arguments),
        )
    if stated:
        raise ValueError(f"unknown {', '.join(stated)}")
    return claim


def claims_of(text: str) -> tuple[Claim, ...]:
    """Return the claims of a table in the form of ``claims.yaml``, in its order.

    Raises:
        ClaimsError: naming the first claim that breaks a rule, and the rule.
    """
    table = yaml.safe_load(text)
    limits = {name: limit_of(stated) for name, stated in table["limits"].items()}
    found = []
    for name, stated in table["claims"].items():
        try:
            found.append(_claim(str(name), dict(stated), limits))
        except (KeyError, TypeError, ValueError) as error:
            raise ClaimsError(f"claims.yaml: {name}: {error}") from error
    return tuple(found)


CLAIMS = claims_of(
    (resources.files("model.study.claims") / "claims.yaml").read_text(encoding="utf-8")
)
