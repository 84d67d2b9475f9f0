"""Compute one chunk of the first samples that searches start from."""

import argparse
from pathlib import Path

from model.study.config import Pool
from model.study.datasets import write_dataset
from model.study.identification.candidate import Space
from model.study.identification.results import samples_dataset, search_of
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--space", required=True, type=Space.model_validate_json)
    parser.add_argument("--pool", required=True, type=Pool.model_validate_json)
    parser.add_argument("--chunk", required=True, type=int)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    space, job = arguments.space, Job("identify_sample", arguments.chunk)
    search = search_of(space)
    samples = search.sample(arguments.pool, arguments.chunk)
    write_dataset(samples_dataset(search, samples), arguments.output)
    job.finish(arguments.record, [arguments.output], sweep=space.identity)


if __name__ == "__main__":
    main()
