"""Plot what vibration adds in a map."""

from pathlib import Path

from model.show.areas import vibration_map
from model.show.style import save
from model.study.datasets import read_dataset


def run(data: Path, pictures: list[Path]) -> None:
    """Plot where the part aligns only with vibration, only without, in both ways and in neither."""
    save(vibration_map(read_dataset(data)), pictures[0].with_suffix(""))
