"""Compute a figure anew with fixed steps, and judge its points against the located ones."""

import argparse
from pathlib import Path

from model.study.datasets import read_dataset, write_dataset
from model.tracking.provenance import Job
from verification.fixed_steps import fixed_step_dataset
from verification.plans import FixedStepPlan


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=FixedStepPlan.model_validate_json)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("located", type=Path, help="the figure's dataset")
    arguments = parser.parse_args()
    plan: FixedStepPlan = arguments.plan
    job = Job("fixed_steps", plan.sweep.figure)
    dataset = fixed_step_dataset(plan, read_dataset(arguments.located))
    write_dataset(dataset, arguments.output)
    counts = {"trajectories": int(dataset["tau_align"].size)}
    made, read = [arguments.output], [arguments.located]
    job.finish(arguments.record, made, read, **plan.facts, counts=counts)


if __name__ == "__main__":
    main()
