"""Commands where the packages of an extra are not installed."""

import sys
from pathlib import Path

import pytest

from vibralign.commands import main as cli

PEG = str(Path(__file__).parents[2] / "square" / "devices" / "peg.yaml")
PLANE = ["--x", "friction", "0.1", "0.2", "--y", "press_force", "1", "2"]


@pytest.mark.parametrize(
    ("module", "line", "words"),
    [
        ("scipy", ["design", "--device", PEG], "needs scipy, which is not installed: pip install"),
        ("scipy", ["map", *PLANE, "--out", "map.nc"], "map needs scipy, not installed"),
        ("matplotlib.backend_bases", ["simulate", "--plot", "run.png"], "vibralign[plot]"),
    ],
)
def test_a_package_that_is_missing_is_named_with_its_extra(
    monkeypatch, capsys, tmp_path, module, line, words
):
    monkeypatch.chdir(tmp_path)
    for using in ("vibralign.answers.yields", "vibralign.answers.design"):
        monkeypatch.delitem(sys.modules, using, raising=False)  # imported anew, without scipy
    monkeypatch.setitem(sys.modules, module, None)
    assert cli.main(line) == cli.REFUSED
    assert words in capsys.readouterr().err
