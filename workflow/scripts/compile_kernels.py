"""Compile the kernels into their cache, and say which ones they are."""

import argparse
from pathlib import Path

from model.runs.align import align
from model.study.config import baseline
from model.tracking.provenance import Job, closure_hash, write_json


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, required=True)
    parser.add_argument("--record", type=Path, required=True)
    arguments = parser.parse_args()
    job = Job("kernels")
    align([baseline()], horizon=0.1, cores=1)
    write_json({"kernels": closure_hash(Path(__file__))}, arguments.output)
    job.finish(arguments.record, [arguments.output])


if __name__ == "__main__":
    main()
