"""The ledger on disk: ``claims.csv``, one line a claim, the same bytes for the same datasets."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from model.study.claims.claims import Claim
from model.study.claims.ledger import Finding
from model.study.csv_tables import read_records, records_text


@dataclass(frozen=True)
class Line:
    """One claim and its verdict in words; numbers to six digits, "" for none."""

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
    shown_by: str

    @property
    def sources(self) -> list[str]:
        """Figures and own runs that show it, the most telling first."""
        return self.shown_by.split()


def lines_of(judged: Iterable[tuple[Claim, Finding]]) -> list[Line]:
    """Return the ledger in words."""
    return [
        Line(
            claim=claim.id,
            verdict=finding.verdict,
            place=claim.place,
            kind=claim.kind,
            statement=claim.statement,
            measure=claim.measure,
            value=_number(finding.value),
            demand="" if claim.check is None else claim.limit.demand,
            margin=_number(finding.margin),
            seen=finding.seen,
            reason=claim.limit.reason,
            shown_by=" ".join(claim.figures),
        )
        for claim, finding in judged
    ]


def _number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"


def ledger_text(lines: Iterable[Line]) -> str:
    """Return the content of ``claims.csv``."""
    return records_text(Line, lines, {})


def read_ledger(path: Path) -> list[Line]:
    """Return the lines of ``claims.csv``.

    Raises:
        TableError: a file that is missing, empty, or not a ledger.
    """
    return read_records(path, "claims", Line)
