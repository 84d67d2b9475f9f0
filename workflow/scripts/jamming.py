"""Follow parts into the slot, over friction, clearance and tilt at entry."""

from pathlib import Path

from model.study.datasets import outcome_counts, write_dataset
from model.study.jamming import jamming_dataset
from model.study.sweeps import Sweep
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as facts:
    sweep = Sweep.model_validate(snakemake.params.sweep)
    dataset = jamming_dataset(sweep, snakemake.params.title)
    write_dataset(dataset, Path(snakemake.output.data))
    facts |= {**sweep.facts, "counts": outcome_counts(dataset)}
