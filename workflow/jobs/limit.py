"""Assemble the map of the largest misalignment, computing only what appears at parts' borders."""

from pathlib import Path
from typing import Any

from model.study.datasets import write_dataset
from model.study.largest_misalignment import LimitPlan, limit_counts, limit_dataset
from model.study.map_parts import read_parts


def run(plan: LimitPlan, title: str, caption: str, parts: list[Path], data: Path) -> dict[str, Any]:
    """Write the map."""
    known = read_parts(plan, parts)
    write_dataset(limit_dataset(plan, known, title, caption), data)
    return {**plan.facts, "counts": limit_counts(known)}
