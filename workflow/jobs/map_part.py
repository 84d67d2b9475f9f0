"""Compute one part of a map."""

from pathlib import Path
from typing import Any

from model.study.datasets import write_dataset
from model.study.largest_misalignment import LimitPlan, limit_counts
from model.study.map_parts import compute_part, part_dataset
from model.study.maps import MapPlan, part_counts


def run(plan: MapPlan | LimitPlan, part: int, parts: int, data: Path) -> dict[str, Any]:
    """Compute part number ``part`` of ``parts``."""
    known = compute_part(plan, part, parts)
    write_dataset(part_dataset(plan, part, parts, known), data)
    if isinstance(plan, LimitPlan):
        return {**plan.facts, "counts": limit_counts(known)}
    return {**plan.facts, "counts": part_counts(plan, known)}
