"""Snakemake's own linter."""

from typing import Any


def test_the_linter_asks_for_nothing(workspace: Any) -> None:
    run = workspace.forked("--lint")
    told = run.stdout + run.stderr
    assert run.returncode == 0, told
    assert "your workflow is in a good condition" in told
