"""Compute one part of a map."""

from pathlib import Path

from model.study.io import write_dataset
from model.study.maps.compute import compute_part
from model.study.maps.dataset import part_counts, part_dataset
from model.study.maps.plan import MapPlan
from model.tracking.job import recorded, snakemake

with recorded(snakemake, part=True) as metadata:
    plan = MapPlan.model_validate(snakemake.params.plan)
    part, parts = int(snakemake.wildcards.chunk), snakemake.params.parts
    nodes = compute_part(plan, part, parts)
    write_dataset(part_dataset(plan, part, parts, nodes), Path(snakemake.output.data))
    metadata |= {**plan.metadata, "counts": part_counts(nodes)}
