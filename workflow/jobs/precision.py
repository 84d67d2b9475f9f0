"""Compare all methods on all cases: errors and evaluations as data, CPU times beside them."""

from pathlib import Path
from typing import Any

from model.study.datasets import write_dataset
from model.tracking.provenance import write_text
from verification.plans import PrecisionPlan
from verification.work_precision import METHODS, climb, precision_dataset, timings_table, true_run


def run(plan: PrecisionPlan, data: Path, times: Path) -> dict[str, Any]:
    """Run every method on every case with every setting."""
    truths = {case: true_run(plan, case) for case in plan.cases}
    rungs = [
        rung
        for case in plan.cases
        for method in METHODS
        for rung in climb(plan, case, method, truths[case])
    ]
    write_dataset(precision_dataset(plan, truths, rungs), data)
    write_text(timings_table(rungs), times)
    counts = {
        "trajectories": len(rungs),
        "rhs_evaluations": sum(rung.rhs_evaluations for rung in rungs),
    }
    settings = plan.settings.model_dump(mode="json")
    return {"sweep": plan.identity, "settings": settings, "counts": counts}
