"""The section on the paper's claims: every claim with its verdict, and the claims' own runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import ascii_lowercase

from model.show.report.section import Results, Section
from model.show.words import figure_title
from model.study.claims import VERDICTS, tally
from model.study.claims.table import Line, read_ledger

CAPTION = (
    "Runs made for the claims alone. Where the duration is shown, a curve has a gap where the part "
    "does not align; where another quantity is shown, a cross marks runs that align."
)
SIGNS: Mapping[str, str] = dict(zip(VERDICTS, ("✓", "±", "✗", "–"), strict=True))


@dataclass(frozen=True)
class ClaimRow:
    """A claim as the page shows it; ``sources`` are (words, address)."""

    line: Line
    sign: str
    sources: tuple[tuple[str, str], ...]


def claim_rows(lines: Sequence[Line], runs: Sequence[str]) -> tuple[ClaimRow, ...]:
    """Return the rows of the ledger.

    Args:
        lines: the ledger.
        runs: names of the claims' own runs, in the order of their picture's panels.
    """
    return tuple(
        ClaimRow(line, SIGNS.get(line.verdict, "?"), tuple(_source(s, runs) for s in line.sources))
        for line in lines
    )


def _source(name: str, runs: Sequence[str]) -> tuple[str, str]:
    if name in runs:
        return f"run {ascii_lowercase[runs.index(name)]}", "#claims-runs"
    return figure_title(name), f"#{name}"


def section(results: Results) -> Section:
    """Return the section on claims."""
    titles = {name: run.title for name, run in results.study.claims_runs.items()}
    lines = read_ledger(results.file("claims.csv"))
    files = [("the ledger (CSV)", "claims.csv")]
    files += [
        (f"{title.lower()} (netCDF)", f"data/claims/{name}.nc") for name, title in titles.items()
    ]
    content = {
        "tally": tally([line.verdict for line in lines]),
        "rows": claim_rows(lines, list(titles)),
        "runs": results.picture("figures/claims", CAPTION),
        "files": files,
    }
    template = Path(__file__).with_suffix(".html.j2")
    return Section("claims", "What the paper says, judged", template, content)
