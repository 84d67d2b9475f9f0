"""Verdicts of the figures on the entries, and their table ``claims.csv``."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from study.claims.claims import CLAIMS, Claim
from study.claims.data import Figures, MissingDataError
from study.csv_tables import read_records, records_text

Verdict = Literal["shown", "not shown", "not checkable"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
_LEAST = 0.0005  # from which a number is not printed as 0


@dataclass(frozen=True)
class Number:
    """A number of an entry: of one part, and of one curve or figure; ``margin`` as in ``Limit``."""

    part: str
    where: str
    value: float
    margin: float

    def __str__(self) -> str:
        if math.isnan(self.value):
            shown = "nothing to measure"
        elif math.isinf(self.value):
            shown = "nothing to compare with"
        else:
            shown = f"{self.value:.3g}" if abs(self.value) >= _LEAST else "0.000"
        return f"{self.where}: {shown}" if self.where else shown


@dataclass(frozen=True)
class Judgement:
    """The verdict of the figures on an entry.

    Attributes:
        verdict: "shown" if every number keeps its limit, else "not shown"; "not checkable" if a
            dataset, a curve or a result is missing.
        numbers: of every part and curve.
        missing: why it is not checkable, "" if it is.
    """

    verdict: Verdict
    numbers: tuple[Number, ...]
    missing: str = ""


def judge_claim(claim: Claim, figures: Figures) -> Judgement:
    """Return the verdict of figures on one entry; it sees only those that the entry names."""
    if absent := [name for name in claim.figures if name not in figures]:
        return Judgement("not checkable", (), f"there is no dataset {absent[0]}")
    try:
        numbers = numbers_of(claim, {name: figures[name] for name in claim.figures})
    except MissingDataError as missing:
        return Judgement("not checkable", (), str(missing))
    return Judgement("shown" if all(n.margin >= 0.0 for n in numbers) else "not shown", numbers)


def numbers_of(claim: Claim, figures: Figures) -> tuple[Number, ...]:
    """Return the numbers of an entry by the figures at hand.

    Raises:
        MissingDataError: a curve or a result that the check reads is missing.
    """
    return tuple(
        Number(part, where, value, claim.limits[part].margin(value))
        for part, where, value in claim.check(figures)
    )


def judge(figures: Figures) -> tuple[tuple[Claim, Judgement], ...]:
    """Return every entry with its verdict."""
    return tuple((claim, judge_claim(claim, figures)) for claim in CLAIMS)


def tally(verdicts: Sequence[str]) -> str:
    """Return the number of entries with each verdict, in one line."""
    return ", ".join(f"{list(verdicts).count(name)} {name}" for name in VERDICTS)


# --- claims.csv -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Line:
    """A row of ``claims.csv``: an entry, its verdict and its numbers.

    Attributes:
        claim: identifier of the entry.
        verdict: as in ``Judgement``.
        place: place in the paper.
        says: the paper's words, shortened.
        seen: the numbers of every part, or why the entry is not checkable.
        fails: the parts that do not keep their limits, "" for none.
        random: share of random devices that shows the entry.
    """

    claim: str
    verdict: str
    place: str
    says: str
    seen: str
    fails: str
    random: float


def lines_of(judged: Iterable[tuple[Claim, Judgement]], shares: Mapping[str, float]) -> list[Line]:
    """Return the rows of ``claims.csv``; ``shares`` of random devices by entry."""
    rows = []
    for claim, found in judged:
        seen = [
            f"{part}: {', '.join(str(n) for n in found.numbers if n.part == part)}"
            for part in claim.limits
        ]
        fails = dict.fromkeys(number.part for number in found.numbers if number.margin < 0.0)
        words = found.missing or "; ".join(seen), "; ".join(fails)
        rows.append(
            Line(claim.id, found.verdict, claim.place, claim.says, *words, shares[claim.id])
        )
    return rows


def ledger_text(lines: Iterable[Line]) -> str:
    """Return the content of ``claims.csv``."""
    return records_text(Line, lines, {"random": ".3f"})


def read_ledger(path: Path) -> list[Line]:
    """Return the rows of a file ``claims.csv``.

    Raises:
        ValueError: a file that is missing, empty, or not a ledger.
    """
    return read_records(path, "claims", Line)
