"""Compute a figure's trajectory, with its sidecar."""

import argparse
from pathlib import Path

from model.study.datasets import history_dataset, outcome_counts, write_dataset
from model.study.sweeps import Sweep
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweep", required=True, type=Sweep.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--summary", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    sweep = arguments.sweep
    job = Job("history", sweep.figure)
    dataset = history_dataset(sweep, arguments.title, arguments.summary)
    write_dataset(dataset, arguments.output)
    counts = outcome_counts(dataset)
    job.finish(arguments.record, [arguments.output], **sweep.facts, counts=counts)


if __name__ == "__main__":
    main()
