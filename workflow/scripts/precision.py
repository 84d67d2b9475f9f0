"""Run all cases at all tolerances: errors and evaluations as data, CPU times beside them."""

from pathlib import Path

from model.sweeps.files import write_text
from study.tracking.records import recorded, snakemake
from verification.bench.plans import PrecisionPlan
from verification.bench.work_precision import measured, table_of, true_run

with recorded(snakemake) as metadata:
    plan = PrecisionPlan.model_validate(snakemake.params.plan)
    settings = [each for case in plan.cases for each in measured(plan, case, true_run(plan, case))]
    write_text(table_of(settings, times=False), Path(snakemake.output.data))
    write_text(table_of(settings, times=True), Path(snakemake.output.times))
    metadata |= {"config_hash": plan.identity, "settings": plan.settings.model_dump(mode="json")}
    metadata["counts"] = {
        "trajectories": len(settings),
        "rhs_evaluations": sum(each.rhs_evaluations for each in settings),
    }
