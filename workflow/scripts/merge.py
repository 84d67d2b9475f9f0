"""Merge the chunks of a figure's sweep into its dataset."""

from pathlib import Path

from model.study.chunk_files import read_chunks
from model.study.datasets import merge_chunks, outcome_counts, write_dataset
from model.study.sweeps import Sweep
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as facts:
    sweep = Sweep.model_validate(snakemake.params.sweep)
    chunks = read_chunks(sweep, [Path(file) for file in snakemake.input])
    dataset = merge_chunks(sweep, **snakemake.params.words, parts=chunks)
    write_dataset(dataset, Path(snakemake.output.data))
    facts |= {**sweep.facts, "counts": outcome_counts(dataset)}
