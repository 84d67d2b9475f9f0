"""``python -m study verify``: what it prints, and its exit code."""

import json
import shutil
from pathlib import Path

from model.sweeps.io import read_dataset, write_dataset
from study import __main__ as cli

REFERENCE = Path(__file__).parents[2] / "reference"


def test_a_build_agrees_until_a_number_moves(capsys, tmp_path: Path) -> None:
    built = tmp_path / "data/fig06.nc"
    built.parent.mkdir()
    shutil.copy(REFERENCE / "fig06.nc", built)
    shutil.copy(REFERENCE / "claims.csv", tmp_path)
    given = ["verify", "--root", str(tmp_path), "--reference", str(REFERENCE), "--figure", "6"]
    assert cli.main(given) == cli.DONE
    assert "1 figures agree" in capsys.readouterr().out
    dataset = read_dataset(built)
    dataset["tau_align"] *= 1.01
    write_dataset(dataset, built)
    assert cli.main([*given, "--json"]) == cli.FAILED
    found = json.loads(capsys.readouterr().out)["findings"]
    assert [each["variable"] for each in found] == ["tau_align"]
