"""Compare all methods on all cases: errors and evaluations as data, CPU times beside them."""

from pathlib import Path
from typing import Any

from benchmarks.methods import METHODS
from benchmarks.plans import PrecisionPlan
from benchmarks.work_precision import (
    Truth,
    measured,
    precision_dataset,
    timings_table,
    true_run,
)
from model.study.datasets import write_dataset
from model.tracking.provenance import write_text


def run(plan: PrecisionPlan, data: Path, times: Path) -> dict[str, Any]:
    """Run every method on every case with every setting."""
    truths = {case: true_run(plan, case) for case in plan.cases}
    settings = [
        each
        for case in plan.cases
        for method in METHODS
        for each in measured(plan, case, method, Truth.of(truths[case]))
    ]
    write_dataset(precision_dataset(plan, truths, settings), data)
    write_text(timings_table(settings), times)
    counts = {
        "trajectories": len(settings),
        "rhs_evaluations": sum(each.rhs_evaluations for each in settings),
    }
    stated = plan.settings.model_dump(mode="json")
    return {"sweep": plan.identity, "settings": stated, "counts": counts}
