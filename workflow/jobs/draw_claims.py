"""Draw the runs that only the claims ledger has."""

from pathlib import Path

from model.show.claim_plots import draw_runs
from model.show.style import save
from model.study.datasets import read_dataset


def run(data: list[Path], pictures: list[Path]) -> None:
    """Draw all of them in one picture."""
    datasets = {path.stem: read_dataset(path) for path in data}
    save(draw_runs(datasets), pictures[0].with_suffix(""))
