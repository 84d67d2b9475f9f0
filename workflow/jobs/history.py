"""Compute a figure's trajectory."""

from pathlib import Path
from typing import Any

from model.study.datasets import history_dataset, outcome_counts, write_dataset
from model.study.sweeps import Sweep


def run(sweep: Sweep, title: str, caption: str, data: Path) -> dict[str, Any]:
    """Write the trajectory as the figure's dataset."""
    dataset = history_dataset(sweep, title, caption)
    write_dataset(dataset, data)
    return {**sweep.facts, "counts": outcome_counts(dataset)}
