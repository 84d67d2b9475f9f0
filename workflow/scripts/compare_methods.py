"""Compare all methods on all cases: errors and evaluations as data, CPU times beside them."""

import argparse
from pathlib import Path

from model.study.datasets import write_dataset
from model.tracking.provenance import Job, write_text
from verification.plans import PrecisionPlan
from verification.work_precision import (
    METHODS,
    climb,
    precision_dataset,
    timings_table,
    true_run,
)


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=PrecisionPlan.model_validate_json)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--times", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    plan: PrecisionPlan = arguments.plan
    job = Job("precision")
    truths = {case: true_run(plan, case) for case in plan.cases}
    rungs = [
        rung
        for case in plan.cases
        for method in METHODS
        for rung in climb(plan, case, method, truths[case])
    ]
    write_dataset(precision_dataset(plan, truths, rungs), arguments.output)
    write_text(timings_table(rungs), arguments.times)
    counts = {
        "trajectories": len(rungs),
        "rhs_evaluations": sum(rung.rhs_evaluations for rung in rungs),
    }
    made = [arguments.output, arguments.times]
    settings = plan.settings.model_dump(mode="json")
    job.finish(arguments.record, made, sweep=plan.identity, settings=settings, counts=counts)


if __name__ == "__main__":
    main()
