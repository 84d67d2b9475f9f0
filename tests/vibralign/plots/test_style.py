"""The style of figures: the same fonts on every machine."""

import shutil
from pathlib import Path

import matplotlib as mpl
from matplotlib import font_manager

from vibralign.plots import style


def test_fonts_are_those_of_matplotlib_whatever_the_machine_has(tmp_path, monkeypatch):
    """The font cache, as another program may leave it, has only the italics of the machine."""
    manager = font_manager.fontManager
    own = Path(mpl.get_data_path())
    machine = shutil.copy(own / "fonts/ttf/DejaVuSans-Oblique.ttf", tmp_path / "italic.ttf")
    monkeypatch.setattr(manager, "ttflist", [])
    manager.addfont(machine)
    style._prefer_own_fonts.cache_clear()
    with style.context():
        for face in ("DejaVu Sans", "DejaVu Sans:italic", "DejaVu Sans:bold", "cmsy10"):
            assert own in Path(font_manager.findfont(face)).parents
    style._prefer_own_fonts.cache_clear()
