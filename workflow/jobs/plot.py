"""Plot a dataset."""

from pathlib import Path

from model.show.plots import draw
from model.show.style import save
from model.study.datasets import read_dataset


def run(data: Path, pictures: list[Path]) -> None:
    """Plot what the dataset's kind asks for."""
    save(draw(read_dataset(data)), pictures[0].with_suffix(""))
