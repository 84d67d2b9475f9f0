"""Compute the runs of the claims ledger that no figure has."""

from collections import Counter
from pathlib import Path

from model.sweeps.io import outcome_counts, write_dataset
from model.sweeps.sweep import Sweep, merge, run
from study.tracking.records import recorded, snakemake

with recorded(snakemake) as metadata:
    counts = Counter[str]()
    for (name, plan), file in zip(
        snakemake.params.sweeps.items(), snakemake.output.data, strict=True
    ):
        sweep, title = Sweep.model_validate(plan), snakemake.params.titles[name]
        dataset = merge(sweep, title, [run(sweep)])
        write_dataset(dataset, Path(file))
        counts.update(outcome_counts(dataset))
    metadata["counts"] = dict(counts)
