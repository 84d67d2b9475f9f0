"""Assemble the map of the largest misalignment, computing what shows at its parts' borders."""

import argparse
from pathlib import Path

from model.study.datasets import write_dataset
from model.study.largest_misalignment import LimitPlan, limit_counts, limit_dataset
from model.study.map_parts import read_parts
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=LimitPlan.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--summary", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("parts", nargs="+", type=Path)
    arguments = parser.parse_args()
    plan = arguments.plan
    job = Job("limit", plan.name)
    known = read_parts(plan, arguments.parts)
    dataset = limit_dataset(plan, known, arguments.title, arguments.summary)
    write_dataset(dataset, arguments.output)
    made, counts = [arguments.output], limit_counts(known)
    job.finish(arguments.record, made, arguments.parts, **plan.facts, counts=counts)


if __name__ == "__main__":
    main()
