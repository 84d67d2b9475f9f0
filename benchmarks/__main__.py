"""Measure, print the table, keep it: ``python -m benchmarks [--quick]``."""

import argparse
import os
from pathlib import Path

# One core for all methods; libraries read this when they are imported.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

from benchmarks.machine import facts  # noqa: E402
from benchmarks.methods.peers import all_methods  # noqa: E402
from benchmarks.table import Row, compare, text, write  # noqa: E402
from benchmarks.trajectories import all_problems  # noqa: E402
from model.compile.cache import kernel_fingerprint  # noqa: E402

_PLAN = argparse.Namespace(points=40, neighbours=8, budget=20.0, rounds=5)
_QUICK = argparse.Namespace(points=10, neighbours=4, budget=8.0, rounds=3)


def _say(line: str) -> None:
    print(line, flush=True)


def main() -> None:
    """Run the benchmark that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a rough table within three minutes")
    parser.add_argument("--problems", nargs="*", metavar="NAME", help="W1, W2, W3, fig06, fig13")
    parser.add_argument("--output", type=Path, default=Path("results/benchmarks"))
    arguments = parser.parse_args()
    plan = _QUICK if arguments.quick else _PLAN
    methods = all_methods(_say)
    table: list[Row] = []
    for problem in all_problems(plan.points, plan.neighbours):
        if problem.name in (arguments.problems or [problem.name]):
            rows = compare(problem, methods, plan.budget, plan.rounds)
            _say(text(rows) + "\n")
            table += rows
    machine = {"quick": arguments.quick, "kernels": kernel_fingerprint()}
    machine |= facts([*(method.package for method in methods), "numpy", "numba"])
    write(table, machine, arguments.output)
    _say(f"kept in {arguments.output}")


if __name__ == "__main__":
    main()
