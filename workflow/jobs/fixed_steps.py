"""Compute a figure with fixed steps, and compare its points with those of event location."""

from pathlib import Path
from typing import Any

from benchmarks.fixed_steps import fixed_step_dataset
from benchmarks.plans import FixedStepPlan
from model.study.datasets import read_dataset, write_dataset


def run(plan: FixedStepPlan, located: Path, data: Path) -> dict[str, Any]:
    """Write the comparison with the figure's dataset ``located``."""
    dataset = fixed_step_dataset(plan, read_dataset(located))
    write_dataset(dataset, data)
    return {**plan.facts, "counts": {"trajectories": int(dataset["tau_align"].size)}}
