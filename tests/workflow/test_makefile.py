"""`make` builds the environment, and passes its options on to `snakemake`."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[2]


def test_make_builds_what_snakemake_builds(copy_of_built: Any, built: Any) -> None:
    fig05 = "tiny/data/fig05.nc"
    (copy_of_built.folder / fig05).unlink()
    run = copy_of_built.make(fig05)
    assert run.returncode == 0, run.stdout + run.stderr
    assert copy_of_built.sha256(fig05) == built.sha256(fig05)


NOTES = """
import os, pathlib, pytest
@pytest.mark.parametrize("n", range(4))
def test_of_it(n):
    pathlib.Path(f"{pathlib.Path(__file__).stem} {os.environ['PYTEST_XDIST_WORKER']}").touch()
"""


def test_each_file_of_tests_runs_in_one_process(tmp_path: Path) -> None:
    """So that what its tests share is made once."""
    told = ["make", "-n", "--old-file=environment", "unit", "CORES=2"]
    printed = subprocess.run(told, cwd=PROJECT, capture_output=True, text=True, check=True).stdout
    (options,) = re.findall(r'PATH".* pytest (.*)', printed)
    for name in ("test_a.py", "test_b.py"):
        (tmp_path / name).write_text(NOTES, encoding="utf-8")
    run = [sys.executable, "-m", "pytest", "-p", "xdist", "-c", os.devnull, *options.split()]
    bare = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    subprocess.run(
        [*run, "--rootdir=.", "."], cwd=tmp_path, env=bare, capture_output=True, check=True
    )
    assert len(list(tmp_path.glob("test_a gw*"))) == len(list(tmp_path.glob("test_b gw*"))) == 1


def test_fuzz_passes_sets_and_scene_to_the_configuration() -> None:
    told = subprocess.run(
        ["make", "-n", "fuzz", "SETS=7", "SCENE=insertion"],
        cwd=PROJECT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    (given,) = re.findall(r"--config accuracy='(\S+)'", told)
    assert json.loads(given) == {"fuzz": {"sets": 7, "scene": "insertion"}}


def test_only_the_page_on_the_results_is_in_git(tmp_path: Path) -> None:
    def ignored(name: str) -> bool:
        run = ["git", "-C", str(tmp_path), "check-ignore", "--quiet", name]
        return subprocess.run(run, check=False).returncode == 0

    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    (tmp_path / ".gitignore").write_bytes((PROJECT / ".gitignore").read_bytes())
    assert ignored("results/report.html")
    assert ignored("results-smoke/report.html")
    assert not ignored("results/README.md")
