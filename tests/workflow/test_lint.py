"""Snakemake's own linter."""

import subprocess
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]


def test_the_linter_asks_for_nothing():
    run = subprocess.run(
        ["snakemake", "--lint"], cwd=PROJECT, check=False, capture_output=True, text=True
    )
    told = run.stdout + run.stderr
    assert run.returncode == 0, told
    assert "your workflow is in a good condition" in told
