"""Verdicts of the datasets on the claims, and their table ``claims.csv``."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from study.claims.claims import CLAIMS, Claim
from study.claims.data import MissingDataError, Tables
from study.csv_tables import read_records, records_text

Verdict = Literal["reproduced", "mixed", "contradicted", "not checkable"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)


@dataclass(frozen=True)
class Judgement:
    """The verdict of the datasets on a claim.

    Attributes:
        value: number of the part with the least margin.
        margin: in [-1, 1], a continuous function of the numbers. If all parts meet the demand, the
            least margin of a part; otherwise the mean over all parts, in which parts that meet it
            count as 0. NaN where the claim is not checkable.
        verdict: "reproduced" (all parts), "contradicted" (no part), "mixed", or "not checkable".
        seen: the number of every part, or why the claim is not checkable.
    """

    value: float
    margin: float
    verdict: Verdict
    seen: str


def judge_claim(claim: Claim, tables: Tables) -> Judgement:
    """Return the verdict of the tables on one claim."""
    if claim.check is None:
        return Judgement(math.nan, math.nan, "not checkable", claim.limit.reason)
    try:
        parts = claim.check.numbers(tables, claim.figures)
    except MissingDataError as missing:
        return Judgement(math.nan, math.nan, "not checkable", f"{missing}")
    margins = {where: claim.limit.margin(value) for where, value in parts.items()}
    worst = min(margins, key=margins.__getitem__)
    verdict: Verdict
    if margins[worst] > 0.0:
        verdict, margin = "reproduced", margins[worst]
    else:
        verdict = "mixed" if max(margins.values()) > 0.0 else "contradicted"
        margin = -sum(max(0.0, -each) for each in margins.values()) / len(margins)
    seen = "; ".join(
        f"{where}: {_shown(value)}" if where else _shown(value) for where, value in parts.items()
    )
    return Judgement(parts[worst], margin, verdict, seen)


def _shown(value: float) -> str:
    return "nothing to measure" if math.isnan(value) else f"{value:.3g}"


def judge(tables: Tables) -> tuple[tuple[Claim, Judgement], ...]:
    """Return every claim of the paper with its verdict, "not checkable" without its tables."""
    return tuple((claim, judge_claim(claim, tables)) for claim in CLAIMS)


def tally(verdicts: Sequence[str]) -> str:
    """Return the number of claims with each verdict, in one line."""
    return ", ".join(f"{name} {list(verdicts).count(name)}" for name in VERDICTS)


# --- claims.csv ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Line:
    """A row of ``claims.csv``: a claim and its verdict; numbers as text, "" for none."""

    claim: str
    verdict: str
    place: str
    kind: str
    statement: str
    measure: str
    value: str
    demand: str
    margin: str
    seen: str
    reason: str
    reading: str
    shown_by: str
    random_devices: str = ""  # shares of random draws that show it, and its evidence in bits
    random_points: str = ""
    bits: str = ""

    @property
    def sources(self) -> list[str]:
        """Names of the figures and runs by which it is judged; the first shows it."""
        return self.shown_by.split()


def lines_of(judged: Iterable[tuple[Claim, Judgement]]) -> list[Line]:
    """Return the rows of ``claims.csv``."""
    return [
        Line(
            claim=claim.id,
            verdict=judgement.verdict,
            place=claim.place,
            kind=claim.kind,
            statement=claim.statement,
            measure=claim.measure,
            value=_number(judgement.value),
            demand="" if claim.check is None else claim.limit.demand,
            margin=_number(judgement.margin),
            seen=judgement.seen,
            reason=claim.limit.reason,
            reading=claim.reading,
            shown_by=" ".join(claim.figures),
        )
        for claim, judgement in judged
    ]


def _number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"


def ledger_text(lines: Iterable[Line]) -> str:
    """Return the content of ``claims.csv``."""
    return records_text(Line, lines, {})


def read_ledger(path: Path) -> list[Line]:
    """Return the rows of a file ``claims.csv``.

    Raises:
        TableError: a file that is missing, empty, or not a ledger.
    """
    return read_records(path, "claims", Line)
