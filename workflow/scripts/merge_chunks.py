"""Merge the chunks of a figure's sweep into its dataset, with its sidecar."""

import argparse
from pathlib import Path

import xarray as xr

from model.study.datasets import (
    DatasetError,
    discard,
    merge_chunks,
    outcome_counts,
    read_dataset,
    write_dataset,
)
from model.study.sweeps import Sweep
from model.tracking.provenance import Job


def read_chunks(sweep: Sweep, paths: list[Path]) -> list[xr.Dataset]:
    """The chunks of a sweep in order; what is not one is deleted, so that the next run makes it.

    Raises:
        DatasetError: a file that cannot be read, or that is not the chunk of its name.
    """
    parts, faults = [], {}
    for chunk, path in enumerate(paths):
        is_this = {"sweep": sweep.identity, "chunk": chunk, "chunks": len(paths)}
        try:
            part = read_dataset(path)
        except DatasetError as fault:
            faults[path] = str(fault)
        else:
            if any(part.attrs.get(name) != value for name, value in is_this.items()):
                faults[path] = f"{path}: is not chunk {chunk} of this sweep"
            parts.append(part)
    discard(faults)
    return parts


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
    parts = read_chunks(sweep, arguments.chunks)
    dataset = merge_chunks(sweep, arguments.title, arguments.summary, parts)
    write_dataset(dataset, arguments.output)
    made, read, counts = [arguments.output], arguments.chunks, outcome_counts(dataset)
    job.finish(arguments.record, made, read, **sweep.facts, counts=counts)


if __name__ == "__main__":
    main()
