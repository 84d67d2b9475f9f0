"""The history of the study: every invocation of Snakemake and every run, failed ones included.

It consists of files below the results root:

    *.run.json                      sidecar beside the outputs of a job (job.py writes it)
    history/INVOCATION.json         record of an invocation of Snakemake
    runs.csv                        index of all runs, made from the files above

A run is one job of one invocation. Its name is the path of its log below logs/: "chunk/fig06/0".
Only Snakemake's main process writes the history, so that no two processes write it at once.
"""

import fcntl
import fnmatch
import json
import os
import shutil
import time
from collections.abc import Mapping, Sequence, Set
from datetime import UTC, datetime
from operator import itemgetter
from pathlib import Path
from typing import Any

from model.sweeps.files import write_text
from study.csv_tables import csv_text
from study.tracking import TrackingError
from study.tracking.job import file_hash, named
from study.tracking.slurm import slurm_reasons

Record = dict[str, Any]

RUN_STATUS = ("done", "failed", "interrupted")
COUNTS = (
    "trajectories", "aligned", "settled", "left_scene", "horizon_reached", "failed", "sensitive",
    "rhs_evaluations",
)  # fmt: skip
COLUMNS = (
    "run", "rule", "figure", "status", "current", "started", "wall_seconds", "invocation", "commit",
    "dirty", "code", "config_hash", "outputs", *(f"runs_{name}" for name in COUNTS), "host",
    "reason",
)  # fmt: skip
_ESSENTIAL = {"run", "rule", "started", "outputs"}  # keys of every sidecar
_OF_INVOCATION = {"invocation", "outcome", "started", "started_stamp"}
_identity, _place_in_time = itemgetter("run", "started"), itemgetter("started", "run")
_FULL = 1_000_000  # bytes: a disk with less free space counts as full


def read_record(path: Path, keys: Set[str] = frozenset()) -> Record:
    """Read a sidecar or the record of an invocation.

    Raises:
        TrackingError: the file is no record with these ``keys``.
    """
    try:
        record = {**json.loads(path.read_text(encoding="utf-8"))}
        if missing := keys - set(record):
            raise ValueError(f"without {', '.join(sorted(missing))}")  # noqa: TRY301 - see below
    except (OSError, ValueError, TypeError) as error:
        raise TrackingError(f"{path}: cannot be read as a record ({error}): delete it") from None
    return record


def iso(moment: datetime) -> str:
    """Return a moment in the form that all records use: ISO 8601 with milliseconds."""
    return moment.isoformat(timespec="milliseconds")


# --- Sidecars -----------------------------------------------------------------------------------


def _files(root: Path, pattern: str) -> list[Path]:
    """Return the matching files of a results root, sorted; another root inside it is left out.

    Folders that are links, such as to another disk, are followed.
    """
    found, seen = [], set()
    for folder, inside, names in os.walk(root, followlinks=True):
        here = Path(folder)
        if here == root:
            inside[:] = set(inside) - {"history", "logs"}
        elif "history" in inside or here.resolve() in seen:
            inside.clear()
            continue
        seen.add(here.resolve())
        found += [here / name for name in fnmatch.filter(names, pattern)]
    return sorted(found)


def sidecars(root: Path) -> dict[Path, Record]:
    """Return the sidecars below a results root by path.

    ``folder`` is added to each: its own folder, relative to the root, from which its outputs are
    named.
    """
    return {
        path: {**read_record(path, _ESSENTIAL), "folder": path.parent.relative_to(root).as_posix()}
        for path in _files(root, "*.run.json")
    }


def _beside(sidecar: Path, name: str) -> Path:
    """Return the path of an output, such as ../benchmarks/a.csv; ``..`` does not follow links."""
    return Path(os.path.normpath(sidecar.parent / name))


def set_aside_damaged(root: Path, invocation: str) -> list[str]:
    """Move damaged results to history/INVOCATION/, so that Snakemake makes them anew; return names.

    A result is damaged if its hash differs from the one in its sidecar, a sidecar if it cannot be
    read. Temporary files of killed jobs are deleted. No job may run meanwhile.
    """
    damaged, temporary = [], _files(root, ".*.part")
    for path in _files(root, "*.run.json"):
        try:
            outputs = {**read_record(path).get("outputs", {})}
        except (TrackingError, TypeError):
            damaged.append(path)
            continue
        made = {_beside(path, name): sha256 for name, sha256 in outputs.items()}
        wrong = [file for file, sha in made.items() if file.is_file() and file_hash(file) != sha]
        damaged += [*wrong, path] if wrong else []
    for path in damaged:
        kept = root / "history" / invocation / os.path.relpath(path, root).replace("..", "_")
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(path, kept)
    for path in temporary:
        path.unlink(missing_ok=True)
    return [str(path) for path in [*damaged, *temporary]]


def end_the_future(root: Path) -> list[str]:
    """Set files that a wrong clock has dated in the future to now; return their names.

    Snakemake fails each job that has such an input.
    """
    now = time.time()
    found = [path for path in _files(root, "*") if path.stat().st_mtime > now]
    for path in found:
        os.utime(path, (now, now))
    return [str(path) for path in found]


# --- Runs that left no sidecar ------------------------------------------------------------------


def runs_without_sidecar(root: Path, since: float, reasons: Mapping[str, str]) -> list[Record]:
    """Return the runs since the time stamp ``since`` that left no sidecar: failed or interrupted.

    Snakemake deletes the outputs of a job before it starts, and again when it fails; the log stays.
    ``reasons`` are those that Slurm gives, by name of the run. They count if the run left no log,
    or a log without a message.
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
                **named(run),
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
    if not lines and free < _FULL:  # a full disk has no room for a message either
        return "failed", f"ended without a message, with {free // 1000} kB left on the disk"
    return "interrupted", "ended without a message: it was killed, or Snakemake was"


# --- Invocations --------------------------------------------------------------------------------


def history_file(root: Path, invocation: str, kind: str = "json") -> Path:
    """Return the path of an invocation's record; of the lock that it holds for kind "lock"."""
    return root / "history" / f"{invocation}.{kind}"


def invocation_records(root: Path) -> list[Record]:
    """Return the records of all invocations as written, oldest first.

    A record of an invocation that was killed still says "running".
    """
    paths = (root / "history").glob("*.json")
    records = [read_record(path, _OF_INVOCATION) for path in paths]
    return sorted(records, key=lambda each: each["started_stamp"])


def is_running(root: Path, invocation: str) -> bool:
    """Return whether an invocation runs: its process then holds its lock."""
    try:
        with history_file(root, invocation, "lock").open(encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except FileNotFoundError:
        return False
    return False


def completed(root: Path, record: Record, outcome: str, ended: datetime | None) -> Record:
    """Return ``record`` with the outcome, the end, and all runs of the invocation."""
    name, since = record["invocation"], record["started_stamp"]
    runs = [each for each in sidecars(root).values() if each.get("invocation") == name]
    failures: list[Record] = []
    if not record.get("idle") and outcome in ("failed", "interrupted"):
        reasons = slurm_reasons(root, record.get("snakemake_log"))
        failures = runs_without_sidecar(root, since, reasons)
        if all(each["status"] == "interrupted" for each in failures):
            outcome = "interrupted"
    return {
        **record,
        "outcome": outcome,
        "ended": iso(ended) if ended else None,
        "wall_seconds": round(ended.timestamp() - since, 3) if ended else None,
        "runs": sorted(runs, key=_place_in_time),
        "failures": failures,
    }


def load_history(root: Path) -> list[Record]:
    """Return all invocations recorded below a results root, oldest first.

    ``outcome`` is "done", "failed", "interrupted" or "running".

    Raises:
        TrackingError: the results root has no history, or a file is no record.
    """
    if not (root / "history").is_dir():
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
    """Return the only invocation whose name begins with ``name``; "last" is the latest."""
    if name == "last" and history:
        return history[-1]
    found = [record for record in history if record["invocation"].startswith(name)]
    if len(found) == 1 and name:
        return found[0]
    what = f"is the beginning of {len(found)}" if found else "is no invocation"
    raise TrackingError(f"{name!r} {what}; python -m study runs --invocations lists them")


# --- Runs ---------------------------------------------------------------------------------------


def load_runs(root: Path) -> list[Record]:
    """Return all runs recorded below a results root, oldest first.

    A run is a sidecar with further keys: ``status``, one of RUN_STATUS; ``current``, True if its
    results are in place, or for the last failure of a run that has no results; and for a failure
    the ``reason``.
    """
    standing = {_identity(record): record for record in sidecars(root).values()}
    runs = {key: {**record, "status": "done"} for key, record in standing.items()}
    for invocation in load_history(root):
        for record in invocation["runs"]:
            runs.setdefault(_identity(record), {**record, "status": "done"})
        for record in invocation["failures"]:
            stated = {"invocation": invocation["invocation"], "git": invocation["git"]}
            runs[_identity(record)] = {**stated, **record}
    whole = {run for run, _ in standing}
    last_failure = {run: start for (run, start), record in runs.items()
                    if record["status"] != "done"}  # fmt: skip
    for key, record in runs.items():
        failed_last = key[0] not in whole and last_failure.get(key[0]) == key[1]
        record["current"] = key in standing if record["status"] == "done" else failed_last
    return sorted(runs.values(), key=_place_in_time)


def find_run(runs: Sequence[Record], name: str) -> Record:
    """Return the latest run called ``name``; "NAME@INVOCATION" selects its invocation."""
    run, _, invocation = name.partition("@")
    found = [
        each
        for each in runs
        if each["run"] == run and str(each.get("invocation", "")).startswith(invocation)
    ]
    if not found:
        raise TrackingError(f"{name!r} is no run; python -m study runs lists them")
    return found[-1]


def has_outcome(run: Record, outcome: str) -> bool:
    """Return whether a run or invocation ended so, or one of a run's trajectories did."""
    ended = run.get("status", run.get("outcome"))
    return bool(ended == outcome or run.get("counts", {}).get(outcome, 0))


def _row(run: Record) -> Record:
    """Return a run as a row of the index."""
    counts, git = run.get("counts", {}), run.get("git", {})
    flat = {
        **run,
        "current": int(run["current"]),
        "commit": git.get("commit"),
        "dirty": int(git["dirty"]) if "dirty" in git else None,
        "outputs": " ".join(f"{name}:{sha}" for name, sha in run.get("outputs", {}).items()),
        **{f"runs_{name}": counts.get(name) for name in COUNTS},
    }
    return {column: flat.get(column) for column in COLUMNS}


def write_index(root: Path) -> None:
    """Write the index of all runs, runs.csv."""
    rows = (_row(run) for run in load_runs(root))
    write_text(csv_text(COLUMNS, rows), root / "runs.csv")
