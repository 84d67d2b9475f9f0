"""Judge the device of the study under other assumptions and off by a little, and other devices."""

from pathlib import Path

from model.sweeps.io import write_dataset
from study.evidence.cases import CasesPlan, cases_dataset
from study.evidence.null import NullPlan, check_physics, stored_null
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    null_plan = NullPlan.model_validate(snakemake.params.null)
    null = stored_null(null_plan)
    check_physics(null_plan, null)
    plan = CasesPlan.model_validate(snakemake.params.plan)
    write_dataset(cases_dataset(plan, null.counts), Path(snakemake.output.data))
