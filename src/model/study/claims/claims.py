"""The claims of the paper, as ``claims.yaml`` states them; its form is checked here.

A claim may speak of several curves: its measure then gives a number for each, all on one scale, and
the claim is reproduced if all of them are on the right side of the threshold. Thresholds follow
from the wording and from the resolution of a printed figure, never from the outcome.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any, Literal, get_args

import yaml

from model.study.claims import comparisons  # noqa: F401  (registers its measures)
from model.study.claims.checks import Check, check_of

Kind = Literal["stated in figure text", "conclusion", "interpretation"]
EVERY_FIGURE = tuple(f"fig{number:02}" for number in range(5, 15))
_KINDS: Mapping[str, Kind] = dict(
    zip(("stated", "concluded", "interpreted"), get_args(Kind), strict=True)
)


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
        check: function that returns the number of each part; None if nothing can be measured.
        asked: figures, number and arguments of the check as the table states them.
    """

    id: str
    place: str
    kind: Kind
    statement: str
    figures: tuple[str, ...]
    measure: str
    limit: Limit
    check: Check | None
    asked: str


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
        claim = Claim(name, place, _KINDS[kind], statement, (), "", limit, None, "")
    else:
        arguments = dict(stated.pop("check"))
        limit = _demanded(arguments.pop("must"), named)
        asked, figures = str(arguments), arguments.pop("figures")
        claim = Claim(
            id=name,
            place=place,
            kind=_KINDS[kind],
            statement=statement,
            figures=EVERY_FIGURE if figures == "every figure" else tuple(figures),
            measure=stated.pop("measure"),
            limit=limit,
            check=check_of(arguments.pop("number"), arguments),
            asked=asked,
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
