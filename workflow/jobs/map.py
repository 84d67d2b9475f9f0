"""Assemble a map from its parts, computing only what appears at their borders."""

from pathlib import Path
from typing import Any

from model.study.datasets import write_dataset
from model.study.map_datasets import Mark, map_counts, map_dataset
from model.study.map_parts import read_parts
from model.study.maps import MapPlan


def run(
    plan: MapPlan,
    title: str,
    caption: str,
    marks: list[Mark],
    parts: list[Path],
    data: Path,
) -> dict[str, Any]:
    """Write the map; ``marks`` are the operating points of other figures in it."""
    dataset = map_dataset(plan, read_parts(plan, parts), title, caption, marks)
    write_dataset(dataset, data)
    return {**plan.facts, "counts": map_counts(dataset)}
