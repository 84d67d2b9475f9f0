"""`make` builds the environment, and passes its options on to `snakemake`."""

import json
import re
import subprocess
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[2]


def test_make_builds_what_snakemake_builds(copy_of_built: Any, built: Any) -> None:
    fig05 = "tiny/data/fig05.nc"
    (copy_of_built.folder / fig05).unlink()
    run = copy_of_built.make(fig05)
    assert run.returncode == 0, run.stdout + run.stderr
    assert copy_of_built.sha256(fig05) == built.sha256(fig05)


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
