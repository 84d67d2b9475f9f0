"""Merge the chunks of a figure's sweep into its dataset."""

from pathlib import Path

from model.sweeps.io import outcome_counts, read_chunks, write_dataset
from model.sweeps.sweep import Sweep, merge
from study.tracking.records import recorded, snakemake

with recorded(snakemake) as metadata:
    sweep = Sweep.model_validate(snakemake.params.sweep)
    files = [Path(file) for file in snakemake.input]
    chunks = read_chunks(files, sweep.name, sweep.identity)
    # Not the title of the configuration: another one would make the dataset anew.
    dataset = merge(sweep, f"{sweep.name} of the study of vibratory alignment", chunks)
    write_dataset(dataset, Path(snakemake.output.data))
    metadata |= {**sweep.metadata, "counts": outcome_counts(dataset)}
