"""Compute a figure on bases of other stiffness and damping."""

from pathlib import Path
from typing import Any

from model.study.contact_stiffness import StiffnessPlan, stiffness_dataset
from model.study.datasets import outcome_counts, write_dataset


def run(plan: StiffnessPlan, title: str, data: Path) -> dict[str, Any]:
    """Write the dataset over all bases."""
    dataset = stiffness_dataset(plan, title)
    write_dataset(dataset, data)
    varied = [each.model_dump() for each in plan.variations]
    facts = {**plan.sweeps[0].facts, "sweep": plan.identity, "variations": varied}
    return {**facts, "counts": outcome_counts(dataset)}
