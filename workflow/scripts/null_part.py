"""Judge a part of the devices that are drawn at random."""

from pathlib import Path

from model.sweeps.io import write_dataset
from study.evidence.null import NullPlan, part_of
from study.tracking.records import recorded, snakemake

with recorded(snakemake, part=True):
    plan = NullPlan.model_validate(snakemake.params.plan)
    part = part_of(plan, int(snakemake.wildcards.part))
    write_dataset(part, Path(snakemake.output.data))
