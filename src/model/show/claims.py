"""The report's section on the claims of the paper; its wording is in ``claims.html.j2``."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import ascii_lowercase

from model.study.claims import VERDICTS, tally
from model.study.claims.table import Line

RUNS_CAPTION = (
    "What only the ledger asks for. Where the duration is shown, a curve has a gap where the part "
    "does not align; where another quantity is shown, a cross marks runs that do."
)


@dataclass(frozen=True)
class Ledger:
    """What the report says of the paper's claims: the ledger's lines, and a picture of its runs."""

    lines: Sequence[Line]
    picture: Path


@dataclass(frozen=True)
class ClaimRow:
    """A claim as the page shows it; ``sources`` are (words, address)."""

    line: Line
    sign: str
    sources: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class ClaimsSection:
    """What the page says of the claims."""

    tally: str
    rows: tuple[ClaimRow, ...]
    caption: str
    runs: tuple[tuple[str, str], ...]


_SIGNS: Mapping[str, str] = dict(zip(VERDICTS, ("✓", "±", "✗", "–"), strict=True))


def claims_section(lines: Sequence[Line], titles: Mapping[str, str]) -> ClaimsSection:
    """The section on claims.

    Args:
        lines: the ledger.
        titles: of the ledger's own runs, by name.
    """
    return ClaimsSection(
        tally=tally([line.verdict for line in lines]),
        rows=tuple(
            ClaimRow(
                line, _SIGNS.get(line.verdict, "?"), tuple(_source(s, titles) for s in line.sources)
            )
            for line in lines
        ),
        caption=RUNS_CAPTION,
        runs=tuple(titles.items()),
    )


def _source(name: str, titles: Mapping[str, str]) -> tuple[str, str]:
    if name in titles:
        letter = ascii_lowercase[list(titles).index(name)]
        return f"run {letter}", "#claims-runs"
    return f"Fig. {int(name.removeprefix('fig'))}", f"#{name}"
