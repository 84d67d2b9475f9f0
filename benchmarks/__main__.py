"""Measure, print the table, keep it: ``python -m benchmarks [--quick | --maps]``."""

import argparse
import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

# One core for everybody, settled before any of their libraries is imported.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

from benchmarks import maps  # noqa: E402
from benchmarks.equal_error import Cost, Setting, cheapest, find_setting, time_in_turn  # noqa: E402
from benchmarks.machine import facts  # noqa: E402
from benchmarks.methods.peers import all_methods  # noqa: E402
from benchmarks.problems import Problem  # noqa: E402
from benchmarks.table import rows, text, write  # noqa: E402
from benchmarks.trajectories import all_problems  # noqa: E402
from model.compile.cache import kernel_fingerprint  # noqa: E402

_PLAN = argparse.Namespace(
    points=40, neighbours=8, targets=(1e-5, 1e-8), budget=8.0, rounds=5,
    map_cells=1024, map_finest=4096,
)  # fmt: skip
_QUICK = argparse.Namespace(
    points=10, neighbours=4, targets=(1e-8,), budget=2.0, rounds=3,
    map_cells=128, map_finest=256,
)  # fmt: skip


def _say(line: str) -> None:
    print(line, flush=True)


def compare(
    problems: list[Problem], plan: argparse.Namespace, only: str, say: Callable[[str], None]
) -> tuple[list[Cost], list[Setting], list[str]]:
    """(costs, settings not reached, packages) of every method on every problem."""
    methods = [method for method in all_methods(say) if only in method.name]
    costs: list[Cost] = []
    missed: list[Setting] = []
    for problem in problems:
        for target in plan.targets:
            started = perf_counter()
            settings = [find_setting(method, problem, target, plan.budget) for method in methods]
            reached = [setting for setting in settings if not math.isnan(setting.tolerance)]
            missed += [setting for setting in settings if math.isnan(setting.tolerance)]
            costs += time_in_turn(reached, plan.rounds)
            say(f"{problem.name} at {target:g}: {perf_counter() - started:.0f} s")
    return cheapest(costs), missed, [method.package for method in methods]


def _report_maps(plan: argparse.Namespace, folder: Path) -> None:
    measured = maps.report(plan.map_cells, plan.map_finest, _say)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "maps.json").write_text(json.dumps(measured, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a rough table within three minutes")
    parser.add_argument("--only", default="", metavar="TEXT", help="methods with this in the name")
    parser.add_argument("--problems", nargs="*", metavar="NAME", help="W1, W2, W3, fig06, fig13")
    parser.add_argument("--output", type=Path, default=Path("results/benchmarks"))
    parser.add_argument("--maps", action="store_true", help="maps against full grids, no more")
    arguments = parser.parse_args()
    plan = _QUICK if arguments.quick else _PLAN
    if arguments.maps:
        _report_maps(plan, arguments.output)
        return

    problems = all_problems(plan.points, plan.neighbours)
    wanted = arguments.problems or [problem.name for problem in problems]
    problems = [problem for problem in problems if problem.name in wanted]
    costs, missed, packages = compare(problems, plan, arguments.only, _say)
    machine = {"quick": arguments.quick, "kernels": kernel_fingerprint()}
    machine |= facts([*packages, "numpy", "numba"])
    table = rows(
        costs, missed, [(problem.name, target) for problem in problems for target in plan.targets]
    )
    write(table, machine, arguments.output)
    _say("\n" + text(table) + "\n")
    _report_maps(plan, arguments.output)
    _say(f"kept in {arguments.output}")


if __name__ == "__main__":
    main()
