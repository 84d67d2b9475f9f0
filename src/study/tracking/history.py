"""The history of a results root: every start of Snakemake and every run, failed ones included.

    *.run.json            record of a run, beside its outputs (records.py)
    history/NUMBER.json   record of a start, with a copy of the records of its runs

Starts are numbered in their order, whatever the clock says. Only Snakemake's main process writes
the history, under the lock of the results root.
"""

from collections.abc import Mapping, Sequence
from datetime import datetime
from operator import itemgetter
from pathlib import Path

from model.sweeps.files import write_json
from study.tracking import TrackingError
from study.tracking.locks import is_running
from study.tracking.records import Record, iso, named, read_record, records

STATUS = ("done", "failed", "interrupted", "running")  # of a start; a run that runs has no record
_OF_START = {"start", "outcome", "started"}
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


def completed(
    root: Path,
    record: Record,
    outcome: str,
    ended: datetime | None,
    said: Mapping[str, str] | None = None,
) -> Record:
    """Return the record of a start with its outcome, its end, its runs and its failures.

    ``said`` are the words of a cluster on runs that failed, by name.
    """
    own = [each for each in records(root) if each["start"] == record["start"]]
    failures: list[Record] = []
    if outcome in ("failed", "interrupted"):
        whole = {each["run"] for each in own}
        failures = _without_record(root, record["start"], whole, said or {})
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
    """Return all starts recorded below a results root, in their order; ``outcome`` is a STATUS.

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
    for record in reversed(history):
        if name in ("last", str(record["start"])):
            return record
    raise TrackingError(f"{name!r} is no start; python -m study runs --starts lists them")


# --- Runs ---------------------------------------------------------------------------------------


def _without_record(
    root: Path, start: int, whole: set[str], said: Mapping[str, str]
) -> list[Record]:
    """Return the runs of a start that left no record: failed or interrupted.

    Snakemake deletes the outputs of a job before it starts and again when it fails; the log stays,
    and its first line names the start. Where a log says nothing, ``said`` counts.
    """
    logs = {run: ("", [words]) for run, words in said.items()}
    for path in (root / "logs").glob("**/*.log"):
        head, *lines = path.read_text(encoding="utf-8", errors="replace").splitlines() or [""]
        if head.startswith(f"start {start} "):
            run = path.relative_to(root / "logs").with_suffix("").as_posix()
            words = [line.strip() for line in lines if line.strip()]
            logs[run] = head.split()[2], words or logs.get(run, ("", words))[1]
    found = []
    for run in sorted(logs.keys() - whole):
        began, words = logs[run]
        status = "interrupted"
        reason = "ended without a message: it or Snakemake was killed, or the disk is full"
        if words and words[-1] != "KeyboardInterrupt":
            status, reason = "failed", words[-1]
        stated = {"start": start, "started": began, "status": status, "reason": reason}
        found.append({**named(run), **stated, "log": f"logs/{run}.log"})
    return found


def load_runs(root: Path) -> list[Record]:
    """Return all runs recorded below a results root, in the order of their starts.

    A run is its record with further keys: ``status``; ``current``, True for the last of its name;
    and for a failure the ``reason``.
    """
    runs: list[Record] = []
    for start in load_history(root):
        runs += [{**each, "status": "done"} for each in start["runs"]]
        runs += [{"git": start["git"], **each} for each in start["failures"]]
    last = {each["run"]: each["start"] for each in runs}
    found = [{**each, "current": last[each["run"]] == each["start"]} for each in runs]
    return sorted(found, key=_order)


def find_run(runs: Sequence[Record], name: str) -> Record:
    """Return the latest run called ``name``; "NAME@START" is that of a start."""
    run, _, start = name.partition("@")
    found = [each for each in runs if each["run"] == run and start in ("", str(each["start"]))]
    if not found:
        raise TrackingError(f"{name!r} is no run; python -m study runs lists them")
    return found[-1]
