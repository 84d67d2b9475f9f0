"""Time of the whole study against its graph of jobs alone: ``python -m benchmarks.study``.

All run in fresh clones of the last commit with an empty cache of kernels: the study as it is, and
with empty jobs, which import what the job imports and make its files, so that what is left is
Snakemake and the start of processes. Stub jobs do not even import: Snakemake alone.
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from verification.methods import cpu_seconds

_ROOT = Path(__file__).resolve().parents[1]
_JOB = """#!{python}
import importlib, json, pathlib, sys
request, files = map(json.loads, sys.argv[2:])
{imports}
for made in (request["record"], *files["outputs"].values()):
    for each in [made] if isinstance(made, str) else made:
        if each:
            pathlib.Path(each).touch()
"""
_IMPORTS = """sys.path[0] = "workflow"
importlib.import_module("run")
importlib.import_module("jobs." + request["job"])"""
# The Python that every job starts in a run, by the run's name.
_RUNS = {
    "stub jobs": _JOB.format(python=f"{sys.executable} -IS", imports=""),
    "empty jobs": _JOB.format(python=sys.executable, imports=_IMPORTS),
    "study": "",
}


def seconds(folder: Path, snakemake: list[str], job: str) -> tuple[float, float]:
    """Return the time and the CPU time of a run in a clone in ``folder``, with ``job`` as Python.

    Raises:
        RuntimeError: the run failed, with the end of what it printed.
    """
    clone, tools = folder / "clone", Path(sys.executable).parent
    subprocess.run(["git", "clone", "--quiet", _ROOT, clone], check=True)
    if job:
        tools = folder / "tools"
        tools.mkdir()
        (tools / "python").write_text(job, encoding="utf-8")
        (tools / "python").chmod(0o755)
    surroundings = {
        **os.environ,
        "PATH": f"{tools}:{os.environ['PATH']}",
        "PYTHONPATH": f"{clone / 'src'}:{clone}",
        "VIBRALIGN_CACHE": str(folder / "cache"),
    }
    started, cpu_before = perf_counter(), cpu_seconds()
    command = [sys.executable, "-m", "snakemake", *snakemake]
    run = subprocess.run(
        command, cwd=clone, env=surroundings, capture_output=True, text=True, check=False
    )
    spent = perf_counter() - started, cpu_seconds() - cpu_before
    if run.returncode:
        raise RuntimeError(f"{' '.join(command)} failed\n{run.stderr[-3000:]}")
    return spent


def by_rule(results: Path) -> list[str]:
    """Return the jobs' seconds by rule, the longest first."""
    spent: dict[str, list[float]] = {}
    with (results / "runs.csv").open(encoding="utf-8", newline="") as table:
        for row in csv.DictReader(table):
            spent.setdefault(row["rule"], []).append(float(row["wall_seconds"] or 0.0))
    longest = sorted(spent.items(), key=lambda each: -sum(each[1]))
    return [f"{sum(each):8.1f} s  {rule} ({len(each)})" for rule, each in longest]


def main() -> None:
    """Print the times, and the ratio of the study to empty jobs."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study", description=__doc__)
    parser.add_argument("--cores", default="2")
    parser.add_argument("--smoke", action="store_true", help="the small study")
    arguments = parser.parse_args()
    snakemake = [f"-c{arguments.cores}"]
    if arguments.smoke:
        snakemake += ["--configfile", "config/smoke.yaml"]
    times = {}
    for name, job in _RUNS.items():
        with tempfile.TemporaryDirectory() as folder:
            times[name] = seconds(Path(folder), snakemake, job)
            if not job:
                results = Path(folder, "clone", "results-smoke" if arguments.smoke else "results")
                print("\n".join(by_rule(results)))
        print("{}: {:.0f} s, {:.0f} core-seconds".format(name, *times[name]), flush=True)
    ratios = [a / b for a, b in zip(times["study"], times["empty jobs"], strict=True)]
    print("ratio: {:.2f}, of core-seconds {:.2f}".format(*ratios))


if __name__ == "__main__":
    main()
