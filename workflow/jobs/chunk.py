"""Compute one chunk of a figure's sweep."""

from pathlib import Path
from typing import Any

from model.study.datasets import compute_chunk, outcome_counts, write_dataset
from model.study.sweeps import Sweep


def run(sweep: Sweep, chunk: int, chunks: int, data: Path) -> dict[str, Any]:
    """Compute every ``chunks``-th point of the sweep from number ``chunk`` on."""
    dataset = compute_chunk(sweep, chunk, chunks)
    write_dataset(dataset, data)
    return {**sweep.facts, "counts": outcome_counts(dataset)}
