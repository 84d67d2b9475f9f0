"""Compute a figure's trajectory."""

from pathlib import Path

from model.study.datasets import history_dataset, outcome_counts, write_dataset
from model.study.sweeps import Sweep
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as facts:
    sweep = Sweep.model_validate(snakemake.params.sweep)
    dataset = history_dataset(sweep, **snakemake.params.words)
    write_dataset(dataset, Path(snakemake.output.data))
    facts |= {**sweep.facts, "counts": outcome_counts(dataset)}
