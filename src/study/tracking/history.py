"""The history of a results root: every start of Snakemake and every run, failed ones included.

    *.run.json            record of a run, beside its outputs (records.py)
    history/NUMBER.json   record of a start, with a copy of the records of its runs

Starts are numbered in their order, whatever the clock says. Only Snakemake's main process writes
the history, under the lock of the results root.
"""

import shutil
from collections.abc import Mapping, Sequence
from datetime import datetime
from operator import itemgetter
from pathlib import Path

from model.sweeps.files import write_json
from study.tracking import TrackingError
from study.tracking.locks import is_running
from study.tracking.records import Record, iso, named, read_record, records
from study.tracking.slurm import slurm_reasons

RUN_STATUS = ("done", "failed", "interrupted")
_OF_START = {"start", "outcome", "started"}
_FULL = 1_000_000  # bytes: a disk with less free space counts as full
_order = itemgetter("start", "started", "run")


# --- Starts -------------------------------------------------------------------------------------


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


def end_of_killed(root: Path) -> None:
    """Record the end of starts that were killed, before their runs are replaced.

    Only a start that holds the lock of the root may call this.
    """
    for number in _numbers(root):
        record = read_record(start_file(root, number), _OF_START)
        if record["outcome"] == "running":
            write_json(completed(root, record, "interrupted", None), start_file(root, number))


def completed(root: Path, record: Record, outcome: str, ended: datetime | None) -> Record:
    """Return the record of a start with its outcome, its end, its runs and its failures."""
    own = [each for each in records(root) if each["start"] == record["start"]]
    failures: list[Record] = []
    if outcome in ("failed", "interrupted"):
        reasons = slurm_reasons(root, record.get("snakemake_log"))
        failures = runs_without_record(
            root, record["start"], reasons, {each["run"] for each in own}
        )
        if failures and all(each["status"] == "interrupted" for each in failures):
            outcome = "interrupted"
    seconds = ended and (ended - datetime.fromisoformat(record["started"])).total_seconds()
    return {
        **record,
        "outcome": outcome,
        "ended": ended and iso(ended),
        "wall_seconds": seconds and round(seconds, 3),
        "runs": sorted(own, key=_order),
        "failures": failures,
    }


def load_history(root: Path) -> list[Record]:
    """Return all starts recorded below a results root, in their order.

    ``outcome`` is "done", "failed", "interrupted" or "running".

    Raises:
        TrackingError: the results root has no history, or a file is no record.
    """
    if not (numbers := _numbers(root)):
        raise TrackingError(
            f"{root}: holds no history of runs; build the study first, or name its results root"
        )
    history = []
    for number in numbers:
        record = read_record(start_file(root, number), _OF_START)
        if record["outcome"] == "running":
            outcome = "running" if is_running(root, number) else "interrupted"
            record = completed(root, record, outcome, None)
        history.append(record)
    return history


def find_start(history: Sequence[Record], name: str) -> Record:
    """Return the start of a number; "last" is the latest."""
    if name == "last" and history:
        return history[-1]
    for record in history:
        if str(record["start"]) == name:
            return record
    raise TrackingError(f"{name!r} is no start; python -m study runs --starts lists them")


# --- Runs ---------------------------------------------------------------------------------------


def runs_without_record(
    root: Path, start: int, reasons: Mapping[str, str], whole: set[str]
) -> list[Record]:
    """Return the runs of a start that left no record: failed or interrupted.

    Snakemake deletes the outputs of a job before it starts and again when it fails; the log stays,
    and its first line names the start. ``reasons`` are those that Slurm gives, by name of the run.
    They count if the run left no log, or a log without a message.
    """
    logs: dict[str, list[str]] = {}
    for path in (root / "logs").glob("**/*.log"):
        head, *lines = path.read_text(encoding="utf-8", errors="replace").splitlines() or [""]
        if head.startswith(f"start {start} "):
            run = path.relative_to(root / "logs").with_suffix("").as_posix()
            logs[run] = [head.split()[2], *lines]
    found = []
    for run in sorted((logs.keys() | reasons.keys()) - whole):
        began, *lines = logs.get(run, [""])
        status, reason = _last_word(lines, root)
        if run in reasons and status == "interrupted":
            status, reason = "failed", reasons[run]
        stated = {"start": start, "started": began, "status": status, "reason": reason}
        found.append({**named(run), **stated, "log": f"logs/{run}.log"})
    return found


def _last_word(lines: Sequence[str], root: Path) -> tuple[str, str]:
    """Return (status, reason) of a run that left no record, from its log."""
    said = [line.strip() for line in lines if line.strip()]
    if said and said[-1] != "KeyboardInterrupt":
        return "failed", said[-1]
    free = shutil.disk_usage(root).free
    if not said and free < _FULL:  # a full disk has no room for a message either
        return "failed", f"ended without a message, with {free // 1000} kB left on the disk"
    return "interrupted", "ended without a message: it was killed, or Snakemake was"


def load_runs(root: Path) -> list[Record]:
    """Return all runs recorded below a results root, in the order of their starts.

    A run is its record with further keys: ``status``, one of RUN_STATUS; ``current``, True if its
    results are in place, or for the last failure of a run that has no results; and for a failure
    the ``reason``.
    """
    standing = {(each["run"], each["start"]): each for each in records(root)}
    runs = {key: {**each, "status": "done"} for key, each in standing.items()}
    for start in load_history(root):
        for each in start["runs"]:
            runs.setdefault((each["run"], each["start"]), {**each, "status": "done"})
        for each in start["failures"]:
            runs[each["run"], each["start"]] = {"git": start["git"], **each}
    whole = {run for run, _ in standing}
    last = {run: start for run, start in sorted(runs) if run not in whole}
    for (run, start), each in runs.items():
        failed_last = each["status"] != "done" and last.get(run) == start
        each["current"] = (run, start) in standing or failed_last
    return sorted(runs.values(), key=_order)


def find_run(runs: Sequence[Record], name: str) -> Record:
    """Return the latest run called ``name``; "NAME@START" is that of a start."""
    run, _, start = name.partition("@")
    found = [each for each in runs if each["run"] == run and start in ("", str(each["start"]))]
    if not found:
        raise TrackingError(f"{name!r} is no run; python -m study runs lists them")
    return found[-1]


def has_outcome(run: Record, outcome: str) -> bool:
    """Return whether a run or start ended so, or one of a run's trajectories did."""
    ended = run.get("status", run.get("outcome"))
    return bool(ended == outcome or run.get("counts", {}).get(outcome, 0))
