"""Compute one chunk of a figure's sweep, with its sidecar."""

import argparse
from pathlib import Path

from model.study.datasets import compute_chunk, outcome_counts, write_dataset
from model.study.sweeps import Sweep
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweep", required=True, type=Sweep.model_validate_json)
    parser.add_argument("--chunk", required=True, type=int)
    parser.add_argument("--chunks", required=True, type=int)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    sweep = arguments.sweep
    job = Job("chunk", sweep.figure, arguments.chunk)
    dataset = compute_chunk(sweep, arguments.chunk, arguments.chunks)
    write_dataset(dataset, arguments.output)
    counts = outcome_counts(dataset)
    job.finish(arguments.record, [arguments.output], **sweep.facts, counts=counts)


if __name__ == "__main__":
    main()
