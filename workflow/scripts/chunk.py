"""Compute one chunk of a figure's sweep."""

from pathlib import Path

from model.sweeps.io import outcome_counts, write_dataset
from model.sweeps.sweep import Sweep, run
from study.tracking.records import recorded, snakemake

with recorded(snakemake, part=True) as metadata:
    sweep = Sweep.model_validate(snakemake.params.sweep)
    dataset = run(sweep, int(snakemake.wildcards.chunk), snakemake.params.chunks)
    write_dataset(dataset, Path(snakemake.output.data))
    metadata |= {**sweep.metadata, "counts": outcome_counts(dataset)}
