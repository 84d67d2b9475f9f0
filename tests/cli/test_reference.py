"""``vibralign verify`` and ``accept``."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imsave

from model.cli import main as cli
from model.study.plans import sweep_of
from model.sweeps.io import read_dataset, write_dataset
from model.sweeps.sweep import merge, run


@pytest.fixture
def folders(small_study, tmp_path: Path) -> list[str]:
    """A build of Fig. 6, and the options that name it and its reference."""
    root = tmp_path / "results"
    sweep = sweep_of(small_study(5, 3), "fig06")
    dataset = merge(sweep, "t", [run(sweep)])
    write_dataset(dataset, root / "data/fig06.nc")
    (root / "figures").mkdir()
    imsave(root / "figures/fig06.png", np.ones((10, 10, 3)))
    return ["--root", str(root), "--reference", str(tmp_path / "reference"), "--figure", "6"]


def test_a_build_is_red_until_accepted_and_red_again_when_it_changes(capsys, folders) -> None:
    assert cli.main(["verify", *folders]) == cli.FAILED
    assert "has no reference: vibralign accept --figure fig06" in capsys.readouterr().out
    assert cli.main(["accept", *folders, "--reason", "the first reference"]) == cli.DONE
    capsys.readouterr()
    assert cli.main(["verify", *folders]) == cli.DONE
    assert "1 figures agree" in capsys.readouterr().out
    path = Path(folders[1]) / "data/fig06.nc"
    dataset = read_dataset(path)
    dataset["tau_align"] *= 1.01
    write_dataset(dataset, path)
    assert cli.main(["verify", *folders, "--json"]) == cli.FAILED
    found = json.loads(capsys.readouterr().out)["findings"]
    assert [each["variable"] for each in found] == ["tau_align"]
