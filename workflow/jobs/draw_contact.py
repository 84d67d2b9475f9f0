"""Draw the figures on bases of other stiffness and damping."""

from pathlib import Path

from model.show.contact_plots import draw_bases
from model.show.style import save
from model.study.datasets import read_dataset


def run(data: list[Path], pictures: list[Path]) -> None:
    """Draw all of them in one picture."""
    datasets = {path.stem: read_dataset(path) for path in data}
    save(draw_bases(datasets), pictures[0].with_suffix(""))
