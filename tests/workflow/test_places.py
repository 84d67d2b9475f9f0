"""The study builds in any folder, and by any call of Snakemake."""

import os
import subprocess
from pathlib import Path
from typing import Any

from study.tracking.history import load_history

ROOT = "Ergebnisse für 2026"


def test_it_builds_in_a_folder_of_any_name_without_activation_from_elsewhere(
    tmp_path: Path, make_workspace: Any, tiny: dict[str, Any]
) -> None:
    """`.venv/bin/snakemake --directory`, with no Python on the PATH and no folder for caches."""
    made = make_workspace(tmp_path / "vibrierte Körper")
    made.configure({**tiny, "results_root": ROOT})
    python = {name: os.environ[name] for name in ("HOME", "VIBRALIGN_CACHE") if name in os.environ}
    run = subprocess.run(
        [
            made.folder / ".venv/bin/snakemake",
            *("-c1", f"{ROOT}/figures/fig01.png", f"{ROOT}/data/kernels.json"),
            *("--directory", made.folder, "--snakefile", made.folder / "Snakefile"),
            *("--configfile", made.folder / "config/tiny.yaml"),
        ],
        cwd=tmp_path,
        env={**python, "PATH": "/usr/bin:/bin", "XDG_CACHE_HOME": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    root = made.folder / ROOT
    assert (root / "figures/fig01.png").is_file()
    (record,) = load_history(root)
    assert record["outcome"] == "done"
    assert {each["run"] for each in record["runs"]} == {"schematic/fig01", "kernels"}
    assert not [path for path in tmp_path.iterdir() if path != made.folder], "nothing beside it"
