"""Merge the verdicts on random devices into one dataset."""

from pathlib import Path

from model.sweeps.io import read_dataset, write_dataset
from study.evidence.null import NullPlan, merged
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    plans = {kind: NullPlan.model_validate(each) for kind, each in snakemake.params.plans.items()}
    parts = [read_dataset(Path(file)) for file in snakemake.input]
    write_dataset(merged(plans, snakemake.params.titles, parts), Path(snakemake.output.data))
