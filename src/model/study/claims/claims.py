"""The claims of the paper, as ``claims.yaml`` states them; its form is checked here.

A check computes a number for each curve of the first figure (``measures.OF_CURVE``), for each
figure (``measures.OF_FIGURE``), or for all figures together (``comparisons.OF_CLAIM``). ``ledger``
compares it with the claim's limit. Curves may be restricted to those in a range (``curves``) or to
one (``curve``). ``combine`` makes one number of the curves of all figures; ``beyond`` subtracts the
largest number of other curves. Thresholds follow from the paper's wording and from the resolution
of a printed figure, never from the outcome.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import resources
from typing import Any

import numpy as np

from model.study.claims.comparisons import OF_CLAIM, Parts
from model.study.claims.data import NAN, Array, Curve, Data, MissingDataError
from model.study.claims.measures import OF_CURVE, OF_FIGURE, Number, View, median
from model.sweeps.files import parse_yaml

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
        """Return the signed distance from the threshold, in [-1, 1], > 0 where met; -1 for NaN."""
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
        kind: statement on a figure, conclusion, or one interpretation of an unclear sentence.
        statement: the paper's words, shortened.
        figures: figures, and runs made for the claims, by which it is judged; the first shows it.
        measure: the number in words.
        limit: the demand on the number.
        check: function of the data and figures that returns the number of each part of the claim
            by the part's name, "" for the whole; None if nothing can be measured. NaN where the
            data lack what the paper describes, such as the duration of a part that never aligns;
            this counts against the claim.
        compares: True if the check compares its figures: it needs the datasets of all.
    """

    id: str
    place: str
    kind: str
    statement: str
    figures: tuple[str, ...]
    measure: str
    limit: Limit
    check: Check | None
    compares: bool = False


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
    def known(curves: Sequence[Curve]) -> Array:
        values = np.array([number(each) for each in curves])
        return values[~np.isnan(values)]

    if curve is not None:
        return {"": number(data.curves(figures[0], curve)[0])}
    if combine:
        together = [each for name in figures for each in data.curves(name, curves)]
        return {"": _COMBINED[combine](known(together))}
    parts = {each.name: number(each) for each in data.curves(figures[0], curves)}
    if not beyond:
        return parts
    largest = max(known(data.curves(figures[0], beyond)), default=NAN)
    return {where: float(value - largest) for where, value in parts.items()}


def _of_figures(
    view: View, number: Number, data: Data, figures: Sequence[str], needs_all: bool
) -> Parts:
    """Return the number of each figure; without ``needs_all``, figures may lack a dataset."""
    needed = needs_all or len(figures) == 1
    used = [name for name in figures if needed or name in data.datasets]
    if not used:
        raise MissingDataError(f"there is no dataset of {', '.join(figures)}")
    return {
        f"Fig. {int(name[3:])}" if len(figures) > 1 else "": number(view(data, name))
        for name in used
    }


def _of_claim(number: Callable[..., Parts | float], data: Data, figures: Sequence[str]) -> Parts:
    parts = number(data, *figures)
    return {"": parts} if isinstance(parts, float) else parts


def _check_of(name: str, figures: Sequence[str], arguments: dict[str, Any]) -> Check:
    """Return the check that calls the function of this name.

    Raises:
        ValueError: there is no function of this name.
        TypeError: the function does not take the arguments.
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
    """Return the limit that is stated as {least or most, scale, reason}.

    Raises:
        KeyError: the scale or the reason is missing.
        ValueError: not one threshold, another key, or a scale that is not > 0.
    """
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
    limit = named[must["be"]]
    return replace(limit, reason=f"{limit.reason}; {must['also']}")


def _claim(name: str, stated: dict[str, Any], named: Mapping[str, Limit]) -> Claim:
    (kind,) = set(_KINDS) & set(stated)
    said = (name, stated.pop(kind), _KINDS[kind], stated.pop("statement"))
    if "unmeasured" in stated:
        limit = Limit(math.nan, True, 1.0, stated.pop("unmeasured"))
        claim = Claim(*said, (), "", limit, None)
    else:
        arguments = dict(stated.pop("check"))
        limit = _demanded(arguments.pop("must"), named)
        figures = arguments.pop("figures")
        figures = EVERY_FIGURE if figures == "every figure" else tuple(figures)
        number = arguments.pop("number")
        check = _check_of(number, figures, arguments)
        claim = Claim(*said, figures, stated.pop("measure"), limit, check, number in OF_CLAIM)
    if stated:
        raise ValueError(f"unknown {', '.join(stated)}")
    return claim


def claims_of(text: str) -> tuple[Claim, ...]:
    """Return the claims of a table in the form of ``claims.yaml``, in its order.

    Raises:
        ClaimsError: a claim that breaks a rule; the message names both.
    """
    table = parse_yaml(text)
    limits = {name: limit_of(stated) for name, stated in table["limits"].items()}
    claims = []
    for name, stated in table["claims"].items():
        try:
            claims.append(_claim(str(name), dict(stated), limits))
        except (KeyError, TypeError, ValueError) as error:
            raise ClaimsError(f"claims.yaml: {name}: {error}") from error
    return tuple(claims)


CLAIMS = claims_of(
    (resources.files("model.study.claims") / "claims.yaml").read_text(encoding="utf-8")
)
