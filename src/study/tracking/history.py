"""The history of a results root: every start of Snakemake and every run, failed ones included.

    *.run.json                record of a run, beside its outputs (records.py)
    history/NUMBER.json       record of a start
    history/NUMBER/RUN.json   record of a run of this start, whatever became of it

Starts are numbered in their order, whatever the clock says. Under the lock of the results root,
Snakemake's main process writes the record of a start, and each job that of its run.
"""

from operator import itemgetter
from pathlib import Path

from study.tracking import TrackingError
from study.tracking.locks import is_running
from study.tracking.records import Record, read_record

STATUS = ("done", "failed", "interrupted", "running")
_LOST = {"status": "interrupted", "reason": "ended without a message: it or Snakemake was killed"}


def start_file(root: Path, start: int) -> Path:
    """Return the path of the record of a start."""
    return root / "history" / f"{start}.json"


def _numbers(root: Path) -> list[int]:
    """Return the numbers of the recorded starts, in order."""
    paths = (root / "history").iterdir() if (root / "history").is_dir() else ()
    return sorted(
        int(path.stem) for path in paths if path.suffix == ".json" and path.stem.isdigit()
    )


def free_number(root: Path) -> int:
    """Return the number of the next start."""
    return max(_numbers(root), default=0) + 1


def load_start(root: Path, number: int) -> Record:
    """Return the record of a start with its ``runs`` and ``failures``; ``outcome`` is a STATUS.

    A start or a run that is recorded as running, and does not run, was killed.

    Raises:
        TrackingError: a file is no record.
    """
    record = read_record(start_file(root, number), {"start", "outcome", "started"})
    runs: list[Record] = []
    failures: list[Record] = []
    runs_on = record["outcome"] == "running" and is_running(root, number)
    for path in (root / "history" / str(number)).rglob("*.json"):
        run = read_record(path, {"run", "start", "started", "status"})
        if run["status"] == "running" and not runs_on:
            run |= _LOST
        (runs if run["status"] in ("done", "running") else failures).append(run)
    all_lost = failures and all(each["status"] == "interrupted" for each in failures)
    if not runs_on and (
        record["outcome"] == "running" or (record["outcome"] == "failed" and all_lost)
    ):
        record["outcome"] = "interrupted"
    in_order = itemgetter("started", "run")
    return {
        **record,
        "runs": sorted(runs, key=in_order),
        "failures": sorted(failures, key=in_order),
    }


def load_history(root: Path) -> list[Record]:
    """Return all starts recorded below a results root, in their order, each as ``load_start``.

    Raises:
        TrackingError: the results root has no history, or a file is no record.
    """
    if not (numbers := _numbers(root)):
        raise TrackingError(
            f"{root}: holds no history of runs; build the study first, or name its results root"
        )
    return [load_start(root, number) for number in numbers]


def load_runs(root: Path) -> list[Record]:
    """Return all runs recorded below a results root, in the order of their starts.

    A run is its record with ``status``, for a failure its ``reason``, and ``current``, True for the
    last of its name.
    """
    runs = [run for start in load_history(root) for run in (*start["runs"], *start["failures"])]
    last = {each["run"]: each["start"] for each in runs}
    return [{**each, "current": last[each["run"]] == each["start"]} for each in runs]


def find(root: Path, name: str) -> Record:
    """Return a start or a run by its name.

    A start is called by its number, or "last"; the latest run of a name by this, and that of start
    12 by NAME@12.

    Raises:
        TrackingError: there is none; or as ``load_history``.
    """
    run, _, start = name.partition("@")
    found = [each for each in load_history(root) if name in ("last", str(each["start"]))] or [
        each for each in load_runs(root) if each["run"] == run and start in ("", str(each["start"]))
    ]
    if not found:
        raise TrackingError(
            f"{name!r} is neither a run nor a start; python -m study runs lists them"
        )
    return found[-1]
