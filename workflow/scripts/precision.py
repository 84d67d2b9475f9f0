"""Compare all methods on all cases: errors and evaluations as data, CPU times beside them."""

from pathlib import Path

from benchmarks.methods import METHODS
from benchmarks.plans import PrecisionPlan
from benchmarks.work_precision import (
    Truth,
    measured,
    precision_dataset,
    timings_table,
    true_run,
)
from model.study.files import write_text
from model.study.io import write_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as metadata:
    plan = PrecisionPlan.model_validate(snakemake.params.plan)
    truths = {case: true_run(plan, case) for case in plan.cases}
    settings = [
        each
        for case in plan.cases
        for method in METHODS
        for each in measured(plan, case, method, Truth.of(truths[case]))
    ]
    write_dataset(precision_dataset(plan, truths, settings), Path(snakemake.output.data))
    write_text(timings_table(settings), Path(snakemake.output.times))
    metadata |= {"config_hash": plan.identity, "settings": plan.settings.model_dump(mode="json")}
    metadata["counts"] = {
        "trajectories": len(settings),
        "rhs_evaluations": sum(each.rhs_evaluations for each in settings),
    }
