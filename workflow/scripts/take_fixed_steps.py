"""Compute a figure anew with fixed steps, and judge its points against the located ones."""

import argparse
from datetime import UTC, datetime
from pathlib import Path

from model.study.datasets import read_dataset, write_dataset
from model.study.fixed_steps import fixed_step_dataset
from model.study.plans import FixedStepPlan
from model.study.provenance import sidecar, write_json


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", required=True, type=FixedStepPlan.model_validate_json)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("located", type=Path, help="the figure's dataset")
    arguments = parser.parse_args()
    started, plan = datetime.now(UTC), arguments.plan
    dataset = fixed_step_dataset(plan, read_dataset(arguments.located))
    write_dataset(dataset, arguments.output)
    identity = {"figure": plan.sweep.figure, "sweep": plan.identity}
    counts = {"trajectories": int(dataset["tau_align"].size)}
    write_json(sidecar(started, arguments.output, identity, counts), arguments.record)


if __name__ == "__main__":
    main()
