"""Compute a figure from the other start."""

from pathlib import Path
from typing import Any

from model.study.datasets import (
    compute_chunk,
    history_dataset,
    merge_chunks,
    outcome_counts,
    write_dataset,
)
from model.study.sweeps import Sweep


def run(sweep: Sweep, data: Path) -> dict[str, Any]:
    """Write the figure's dataset from that start."""
    title, start = f"{sweep.figure} from the other start", sweep.settings.start
    if sweep.dimensions:
        dataset = merge_chunks(sweep, title, start, [compute_chunk(sweep, 0, 1)])
    else:
        dataset = history_dataset(sweep, title, start)
    write_dataset(dataset, data)
    return {**sweep.facts, "counts": outcome_counts(dataset)}
