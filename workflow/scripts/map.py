"""Assemble a map from its parts; nodes at the borders between parts are computed here."""

from pathlib import Path

from model.study.io import write_dataset
from model.study.maps.dataset import map_counts, map_dataset, read_parts
from model.study.maps.plan import MapPlan
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as metadata:
    plan = MapPlan.model_validate(snakemake.params.plan)
    nodes = read_parts(plan, [Path(file) for file in snakemake.input])
    title, marks = snakemake.params.title, snakemake.params.marks
    dataset = map_dataset(plan, nodes, title, marks)
    write_dataset(dataset, Path(snakemake.output.data))
    metadata |= {**plan.metadata, "counts": map_counts(dataset)}
