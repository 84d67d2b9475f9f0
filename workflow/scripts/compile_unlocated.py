"""Compile the kernels of runs without located switches, and say which ones they are."""

import argparse
from pathlib import Path

from model.study.config import baseline
from model.tracking.provenance import Job, closure_hash, write_json
from verification import without_location


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, required=True)
    parser.add_argument("--record", type=Path, required=True)
    arguments = parser.parse_args()
    job = Job("unlocated_kernels")
    without_location.align([baseline()], "rk4", 0.1, horizon=0.1)
    problem = without_location.initial_value_problem(baseline())
    problem.rates(0.0, problem.start)
    problem.fall(0.0, problem.start)
    write_json({"kernels": closure_hash(Path(__file__))}, arguments.output)
    job.finish(arguments.record, [arguments.output])


if __name__ == "__main__":
    main()
