"""Judge the device of the study under other assumptions."""

from pathlib import Path

from model.sweeps.io import write_dataset
from study.evidence.assumptions import AssumptionsPlan, assumptions_dataset
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    plan = AssumptionsPlan.model_validate(snakemake.params.plan)
    write_dataset(assumptions_dataset(plan, snakemake.params.titles), Path(snakemake.output.data))
