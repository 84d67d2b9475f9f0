"""The entries of the ledger, as ``claims.yaml`` states them, each with its check.

An entry is a statement of the paper with all its parts. Its check, a function of ``checks`` with
the name of the entry, yields a number for each part and curve; every number must keep its limit.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

from model.sweeps.files import parse_yaml
from study.claims import checks
from study.claims.data import Figures

Numbers = Iterator[tuple[str, str, float]]
_LEAST_SCALE = 0.05


@dataclass(frozen=True)
class Limit:
    """The demand on the numbers of one part of an entry.

    Attributes:
        measure: the number in words.
        threshold: what it is compared with.
        is_least: True if a number must be at least the threshold, else at most.
        reason: reason for the threshold.
        shared: name of the limit that several parts share, "" for one of its own.
    """

    measure: str
    threshold: float
    is_least: bool
    reason: str
    shared: str = ""

    def margin(self, value: float) -> float:
        """Return the distance from the threshold over its size, >= 0 where met; -1 for NaN.

        It is held in [-1, 1].
        """
        if math.isnan(value):
            return -1.0
        distance = (value - self.threshold) * (1.0 if self.is_least else -1.0)
        return max(-1.0, min(1.0, distance / max(abs(self.threshold), _LEAST_SCALE)))

    @property
    def demand(self) -> str:
        """The threshold in words."""
        if 0.0 < self.threshold < _LEAST_SCALE**3:
            return "more than 0"
        return f"at {'least' if self.is_least else 'most'} {self.threshold:.3g}"


@dataclass(frozen=True)
class Claim:
    """One entry of the ledger.

    Attributes:
        id: identifier, such as "L4".
        place: place in the paper.
        says: the paper's words, shortened.
        figures: figures by which it is judged; the first shows it.
        limits: the demand on each part, by the part's name.
        check: yields part, curve ("" for the whole) and number; it reads only ``figures``.
        reading: how the words are read, and why so; "" where they leave no choice.
    """

    id: str
    place: str
    says: str
    figures: tuple[str, ...]
    limits: Mapping[str, Limit]
    check: Callable[[Figures], Numbers]
    reading: str

    @property
    def is_conclusion(self) -> bool:
        """True for a numbered conclusion."""
        return "concl." in self.place


def _limit(stated: Mapping[str, Any], named: Mapping[str, Mapping[str, Any]]) -> Limit:
    given = {**stated, **named[stated["must"]]} if "must" in stated else stated
    least = "least" in given
    extra = set(given) - {"is", "must", "least", "most", "reason"}
    if extra or least == ("most" in given):
        raise ValueError(f"{dict(stated)}: must be {{is, must}} or {{is, least or most, reason}}")
    threshold = float(given["least" if least else "most"])
    shared = stated.get("must", "")
    return Limit(str(given.get("is", "")), threshold, least, str(given["reason"]), shared)


def _claim(name: str, stated: Mapping[str, Any], shared: Mapping[str, Any]) -> Claim:
    if extra := set(stated) - {"place", "says", "figures", "read", "parts"}:
        raise ValueError(f"unknown {', '.join(sorted(extra))}")
    return Claim(
        id=name,
        place=stated["place"],
        says=stated["says"],
        figures=tuple(stated["figures"]),
        limits={part: _limit(limit, shared) for part, limit in stated["parts"].items()},
        check=getattr(checks, name.lower()),
        reading=stated.get("read", ""),
    )


def claims_of(text: str) -> tuple[Claim, ...]:
    """Return the entries of a list in the form of ``claims.yaml``, in its order.

    Raises:
        ValueError: an entry that breaks a rule; the message names both.
    """
    table = parse_yaml(text)
    claims = []
    for name, stated in table["entries"].items():
        try:
            claims.append(_claim(name, stated, table["limits"]))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise ValueError(f"claims.yaml: {name}: {error}") from error
    return tuple(claims)


CLAIMS = claims_of((resources.files("study.claims") / "claims.yaml").read_text(encoding="utf-8"))
