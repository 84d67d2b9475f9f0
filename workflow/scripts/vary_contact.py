"""Compute a figure on bases of other stiffness and damping."""

import argparse
from pathlib import Path

from model.study.contact_stiffness import StiffnessPlan, stiffness_dataset
from model.study.datasets import outcome_counts, write_dataset
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=StiffnessPlan.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    plan: StiffnessPlan = arguments.plan
    job = Job("contact_stiffness", plan.figure)
    dataset = stiffness_dataset(plan, arguments.title)
    write_dataset(dataset, arguments.output)
    varied = [each.model_dump() for each in plan.variations]
    facts = {**plan.sweeps[0].facts, "sweep": plan.identity, "variations": varied}
    job.finish(arguments.record, [arguments.output], **facts, counts=outcome_counts(dataset))


if __name__ == "__main__":
    main()
