"""Compute a figure with fixed steps, and compare its points with those of event location."""

from pathlib import Path

from benchmarks.fixed_steps import fixed_step_dataset
from benchmarks.plans import FixedStepPlan
from model.study.io import read_dataset, write_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as metadata:
    plan = FixedStepPlan.model_validate(snakemake.params.plan)
    dataset = fixed_step_dataset(plan, read_dataset(Path(snakemake.input.located)))
    write_dataset(dataset, Path(snakemake.output.data))
    metadata |= {**plan.metadata, "counts": {"trajectories": int(dataset["tau_align"].size)}}
