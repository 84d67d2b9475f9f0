"""The study's memory: every job's sidecar, one record an invocation, one index of all runs.

Files are the tracker, below the results root:

    data/…, figures/…, *.run.json   a sidecar beside what each job made (provenance.Job writes it)
    history/INVOCATION.json         one record an invocation of Snakemake, failed ones included
    history/data/SHA256.nc          every figure's dataset that an invocation ended with, kept once
    runs.csv, runs.sqlite           the index of all runs, made from the files above

A run is one job that one invocation started; its name is that of its log: "chunk/fig06/0". An
invocation has one writer, Snakemake's own process, so that nothing here is ever written twice at
the same time.
"""

import contextlib
import fcntl
import io
import json
import os
import platform
import secrets
import shutil
import sqlite3
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from model.study.csv_tables import csv_text
from model.study.files import whole_file
from model.tracking.provenance import (
    INVOCATION,
    file_hash,
    git_state,
    versions,
    write_json,
    write_text,
)

Record = dict[str, Any]

RUN_STATUS = ("done", "failed", "interrupted")
COUNTS = (
    "trajectories", "aligned", "settled", "left_scene", "horizon_reached", "failed", "sensitive",
    "rhs_evaluations",
)  # fmt: skip
COLUMNS = (
    "run", "rule", "figure", "status", "current", "started", "wall_seconds", "invocation", "commit",
    "dirty", "code", "sweep", "outputs", *(f"runs_{name}" for name in COUNTS), "host", "reason",
)  # fmt: skip
_FOLDERS = ("data", "figures", "benchmarks", "accuracy", "identification")
_PLACES = ("", *(f"{folder}/**/" for folder in _FOLDERS))  # of sidecars
_ESSENTIAL = {"run", "rule", "started", "outputs"}  # what every sidecar has
_FULL = 1_000_000  # bytes: less than this is a full disk
_NO_RUNS = {"index", "accuracy", "identification"}  # without sidecars: they write the index, print
# Rules whose outputs are parts of others, and rules of whose results copies are kept.
PARTS = frozenset({"chunk", "trial", "map_part", "limit_part", "identify_sample"})
KEPT = frozenset({"merge", "history", "claims"})


class TrackingError(ValueError):
    """A record that cannot be read, or something asked for that is not recorded."""


# --- What stands on disk ------------------------------------------------------------------------


def _read(path: Path) -> Record:
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise TrackingError(f"{path}: cannot be read as a record ({error}): delete it") from None


def sidecars(root: Path) -> dict[Path, Record]:
    """The sidecars below a results root, by their paths; those of an earlier layout are left out.

    Each has its ``folder`` added, from which its outputs are named, relative to the root.

    Raises:
        TrackingError: a file that is no record.
    """
    found = [path for place in _PLACES for path in root.glob(f"{place}*.run.json")]
    records = {path: _read(path) for path in sorted(found)}
    return {
        path: {**record, "folder": path.parent.relative_to(root).as_posix()}
        for path, record in records.items()
        if set(record) >= _ESSENTIAL
    }


def _without_sidecar(root: Path, since: float) -> list[Record]:
    """Runs that began after the time stamp ``since`` and left a log, but no sidecar.

    Snakemake deletes the outputs of a job before it starts, and again when it fails; the log stays.
    """
    whole = {record["run"] for record in sidecars(root).values()} | _NO_RUNS
    found = []
    for log in sorted((root / "logs").glob("**/*.log")):
        run = log.relative_to(root / "logs").with_suffix("").as_posix()
        if run in whole or log.stat().st_mtime < since:
            continue
        status, reason = _last_word(log)
        found.append(
            {
                "run": run,
                "rule": run.split("/", maxsplit=1)[0],
                "figure": next((part for part in run.split("/") if part.startswith("fig")), None),
                "status": status,
                "reason": reason,
                "log": log.relative_to(root).as_posix(),
                "started": _iso(log.stat().st_mtime),
            }
        )
    return found


def _last_word(log: Path) -> tuple[str, str]:
    """(status, reason) of a run that left no sidecar, from its log."""
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    if lines and lines[-1] != "KeyboardInterrupt":
        return "failed", lines[-1].strip()
    free = shutil.disk_usage(log.parent).free
    if not lines and free < _FULL:  # then there was no room for its last word either
        return "failed", f"ended without a word, with {free // 1000} kB left on the disk"
    return "interrupted", "ended without a word: it was killed, or Snakemake was"


def _last_words(log: str | None) -> str:
    """What Snakemake's own log says last; the lines of a traceback are indented."""
    if log and Path(log).is_file():
        lines = Path(log).read_text(encoding="utf-8", errors="replace").splitlines()
        said = [line.strip() for line in lines if line.strip() and not line.startswith(" ")]
        if said:
            return said[-1]
    return "stopped before the first job; the terminal said why"


def _iso(stamp: float) -> str:
    return datetime.fromtimestamp(stamp, UTC).isoformat(timespec="milliseconds")


def discard_damaged(root: Path) -> list[str]:
    """Delete what is not as its job left it, so that Snakemake makes it anew; the names deleted.

    Those are files whose content is not what their sidecar says, sidecars that cannot be read, and
    parts of files that a killed job was writing. No job may run meanwhile.
    """
    damaged = [path for place in _PLACES for path in root.glob(f"{place}.*.part")]
    for path in [path for place in _PLACES for path in root.glob(f"{place}*.run.json")]:
        try:
            outputs = _read(path).get("outputs", {})
        except TrackingError:
            damaged.append(path)
            continue
        made = {path.parent / name: sha256 for name, sha256 in outputs.items()}
        wrong = [file for file, sha in made.items() if file.is_file() and file_hash(file) != sha]
        damaged += [*wrong, path] if wrong else []
    for path in damaged:
        path.unlink(missing_ok=True)
    return [str(path) for path in damaged]


# --- Invocations --------------------------------------------------------------------------------


class Invocation:
    """One invocation of Snakemake, recorded when it starts and again when it ends.

    While it lives it holds a lock, which the system drops with the process that holds it, however
    that dies: a record without an end and without a lock is that of an interrupted invocation.

    Args:
        root: the results root.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._begun = datetime.now(UTC)
        self.name = f"{self._begun:%Y%m%dT%H%M%SZ}-{secrets.token_hex(2)}"
        self._facts: Record = {}
        self._record: Record = {}
        self._lock: io.TextIOWrapper | None = None

    @property
    def _path(self) -> Path:
        return _history(self.root) / f"{self.name}.json"

    def state(self, **facts: Any) -> None:
        """What to record besides, such as the study's configuration; before the start."""
        self._facts |= facts

    def announce(self) -> None:
        """Let jobs started from this process know which invocation they belong to."""
        os.environ[INVOCATION] = self.name

    def start(self) -> None:
        """Record the start; records that an earlier invocation left without an end get theirs."""
        self._record = {
            "invocation": self.name,
            "outcome": "running",
            "started": self._begun.isoformat(timespec="milliseconds"),
            "started_stamp": self._begun.timestamp(),
            "command": [Path(sys.argv[0]).name, *sys.argv[1:]],
            "host": platform.node(),
            "versions": versions(),
            "git": git_state(),
            **self._facts,
        }
        with _or_say("the start of this invocation could not be recorded"):
            _history(self.root).mkdir(parents=True, exist_ok=True)
            for record in _records(self.root):
                if record["outcome"] == "running" and not _alive(self.root, record["invocation"]):
                    _end(self.root, record, "interrupted", None)
            self._lock = self._path.with_suffix(".lock").open("w", encoding="utf-8")
            fcntl.flock(self._lock, fcntl.LOCK_EX)
            write_json(self._record, self._path)

    def pass_by(self, outcome: str, log: str | None = None, reason: str | None = None) -> None:
        """Record an invocation that started no job, unless it is recorded: start and end in one.

        Args:
            outcome: "done", "failed" or "interrupted".
            log: Snakemake's own log.
            reason: why it failed; by default what the log says last.
        """
        if self._record:
            return
        self.start()
        self._record["idle"] = True
        if outcome != "done":
            self._record["reason"] = reason or _last_words(log)
        self.end(outcome, log)

    def end(self, outcome: str, log: str | None = None) -> list[str]:
        """Record the end and write the index; what to tell the user of runs that went wrong.

        Args:
            outcome: "done" or "failed"; where jobs ran and none failed, that is an interruption.
            log: Snakemake's own log.
        """
        wrong: list[Record] = []
        with _or_say("the end of this invocation could not be recorded"):
            self._record["snakemake_log"] = log
            wrong = _end(self.root, self._record, outcome, datetime.now(UTC))["failures"]
            write_index(self.root)
        if self._lock is not None:
            self._lock.close()
            self._lock = None
        return [
            f"{each['run']} {each['status']}: {each['reason']} ({self.root / each['log']})"
            for each in wrong
        ]


@contextlib.contextmanager
def _or_say(consequence: str) -> Iterator[None]:
    """A full disk must not hide why the study failed: say so, and go on."""
    try:
        yield
    except (OSError, TrackingError, sqlite3.Error) as error:
        sys.stderr.write(f"vibralign: {consequence}: {error}\n")


def _history(root: Path) -> Path:
    return root / "history"


def _records(root: Path) -> list[Record]:
    """The records of all invocations as they stand on disk, oldest first."""
    records = [_read(path) for path in _history(root).glob("*.json")]
    return sorted(records, key=lambda each: each["started_stamp"])


def _alive(root: Path, name: str) -> bool:
    path = _history(root) / f"{name}.lock"
    try:
        with path.open("r+", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except FileNotFoundError:
        return False
    return False


def _completed(root: Path, record: Record, outcome: str, ended: datetime | None) -> Record:
    """``record`` with its end: the sidecars that it left, and the runs that left none."""
    name, since = record["invocation"], record["started_stamp"]
    runs = [each for each in sidecars(root).values() if each.get("invocation") == name]
    idle = record.get("idle", False)
    failures = [] if idle or outcome in ("running", "done") else _without_sidecar(root, since)
    if not idle and outcome == "failed" and all(f["status"] == "interrupted" for f in failures):
        outcome = "interrupted"
    wall = round(ended.timestamp() - since, 3) if ended else None
    return {
        **record,
        "outcome": outcome,
        "ended": ended.isoformat(timespec="milliseconds") if ended else None,
        "wall_seconds": wall,
        "runs": sorted(runs, key=lambda each: (each["started"], each["run"])),
        "failures": failures,
    }


def _end(root: Path, record: Record, outcome: str, ended: datetime | None) -> Record:
    completed = _completed(root, record, outcome, ended)
    _keep_results(root, completed["runs"])
    write_json(completed, _history(root) / f"{record['invocation']}.json")
    (_history(root) / f"{record['invocation']}.lock").unlink(missing_ok=True)
    return completed


def _keep_results(root: Path, runs: Iterable[Record]) -> None:
    """Keep what the study may be compared by later: figures' datasets and the claims' verdicts."""
    names = {record["run"] for record in runs if record["rule"] in KEPT}
    for path, record in sidecars(root).items():
        for name, sha256 in record["outputs"].items():
            source, kept = path.parent / name, kept_result(root, name, sha256)
            worth = record["run"] in names and name.endswith((".nc", ".csv"))
            if worth and source.is_file() and not kept.exists():
                with whole_file(kept) as part:
                    shutil.copyfile(source, part)


def kept_result(root: Path, name: str, sha256: str) -> Path:
    """Where an output of that name and content is kept."""
    return _history(root) / "data" / f"{sha256}{Path(name).suffix}"


def load_history(root: Path) -> list[Record]:
    """All invocations recorded below a results root, oldest first.

    ``outcome`` is done, failed, interrupted, or running for one that still lives.

    Raises:
        TrackingError: a results root without a history, or a file that is no record.
    """
    if not _history(root).is_dir():
        raise TrackingError(
            f"{root}: holds no history of runs; build the study first, or name its results root"
        )
    history = []
    for record in _records(root):
        if record["outcome"] == "running":
            lives = _alive(root, record["invocation"])
            record = _completed(root, record, "running" if lives else "interrupted", None)
        history.append(record)
    return history


def find_invocation(history: Sequence[Record], name: str) -> Record:
    """The invocation of that name or beginning of a name; "last" is the latest.

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


# --- Runs ---------------------------------------------------------------------------------------


def load_runs(root: Path) -> list[Record]:
    """Every run ever recorded below a results root, oldest first.

    Each is a sidecar with ``status`` (one of RUN_STATUS), ``current`` (whether what it made still
    stands, or for a failure whether nothing has mended it since) and, where it failed, ``reason``.

    Raises:
        TrackingError: as ``load_history``.
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
    latest_failure = {run: key for key, each in runs.items() for run in [each["run"]]
                      if each["status"] != "done"}  # fmt: skip
    for key, record in runs.items():
        if record["status"] == "done":
            record["current"] = key in standing
        else:
            record["current"] = record["run"] not in whole and latest_failure[record["run"]] == key
    return sorted(runs.values(), key=lambda each: (each["started"], each["run"]))


def _identity(record: Record) -> tuple[str, str]:
    return record["run"], record["started"]


def find_run(runs: Sequence[Record], name: str) -> Record:
    """The latest run of that name; "NAME@INVOCATION" the one of that invocation.

    Raises:
        TrackingError: no run of that name.
    """
    run, _, invocation = name.partition("@")
    found = [
        each
        for each in runs
        if each["run"] == run and str(each.get("invocation", "")).startswith(invocation)
    ]
    if not found:
        raise TrackingError(f"{name!r} is no run; vibralign runs lists them")
    return found[-1]


def select_runs(
    runs: Iterable[Record],
    *,
    figure: str | None = None,
    parameters: Sequence[str] = (),
    outcome: str | None = None,
    since: str | None = None,
    until: str | None = None,
    current: bool = False,
) -> list[Record]:
    """The runs that fit every condition given.

    Args:
        runs: as from ``load_runs``.
        figure: such as "fig06".
        parameters: "NAME=VALUE" for runs that hold or sweep over the value, "NAME" for runs that
            vary the parameter.
        outcome: a status (done, failed, interrupted), or an outcome that at least one of the run's
            trajectories has (aligned, settled, left_scene, horizon_reached, failed, sensitive).
        since: first moment, as ISO 8601 with as many parts as wanted ("2026-11").
        until: last moment, likewise.
        current: only what still stands.
    """
    return [
        run
        for run in runs
        if (figure is None or run["figure"] == figure)
        and all(_covers(run, condition) for condition in parameters)
        and (outcome is None or _has_outcome(run, outcome))
        and _within(run, since, until)
        and (not current or run["current"])
    ]


def select_invocations(
    history: Iterable[Record],
    *,
    outcome: str | None = None,
    since: str | None = None,
    until: str | None = None,
) -> list[Record]:
    """The invocations that ended with ``outcome`` and started between two moments, both included.

    Moments are as ``select_runs`` takes them.
    """
    return [
        each
        for each in history
        if outcome in (None, each["outcome"]) and _within(each, since, until)
    ]


def _within(record: Record, since: str | None, until: str | None) -> bool:
    started = str(record["started"])
    return (since is None or started >= since) and (until is None or started[: len(until)] <= until)


def _has_outcome(run: Record, outcome: str) -> bool:
    return bool(run["status"] == outcome or run.get("counts", {}).get(outcome, 0))


def varied(run: Record) -> dict[str, tuple[float, float, int]]:
    """(first, last, count) of every parameter that a run varies."""
    ranges = {}
    for axis in run.get("dimensions", []):
        if "values" in axis:
            ranges[axis["parameter"]] = (
                min(axis["values"]), max(axis["values"]), len(axis["values"]),
            )  # fmt: skip
        else:
            ranges[axis["parameter"]] = (axis["start"], axis["stop"], axis["count"])
    return ranges


def _covers(run: Record, condition: str) -> bool:
    name, equals, text = condition.partition("=")
    ranges = varied(run)
    if not equals:
        return name in ranges
    try:
        value = float(text)
    except ValueError:
        raise TrackingError(f"{condition!r}: {text!r} is no number") from None
    if name in ranges:
        low, high, _ = ranges[name]
        return low <= value <= high
    return bool(run.get("parameters", {}).get(name) == value)


# --- The index ----------------------------------------------------------------------------------


def _row(run: Record) -> Record:
    """A run as one flat line of the index."""
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
    """Write runs.csv, and runs.sqlite from the same rows, each whole or not at all.

    Raises:
        TrackingError: as ``load_runs``.
        OSError: the folder cannot be written.
    """
    runs = load_runs(root)
    write_text(csv_text(COLUMNS, (_row(run) for run in runs)), root / "runs.csv")
    with (
        whole_file(root / "runs.sqlite") as part,
        contextlib.closing(sqlite3.connect(part)) as base,
    ):
        _insert(base, "runs", COLUMNS, [_row(run) for run in runs])
        _insert(base, "parameters", ("run", "started", "name", "low", "high", "count"),
                [row for run in runs for row in _parameter_rows(run)])  # fmt: skip
        _insert(base, "invocations",
                ("invocation", "outcome", "started", "ended", "wall_seconds", "host"),
                load_history(root))  # fmt: skip
        base.commit()


def _parameter_rows(run: Record) -> Iterator[Record]:
    ranges = varied(run)
    for name, value in run.get("parameters", {}).items():
        low, high, count = ranges.get(name, (value, value, 1))
        place = {"run": run["run"], "started": run["started"]}
        yield {**place, "name": name, "low": low, "high": high, "count": count}


def _insert(
    base: sqlite3.Connection, table: str, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]
) -> None:
    names = ", ".join(f'"{name}"' for name in columns)
    base.execute(f"CREATE TABLE {table} ({names})")
    marks = ", ".join("?" * len(columns))
    values = [[row.get(name) for name in columns] for row in rows]
    base.executemany(f"INSERT INTO {table} VALUES ({marks})", values)  # noqa: S608  (own names)
