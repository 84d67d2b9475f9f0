"""Records of the study's runs on disk: sidecars, logs, and the results that are kept.

Files are the tracker, below the results root:

    data/…, figures/…, *.run.json   a sidecar beside what each job made (provenance.Job writes it)
    history/INVOCATION.json         one record an invocation of Snakemake, failed ones included
    history/data/SHA256.nc          every figure's dataset that an invocation ended with, kept once
    runs.csv                        the index of all runs, made from the files above

A run is one job that one invocation started; its name is that of its log: "chunk/fig06/0". Only
Snakemake's own process writes the history, so that nothing is written twice at the same time.

MLflow was weighed as the tracker: it needs its own server or database and cannot say which run a
file on disk belongs to. An invocation can be exported to it (export.py).
"""

import json
import shutil
import time
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from model.tracking.provenance import file_hash

Record = dict[str, Any]

_FOLDERS = ("data", "figures", "benchmarks", "accuracy")
_PLACES = ("", *(f"{folder}/**/" for folder in _FOLDERS))  # of sidecars
_ESSENTIAL = {"run", "rule", "started", "outputs"}  # what every sidecar has
_FULL = 1_000_000  # bytes: less than this is a full disk
# Without sidecars: these write the index, and print.
_NO_RUNS = {"index", "accuracy", "fuzz"}
# Rules whose outputs are parts of others, and rules of whose results copies are kept.
PARTS = frozenset({"chunk", "trial", "fuzz_part", "map_part"})
KEPT = frozenset({"merge", "history", "claims"})


class TrackingError(ValueError):
    """A record that cannot be read, or a name without a record."""


def read_record(path: Path) -> Record:
    """Read a sidecar or the record of an invocation.

    Raises:
        TrackingError: a file that is no record.
    """
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise TrackingError(f"{path}: cannot be read as a record ({error}): delete it") from None


def _sidecar_files(root: Path) -> list[Path]:
    return sorted(path for place in _PLACES for path in root.glob(f"{place}*.run.json"))


def sidecars(root: Path) -> dict[Path, Record]:
    """Read the sidecars below a results root, by their paths.

    Each gets its ``folder``, from which its outputs are named, relative to the root. Those of an
    earlier layout are left out.

    Raises:
        TrackingError: a file that is no record.
    """
    records = {path: read_record(path) for path in _sidecar_files(root)}
    return {
        path: {**record, "folder": path.parent.relative_to(root).as_posix()}
        for path, record in records.items()
        if set(record) >= _ESSENTIAL
    }


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
    whole = {record["run"] for record in sidecars(root).values()} | _NO_RUNS
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


def iso(moment: datetime) -> str:
    """Return a moment as every record states it: ISO 8601, in milliseconds."""
    return moment.isoformat(timespec="milliseconds")


def kept_result(root: Path, name: str, sha256: str) -> Path:
    """Return where an output of that name and content is kept."""
    return root / "history" / "data" / f"{sha256}{Path(name).suffix}"


def discard_damaged(root: Path) -> list[str]:
    """Delete damaged results, so that Snakemake makes them anew; return their names.

    Damaged are files whose hash differs from their sidecar's, sidecars that cannot be read, and
    partial files of killed jobs. No job may run meanwhile.
    """
    damaged = [path for place in _PLACES for path in root.glob(f"{place}.*.part")]
    for path in _sidecar_files(root):
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
