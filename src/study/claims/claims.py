"""The claims of the paper, as ``claims.yaml`` states them; its form is checked here.

A claim's check computes numbers, and ``ledger`` compares them with its limit. Thresholds follow
from the paper's wording and from the resolution of a printed figure, never from the outcome.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib import resources
from typing import Any

from model.sweeps.files import parse_yaml
from study.claims.check import Check, check_of

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
        check: the number; None if nothing can be measured.
        reading: how the words are read, and why so; "" where they leave no choice.
    """

    id: str
    place: str
    kind: str
    statement: str
    figures: tuple[str, ...]
    measure: str
    limit: Limit
    check: Check | None
    reading: str = ""

    @property
    def compares(self) -> bool:
        """True if it says nothing of one of its figures alone: they are compared, or combined."""
        if self.check is None:
            return False
        return self.check.together or (self.check.combine != "" and len(self.figures) > 1)


# --- The table ----------------------------------------------------------------------------------


def limit_of(stated: Mapping[str, Any]) -> Limit:
    """Return the limit that is stated as {least or most, scale, reason}; 1/3 is a threshold, too.

    Raises:
        KeyError: the scale or the reason is missing.
        ValueError: not one threshold, another key, or a scale that is not > 0.
    """
    least = "least" in stated
    (threshold,) = (stated[name] for name in ("least", "most") if name in stated)
    extra = set(stated) - {"least", "most", "scale", "reason"}
    if extra or not stated["scale"] > 0.0:
        raise ValueError(f"limit {dict(stated)}: must be {{least or most, scale > 0, reason}}")
    exact = float(Fraction(str(threshold)))
    return Limit(exact, least, float(stated["scale"]), str(stated["reason"]))


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
    reading = stated.pop("read", "")
    if "unmeasured" in stated:
        limit = Limit(math.nan, True, 1.0, stated.pop("unmeasured"))
        claim = Claim(*said, (), "", limit, None, reading)
    else:
        check = dict(stated.pop("check"))
        figures, limit = check.pop("figures"), _demanded(check.pop("must"), named)
        figures = EVERY_FIGURE if figures == "every figure" else tuple(figures)
        measure = stated.pop("measure")
        claim = Claim(*said, figures, measure, limit, check_of(check), reading)
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


CLAIMS = claims_of((resources.files("study.claims") / "claims.yaml").read_text(encoding="utf-8"))
