"""Judge the device of the study under other assumptions and off by a little, and other devices."""

from pathlib import Path

from model.sweeps.io import write_dataset
from study.evidence.cases import CasesPlan, cases_dataset
from study.tracking.job import recorded, snakemake

with recorded(snakemake):
    plan = CasesPlan.model_validate(snakemake.params.plan)
    write_dataset(cases_dataset(plan), Path(snakemake.output.data))
