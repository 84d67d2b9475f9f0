"""Judge the paper's claims by the datasets of the study."""

from pathlib import Path

from model.study.claims import judge
from model.study.claims.ledger import ledger_text, lines_of
from model.study.datasets import read_dataset
from model.tracking.provenance import write_text


def run(figures: list[Path], runs: list[Path], table: Path) -> None:
    """Write the claims ledger."""
    judged = judge({path.stem: read_dataset(path) for path in (*figures, *runs)})
    write_text(ledger_text(lines_of(judged)), table)
