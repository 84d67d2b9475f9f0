"""Compute one part of a map."""

from pathlib import Path

from model.study.datasets import write_dataset
from model.study.map_parts import compute_part, part_dataset
from model.study.maps import MapPlan, part_counts
from model.tracking.job import recorded, snakemake

with recorded(snakemake, part=True) as facts:
    plan = MapPlan.model_validate(snakemake.params.plan)
    part, parts = int(snakemake.wildcards.chunk), snakemake.params.parts
    known = compute_part(plan, part, parts)
    write_dataset(part_dataset(plan, part, parts, known), Path(snakemake.output.data))
    facts |= {**plan.facts, "counts": part_counts(plan, known)}
