"""Section on the paper's claims: every claim with its verdict, and the claims' own runs."""

from collections.abc import Mapping
from pathlib import Path
from string import ascii_lowercase

from model.show.report.section import Results, Section
from model.show.words import figure_title
from model.study.claims import VERDICTS, tally
from model.study.claims.ledger import read_ledger

CAPTION = (
    "Runs made for the claims alone. Where the duration is shown, a curve has a gap where the part "
    "does not align; where another quantity is shown, a cross marks runs that align."
)
SIGNS: Mapping[str, str] = dict(zip(VERDICTS, ("✓", "±", "✗", "–"), strict=True))


def section(results: Results) -> Section:
    """Return the section on claims."""
    titles = {name: run.title for name, run in results.study.claims_runs.items()}
    lines = read_ledger(results.file("claims.csv"))
    runs = list(titles)

    def source(name: str) -> tuple[str, str]:
        if name in runs:
            return f"run {ascii_lowercase[runs.index(name)]}", "#claims-runs"
        return figure_title(name), f"#{name}"

    files = [("the ledger (CSV)", "claims.csv")]
    files += [
        (f"{title.lower()} (netCDF)", f"data/claims/{name}.nc") for name, title in titles.items()
    ]
    content = {
        "tally": tally([line.verdict for line in lines]),
        "lines": lines,
        "signs": SIGNS,
        "source": source,
        "runs": results.picture("figures/claims", CAPTION),
        "files": files,
    }
    template = Path(__file__).with_suffix(".html.j2")
    return Section("claims", "What the paper says, judged", template, content)
