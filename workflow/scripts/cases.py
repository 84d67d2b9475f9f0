"""Judge the device of the study under other assumptions and off by a little, and other devices."""

from pathlib import Path

from model.sweeps.io import write_dataset
from study.evidence.cases import CasesPlan, cases_dataset
from study.evidence.null import NullPlan, stored_null
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    null = stored_null(NullPlan.model_validate(snakemake.params.null))
    plan = CasesPlan.model_validate(snakemake.params.plan)
    write_dataset(cases_dataset(plan, null.counts), Path(snakemake.output.data))
