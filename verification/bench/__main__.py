"""Measure, print the table, keep it: ``python -m verification.bench [--quick]``."""

import argparse
import os
from pathlib import Path

# One core for all methods; libraries read this when they are imported.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

from verification.bench.methods.peers import all_methods  # noqa: E402
from verification.bench.table import Row, compare, text, write  # noqa: E402
from verification.bench.trajectories import all_problems  # noqa: E402

# Points of a figure, neighbours of a trajectory, CPU seconds of a ladder, rounds of timing.
_PLAN = 40, 8, 20.0, 5
_QUICK = 10, 4, 8.0, 3


def _say(line: str) -> None:
    print(line, flush=True)


def main() -> None:
    """Run the benchmark that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m verification.bench", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a rough table within three minutes")
    arguments = parser.parse_args()
    points, neighbours, budget, rounds = _QUICK if arguments.quick else _PLAN
    methods, folder = all_methods(_say), Path("results/benchmarks")
    table: list[Row] = []
    for problem in all_problems(points, neighbours):
        rows = compare(problem, methods, budget, rounds)
        _say(text(rows) + "\n")
        table += rows
    write(table, folder)
    _say(f"kept in {folder}")


if __name__ == "__main__":
    main()
