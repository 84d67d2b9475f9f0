"""The history of the study: every invocation of Snakemake and every run, failed ones included.

Files are the tracker, below the results root:

    *.run.json                      a sidecar beside what each job made (job.py writes it)
    history/INVOCATION.json         one record an invocation of Snakemake, failed ones included
    history/data/SHA256.nc          every figure's dataset that an invocation ended with, kept once
    runs.csv                        the index of all runs, made from the files above

A run is one job that one invocation started; its name is that of its log: "chunk/fig06/0". Only
Snakemake's own process writes the history, so that nothing is written twice at the same time.
"""

import fcntl
import json
import re
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from model.tracking import TrackingError
from model.tracking.job import file_hash
from model.tracking.slurm import slurm_reasons

Record = dict[str, Any]

_ESSENTIAL = {"run", "rule", "started", "outputs"}  # what every sidecar has
_KEPT = re.compile(r"data/fig\d\d\.nc|claims\.csv")  # below the root: what copies are kept of
_FULL = 1_000_000  # bytes: less than this is a full disk


def read_record(path: Path) -> Record:
    """Read a sidecar or the record of an invocation.

    Raises:
        TrackingError: a file that is no record.
    """
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise TrackingError(f"{path}: cannot be read as a record ({error}): delete it") from None


def iso(moment: datetime) -> str:
    """Return a moment as every record states it: ISO 8601, in milliseconds."""
    return moment.isoformat(timespec="milliseconds")


# --- Sidecars -----------------------------------------------------------------------------------


def _files(root: Path, pattern: str) -> list[Path]:
    """Return the files of results that match, in order; not those of a results root within."""
    within = (history.parent for history in root.glob("*/**/history"))
    apart = (root / "history", root / "logs", *within)
    found = (path for path in root.rglob(pattern) if not any(map(path.is_relative_to, apart)))
    return sorted(found)


def sidecars(root: Path) -> dict[Path, Record]:
    """Read the sidecars below a results root, by their paths.

    Each gets its ``folder``, from which its outputs are named, relative to the root. Those of an
    earlier layout are left out.

    Raises:
        TrackingError: a file that is no record.
    """
    records = {path: read_record(path) for path in _files(root, "*.run.json")}
    return {
        path: {**record, "folder": path.parent.relative_to(root).as_posix()}
        for path, record in records.items()
        if set(record) >= _ESSENTIAL
    }


def kept_outputs(record: Record) -> dict[str, str]:
    """Return the outputs of a run that copies are kept of: figures' datasets, and verdicts."""
    return {
        name: sha256
        for name, sha256 in record["outputs"].items()
        if _KEPT.fullmatch(Path(record["folder"], name).as_posix())
    }


def kept_result(root: Path, name: str, sha256: str) -> Path:
    """Return where an output of that name and content is kept."""
    return root / "history" / "data" / f"{sha256}{Path(name).suffix}"


def discard_damaged(root: Path) -> list[str]:
    """Delete damaged results, so that Snakemake makes them anew; return their names.

    Damaged are files whose hash differs from their sidecar's, sidecars that cannot be read, and
    partial files of killed jobs. No job may run meanwhile.
    """
    damaged = _files(root, ".*.part")
    for path in _files(root, "*.run.json"):
        try:
            outputs = read_record(path).get("outputs", {})
        except TrackingError:
            damaged.append(path)
            continue
        made = {path.parent / name: sha256 for name, sha256 in outputs.items()}
        wrong = [file for file, sha in made.items() if file.is_file() and file_hash(file) != sha]
        damaged += [*wrong, path] if wrong else []
    for path in damaged:
        path.unlink(missing_ok=True)
    return [str(path) for path in damaged]


# --- Runs that left no sidecar ------------------------------------------------------------------


def runs_without_sidecar(root: Path, since: float, reasons: Mapping[str, str]) -> list[Record]:
    """Return the runs that began after the time stamp ``since`` and left a log, but no sidecar.

    Snakemake deletes the outputs of a job before it starts, and again when it fails; the log stays.
    ``reasons``, by the names of runs, are taken where a run's own log is silent, or it never began.
    """
    logs = {
        log.relative_to(root / "logs").with_suffix("").as_posix(): log
        for log in (root / "logs").glob("**/*.log")
        if log.stat().st_mtime >= since
    }
    whole = {record["run"] for record in sidecars(root).values()}
    found = []
    for run in sorted((logs.keys() | reasons.keys()) - whole):
        status, reason = _last_word(logs[run]) if run in logs else ("interrupted", "")
        if run in reasons and status == "interrupted":
            status, reason = "failed", reasons[run]
        began = logs[run].stat().st_mtime if run in logs else time.time()
        found.append(
            {
                "run": run,
                "rule": run.split("/", maxsplit=1)[0],
                "figure": next((part for part in run.split("/") if part.startswith("fig")), None),
                "status": status,
                "reason": reason,
                "log": f"logs/{run}.log",
                "started": iso(datetime.fromtimestamp(began, UTC)),
            }
        )
    return found


def _last_word(log: Path) -> tuple[str, str]:
    """Return (status, reason) of a run that left no sidecar, from its log."""
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    if lines and lines[-1] != "KeyboardInterrupt":
        return "failed", lines[-1].strip()
    free = shutil.disk_usage(log.parent).free
    if not lines and free < _FULL:  # then there was no room for a message either
        return "failed", f"ended without a message, with {free // 1000} kB left on the disk"
    return "interrupted", "ended without a message: it was killed, or Snakemake was"


# --- Invocations --------------------------------------------------------------------------------


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
        reasons = {**record.get("silent", {}), **slurm_reasons(root, record.get("snakemake_log"))}
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

    Both are included, and are as ``runs.select_runs`` takes them.
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
