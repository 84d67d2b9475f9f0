"""Run every method on every hard case: outcomes and errors as data, CPU times beside them."""

from pathlib import Path
from typing import Any

from benchmarks.hard_cases import compile_batch, judge, methods_for, table_of, true_run
from benchmarks.plans import HardCasesPlan
from model.tracking.provenance import write_text


def run(plan: HardCasesPlan, data: Path, times: Path) -> dict[str, Any]:
    """Judge every method against the true solution of every case."""
    compile_batch(plan)
    judged = []
    for case in plan.spec.all_cases:
        truth = true_run(plan, case)
        judged += [judge(plan, case, method, truth) for method in methods_for(plan, case)]
    write_text(table_of(judged, times=False), data)
    write_text(table_of(judged, times=True), times)
    counts = {
        "trajectories": len(judged),
        "rhs_evaluations": sum(each.rhs_evaluations for each in judged),
    }
    settings = plan.settings.model_dump(mode="json")
    return {"sweep": plan.identity, "settings": settings, "counts": counts}
