"""Every figure is drawn as it was accepted: of the reference's dataset, its picture."""

from pathlib import Path

import pytest
from matplotlib.testing.compare import compare_images

from model.sweeps.io import read_dataset
from study import plots, schematics
from study.config import load_study, study_path
from vibralign.plots import style

REFERENCE = Path(__file__).resolve().parents[2] / "reference"
STUDY = load_study(study_path())
# Root mean square of the difference of the pixels, of 255. Here it is 0: fonts and renderer come
# with the pinned matplotlib.
TOLERANCE = 0.1


@pytest.mark.parametrize("name", sorted(STUDY.figures))
def test_a_figure_is_the_accepted_picture(name: str, tmp_path: Path) -> None:
    if name not in STUDY.computed:
        figure = schematics.DRAWINGS[name](STUDY.parameters(name))
    else:
        figure = plots.draw(read_dataset(REFERENCE / f"{name}.nc"))
    style.write(figure, tmp_path / f"{name}.png")
    told = compare_images(REFERENCE / f"{name}.png", tmp_path / f"{name}.png", TOLERANCE)
    assert told is None, told


def test_a_word_that_moves_is_seen(tmp_path: Path) -> None:
    figure = plots.draw(read_dataset(REFERENCE / "fig06.nc"))
    for height in (0.5, 0.505):  # three pixels apart
        figure.axes[0].yaxis.set_label_coords(-0.1, height)
        style.write(figure, tmp_path / f"{height}.png")
    assert compare_images(tmp_path / "0.5.png", tmp_path / "0.505.png", TOLERANCE) is not None
