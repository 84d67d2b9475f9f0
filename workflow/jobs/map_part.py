"""Compute one part of a map."""

from pathlib import Path
from typing import Any

from model.study.datasets import write_dataset
from model.study.map_parts import compute_part, part_dataset
from model.study.maps import MapPlan, part_counts


def run(plan: MapPlan, part: int, parts: int, data: Path) -> dict[str, Any]:
    """Compute part number ``part`` of ``parts``."""
    known = compute_part(plan, part, parts)
    write_dataset(part_dataset(plan, part, parts, known), data)
    return {**plan.facts, "counts": part_counts(plan, known)}
