"""Compute a sweep as a whole: a trajectory, or jamming in the slot."""

from pathlib import Path

from model.sweeps.io import outcome_counts, write_dataset
from model.sweeps.sweep import Sweep, merge, run
from study.tracking.records import recorded, snakemake

with recorded(snakemake) as metadata:
    sweep = Sweep.model_validate(snakemake.params.sweep)
    # Not the title of the configuration: another one would make the dataset anew.
    title = f"{sweep.name} of the study of vibratory alignment"
    dataset = merge(sweep, title, [run(sweep)])
    write_dataset(dataset, Path(snakemake.output.data))
    metadata |= {**sweep.metadata, "counts": outcome_counts(dataset)}
