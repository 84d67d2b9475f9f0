"""Run every method on every hard case: outcomes and errors as data, CPU times beside them."""

from pathlib import Path

from benchmarks.hard_cases import compile_batch, judge, methods_for, table_of, true_run
from benchmarks.plans import HardCasesPlan
from model.sweeps.files import write_text
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as metadata:
    plan = HardCasesPlan.model_validate(snakemake.params.plan)
    compile_batch(plan)
    judged = []
    for case in plan.spec.all_cases:
        truth = true_run(plan, case)
        judged += [judge(plan, case, method, truth) for method in methods_for(plan, case)]
    write_text(table_of(judged, times=False), Path(snakemake.output.data))
    write_text(table_of(judged, times=True), Path(snakemake.output.times))
    metadata |= {"config_hash": plan.identity, "settings": plan.settings.model_dump(mode="json")}
    metadata["counts"] = {
        "trajectories": len(judged),
        "rhs_evaluations": sum(each.rhs_evaluations for each in judged),
    }
