"""Draw the bands of the admissible sets behind the curves of Figs. 6 to 12."""

from pathlib import Path

from model.show.identification import band_curves
from model.show.style import save
from model.study.datasets import read_dataset
from model.study.identification.band_table import read_bands


def run(bands: Path, curves: list[Path], pictures: list[Path]) -> None:
    """Draw all figures in one picture."""
    figure = band_curves(read_bands(bands), [read_dataset(path) for path in curves])
    save(figure, pictures[0].with_suffix(""))
