"""Compute one part of a stability map, with its sidecar."""

import argparse
from pathlib import Path

from model.study.datasets import write_dataset
from model.study.map_parts import compute_part, part_dataset
from model.study.maps import MapPlan, part_counts
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=MapPlan.model_validate_json)
    parser.add_argument("--part", required=True, type=int)
    parser.add_argument("--parts", required=True, type=int)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    plan = arguments.plan
    job = Job("map_part", plan.name, arguments.part)
    known = compute_part(plan, arguments.part, arguments.parts)
    dataset = part_dataset(plan, arguments.part, arguments.parts, known)
    write_dataset(dataset, arguments.output)
    counts = part_counts(plan, known)
    job.finish(arguments.record, [arguments.output], **plan.facts, counts=counts)


if __name__ == "__main__":
    main()
