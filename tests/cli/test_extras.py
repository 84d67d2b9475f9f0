"""Commands where the packages of an extra are not installed."""

import sys
from pathlib import Path

from model.cli import main as cli

PEG = Path(__file__).parents[2] / "docs" / "devices" / "peg.yaml"


def test_a_package_that_is_missing_is_named_with_its_extra(monkeypatch, capsys):
    for module in ("model.study.assessment.yields", "model.study.design"):
        monkeypatch.delitem(sys.modules, module, raising=False)  # imported anew, without scipy
    monkeypatch.setitem(sys.modules, "scipy", None)
    assert cli.main(["design", "--device", str(PEG)]) == cli.REFUSED
    assert "needs scipy, which is not installed: pip install" in capsys.readouterr().err
