"""Compute the map of the largest misalignment, with its sidecar."""

import argparse
from pathlib import Path

from model.study.datasets import write_dataset
from model.study.largest_misalignment import LimitPlan, limit_counts, limit_dataset, limit_map
from model.study.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=LimitPlan.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--summary", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    plan = arguments.plan
    job = Job("limit", plan.name)
    found = limit_map(plan)
    write_dataset(limit_dataset(found, arguments.title, arguments.summary), arguments.output)
    job.finish(arguments.record, [arguments.output], **plan.facts, counts=limit_counts(found))


if __name__ == "__main__":
    main()
