"""Compute one part of the map of the largest misalignment."""

from pathlib import Path
from typing import Any

from model.study.datasets import write_dataset
from model.study.largest_misalignment import LimitPlan, limit_counts
from model.study.map_parts import compute_part, part_dataset


def run(plan: LimitPlan, part: int, parts: int, data: Path) -> dict[str, Any]:
    """Compute part number ``part`` of ``parts``."""
    known = compute_part(plan, part, parts)
    write_dataset(part_dataset(plan, part, parts, known), data)
    return {**plan.facts, "counts": limit_counts(known)}
