"""Compute one chunk of a figure's sweep, with its sidecar."""

import argparse
from datetime import UTC, datetime
from pathlib import Path

from model.study.datasets import compute_chunk, outcome_counts, write_dataset
from model.study.provenance import sidecar, write_json
from model.study.sweeps import Sweep


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweep", required=True, type=Sweep.model_validate_json)
    parser.add_argument("--chunk", required=True, type=int)
    parser.add_argument("--chunks", required=True, type=int)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    started, sweep = datetime.now(UTC), arguments.sweep
    dataset = compute_chunk(sweep, arguments.chunk, arguments.chunks)
    write_dataset(dataset, arguments.output)
    identity = {"figure": sweep.figure, "chunk": arguments.chunk, "sweep": sweep.identity}
    record = sidecar(started, arguments.output, identity, outcome_counts(dataset))
    write_json(record, arguments.record)


if __name__ == "__main__":
    main()
