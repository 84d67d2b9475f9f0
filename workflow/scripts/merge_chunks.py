"""Merge the chunks of a figure's sweep into its dataset, with its sidecar."""

import argparse
from pathlib import Path

from model.study.datasets import merge_chunks, outcome_counts, read_dataset, write_dataset
from model.study.provenance import Job
from model.study.sweeps import Sweep


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweep", required=True, type=Sweep.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--summary", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("chunks", nargs="+", type=Path)
    arguments = parser.parse_args()
    sweep = arguments.sweep
    job = Job("merge", sweep.figure)
    parts = [read_dataset(path) for path in arguments.chunks]
    dataset = merge_chunks(sweep, arguments.title, arguments.summary, parts)
    write_dataset(dataset, arguments.output)
    made, read, counts = [arguments.output], arguments.chunks, outcome_counts(dataset)
    job.finish(arguments.record, made, read, **sweep.facts, counts=counts)


if __name__ == "__main__":
    main()
