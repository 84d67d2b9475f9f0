"""Run one chunk of an accuracy trial."""

from pathlib import Path
from typing import Any

from verification.accuracy import run_trial, write_table
from verification.trials import Trial


def run(trial: Trial, chunk: int, chunks: int, table: Path) -> dict[str, Any]:
    """Write the table of the chunk's sets."""
    found = run_trial(trial, chunk, chunks)
    write_table(found, table)
    return {**trial.facts, "counts": {"trajectories": int(found["set"].size)}}
