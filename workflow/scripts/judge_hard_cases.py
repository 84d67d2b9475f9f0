"""Run every method on every hard case: marks, errors and evaluations as data, CPU times beside."""

import argparse
from pathlib import Path

from model.tracking.provenance import Job, write_text
from verification.hard_cases import compile_batch, judge, methods_for, table_of, true_run
from verification.plans import HardCasesPlan


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=HardCasesPlan.model_validate_json)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--times", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    plan: HardCasesPlan = arguments.plan
    job = Job("hard_cases")
    judged = []
    compile_batch(plan)
    for case in plan.spec.all_cases:
        truth = true_run(plan, case)
        judged += [judge(plan, case, method, truth) for method in methods_for(plan, case)]
    write_text(table_of(judged, times=False), arguments.output)
    write_text(table_of(judged, times=True), arguments.times)
    counts = {
        "trajectories": len(judged),
        "rhs_evaluations": sum(each.rhs_evaluations for each in judged),
    }
    made = [arguments.output, arguments.times]
    settings = plan.settings.model_dump(mode="json")
    job.finish(arguments.record, made, sweep=plan.identity, settings=settings, counts=counts)


if __name__ == "__main__":
    main()
