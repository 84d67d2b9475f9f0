"""Draw jamming in the slot beside its closed forms."""

from pathlib import Path

from model.show.jamming import draw_jamming
from model.show.style import save
from model.study.datasets import read_dataset


def run(data: Path, pictures: list[Path]) -> None:
    """Draw the picture."""
    save(draw_jamming(read_dataset(data)), pictures[0].with_suffix(""))
