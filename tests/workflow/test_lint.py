"""Snakemake's own linter."""

from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[2]


def test_the_linter_asks_for_nothing(workspace: Any) -> None:
    run = workspace.forked("--lint")
    told = run.stdout + run.stderr
    assert run.returncode == 0, told
    assert "your workflow is in a good condition" in told


def test_the_workflow_knows_no_device_of_a_file() -> None:
    files = [path for path in (PROJECT / "workflow").rglob("*") if path.suffix in (".py", ".smk")]
    assert len(files) > 20
    assert not [
        path.name for path in files if "vibralign.device" in path.read_text(encoding="utf-8")
    ]
