"""Compute a figure's trajectory, with its sidecar."""

import argparse
from datetime import UTC, datetime
from pathlib import Path

from model.study.datasets import history_dataset, outcome_counts, write_dataset
from model.study.provenance import sidecar, write_json
from model.study.sweeps import Sweep


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweep", required=True, type=Sweep.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--summary", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    started, sweep = datetime.now(UTC), arguments.sweep
    dataset = history_dataset(sweep, arguments.title, arguments.summary)
    write_dataset(dataset, arguments.output)
    identity = {"figure": sweep.figure, "sweep": sweep.identity}
    record = sidecar(started, arguments.output, identity, outcome_counts(dataset))
    write_json(record, arguments.record)


if __name__ == "__main__":
    main()
