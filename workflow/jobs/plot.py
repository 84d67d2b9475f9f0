"""Plot a dataset."""

from collections.abc import Sequence
from pathlib import Path

from model.show.plots import draw
from model.show.style import save
from model.study.datasets import read_dataset


def run(data: Path, pictures: list[Path], coarse: Sequence[Path] = ()) -> None:
    """Plot what the dataset's kind asks for; of a refined map, ``coarse`` is the figure's."""
    save(draw(read_dataset(data), *map(read_dataset, coarse)), pictures[0].with_suffix(""))
