"""Assemble a stability map from its parts, computing what shows at their borders only."""

import argparse
import json
from pathlib import Path

from model.study.datasets import write_dataset
from model.study.map_datasets import map_counts, map_dataset
from model.study.map_parts import read_parts
from model.study.maps import MapPlan
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=MapPlan.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--summary", required=True)
    parser.add_argument("--marks", required=True, type=json.loads)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("parts", nargs="+", type=Path)
    arguments = parser.parse_args()
    plan = arguments.plan
    job = Job("map", plan.name)
    known = read_parts(plan, arguments.parts)
    dataset = map_dataset(plan, known, arguments.title, arguments.summary, arguments.marks)
    write_dataset(dataset, arguments.output)
    made, counts = [arguments.output], map_counts(dataset)
    job.finish(arguments.record, made, arguments.parts, **plan.facts, counts=counts)


if __name__ == "__main__":
    main()
