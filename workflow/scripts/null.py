"""Draw random devices, judge them by the ledger, and store the verdicts beside the code."""

from pathlib import Path

from model.sweeps.files import write_text
from study.evidence.null import NullPlan, null_text
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    plan = NullPlan.model_validate(snakemake.params.plan)
    write_text(null_text(plan), Path(snakemake.output.stored))
