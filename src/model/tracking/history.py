"""The history: records of all invocations of Snakemake, killed ones included."""

import fcntl
from collections.abc import Iterable, Sequence
from datetime import datetime
from pathlib import Path

from model.tracking.cluster import slurm_reasons
from model.tracking.records import (
    Record,
    TrackingError,
    iso,
    read_record,
    runs_without_sidecar,
    sidecars,
)


def history_folder(root: Path) -> Path:
    """Return the folder of a results root that holds its history."""
    return root / "history"


def invocation_records(root: Path) -> list[Record]:
    """Return the records of all invocations as on disk, oldest first."""
    records = [read_record(path) for path in history_folder(root).glob("*.json")]
    return sorted(records, key=lambda each: each["started_stamp"])


def is_running(root: Path, name: str) -> bool:
    """Return whether the process of an invocation still holds its lock."""
    path = history_folder(root) / f"{name}.lock"
    try:
        with path.open("r+", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except FileNotFoundError:
        return False
    return False


def completed(root: Path, record: Record, outcome: str, ended: datetime | None) -> Record:
    """Return ``record`` with its end: its sidecars, and its runs without a sidecar."""
    name, since = record["invocation"], record["started_stamp"]
    runs = [each for each in sidecars(root).values() if each.get("invocation") == name]
    idle = record.get("idle", False)
    failures = []
    if not idle and outcome not in ("running", "done"):
        reasons = slurm_reasons(root, record.get("snakemake_log"))
        failures = runs_without_sidecar(root, since, reasons)
    if not idle and outcome == "failed" and all(f["status"] == "interrupted" for f in failures):
        outcome = "interrupted"
    wall = round(ended.timestamp() - since, 3) if ended else None
    return {
        **record,
        "outcome": outcome,
        "ended": iso(ended) if ended else None,
        "wall_seconds": wall,
        "runs": sorted(runs, key=lambda each: (each["started"], each["run"])),
        "failures": failures,
    }


def load_history(root: Path) -> list[Record]:
    """Return all invocations recorded below a results root, oldest first.

    ``outcome`` is "done", "failed", "interrupted" or "running".

    Raises:
        TrackingError: a results root without a history, or a file that is no record.
    """
    if not history_folder(root).is_dir():
        raise TrackingError(
            f"{root}: holds no history of runs; build the study first, or name its results root"
        )
    history = []
    for record in invocation_records(root):
        if record["outcome"] == "running":
            lives = is_running(root, record["invocation"])
            record = completed(root, record, "running" if lives else "interrupted", None)
        history.append(record)
    return history


def find_invocation(history: Sequence[Record], name: str) -> Record:
    """Return the invocation of that name or beginning of a name; "last" is the latest.

    Raises:
        TrackingError: none, or more than one.
    """
    if name == "last" and history:
        return history[-1]
    found = [record for record in history if record["invocation"].startswith(name)]
    if len(found) == 1 and name:
        return found[0]
    what = f"is the beginning of {len(found)}" if found else "is no invocation"
    raise TrackingError(f"{name!r} {what}; vibralign runs --invocations lists them")


def select_invocations(
    history: Iterable[Record],
    *,
    outcome: str | None = None,
    since: str | None = None,
    until: str | None = None,
) -> list[Record]:
    """Return the invocations that ended with ``outcome`` and started between two moments.

    Both are included, and are as ``index.select_runs`` takes them.
    """
    return [
        each
        for each in history
        if outcome in (None, each["outcome"]) and within(each, since, until)
    ]


def within(record: Record, since: str | None, until: str | None) -> bool:
    """Return whether a record started between two moments, as ``select_runs`` takes them."""
    started = str(record["started"])
    return (since is None or started >= since) and (until is None or started[: len(until)] <= until)
