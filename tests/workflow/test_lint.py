"""Snakemake's own linter, which knows no option to leave a rule out."""

import re
import subprocess
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]


def test_the_linter_asks_for_nothing_but_an_environment_for_each_rule():
    run = subprocess.run(
        ["snakemake", "--lint"], cwd=PROJECT, check=False, capture_output=True, text=True
    )
    asked = re.findall(r"^    \* (.*?):?$", run.stdout + run.stderr, flags=re.MULTILINE)
    # All jobs run in the environment that `make` builds, or in its container.
    assert set(asked) == {"Specify a conda environment or container for each rule."}
