"""Follow parts into the slot, over friction, clearance and tilt at entry."""

from pathlib import Path
from typing import Any

from model.study.datasets import outcome_counts, write_dataset
from model.study.jamming import jamming_dataset
from model.study.sweeps import Sweep


def run(sweep: Sweep, title: str, data: Path) -> dict[str, Any]:
    """Write the dataset."""
    dataset = jamming_dataset(sweep, title)
    write_dataset(dataset, data)
    return {**sweep.facts, "counts": outcome_counts(dataset)}
