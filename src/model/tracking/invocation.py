"""Invocations of Snakemake: one record each, written when it starts and again when it ends."""

import contextlib
import fcntl
import io
import os
import platform
import secrets
import shutil
import sys
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from model.study.files import whole_file
from model.tracking.history import completed, history_folder, invocation_records, is_running
from model.tracking.index import write_index
from model.tracking.provenance import INVOCATION, git_state, versions, write_json
from model.tracking.records import (
    KEPT,
    Record,
    TrackingError,
    iso,
    kept_result,
    sidecars,
)


class Invocation:
    """One invocation of Snakemake, recorded when it starts and again when it ends.

    A running invocation holds a lock, which the system releases when the process ends in any way: a
    record without an end and without a lock belongs to an interrupted invocation.

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
        return history_folder(self.root) / f"{self.name}.json"

    def state(self, **facts: Any) -> None:
        """Add facts to record, such as the study's configuration; before the start."""
        self._facts |= facts

    def announce(self) -> None:
        """Pass the name of this invocation to jobs started from this process."""
        os.environ[INVOCATION] = self.name

    def start(self) -> None:
        """Record the start, and the end of earlier invocations that were killed."""
        self._record = {
            "invocation": self.name,
            "outcome": "running",
            "started": iso(self._begun),
            "started_stamp": self._begun.timestamp(),
            "command": [Path(sys.argv[0]).name, *sys.argv[1:]],
            "host": platform.node(),
            "versions": versions(),
            "git": git_state(),
            **self._facts,
        }
        with _or_say("the start of this invocation could not be recorded"):
            history_folder(self.root).mkdir(parents=True, exist_ok=True)
            for record in invocation_records(self.root):
                if record["outcome"] == "running" and not is_running(
                    self.root, record["invocation"]
                ):
                    _end(self.root, record, "interrupted", None)
            self._lock = self._path.with_suffix(".lock").open("w", encoding="utf-8")
            fcntl.flock(self._lock, fcntl.LOCK_EX)
            write_json(self._record, self._path)

    def pass_by(self, outcome: str, log: str | None = None, reason: str | None = None) -> None:
        """Record an invocation that started no job, unless it is recorded: start and end in one.

        Args:
            outcome: "done", "failed" or "interrupted".
            log: Snakemake's own log.
            reason: reason of a failure; by default the last line of the log.
        """
        if self._record:
            return
        self.start()
        self._record["idle"] = True
        if outcome != "done":
            self._record["reason"] = reason or _last_words(log)
        self.end(outcome, log)

    def end(self, outcome: str, log: str | None = None) -> list[str]:
        """Record the end and write the index; return a line for each run that went wrong.

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
    """Report a record that cannot be written, and continue: the study's own error comes first."""
    try:
        yield
    except (OSError, TrackingError) as error:
        sys.stderr.write(f"vibralign: {consequence}: {error}\n")


def _end(root: Path, record: Record, outcome: str, ended: datetime | None) -> Record:
    whole = completed(root, record, outcome, ended)
    _keep_results(root, whole["runs"])
    write_json(whole, history_folder(root) / f"{record['invocation']}.json")
    (history_folder(root) / f"{record['invocation']}.lock").unlink(missing_ok=True)
    return whole


def _keep_results(root: Path, runs: Iterable[Record]) -> None:
    """Keep copies of figures' datasets and of the claims' verdicts for later comparisons."""
    names = {record["run"] for record in runs if record["rule"] in KEPT}
    for path, record in sidecars(root).items():
        for name, sha256 in record["outputs"].items():
            source, kept = path.parent / name, kept_result(root, name, sha256)
            worth = record["run"] in names and name.endswith((".nc", ".csv"))
            if worth and source.is_file() and not kept.exists():
                with whole_file(kept) as part:
                    shutil.copyfile(source, part)


def _last_words(log: str | None) -> str:
    """Return the last line of Snakemake's own log that is not of a traceback."""
    if log and Path(log).is_file():
        lines = Path(log).read_text(encoding="utf-8", errors="replace").splitlines()
        said = [line.strip() for line in lines if line.strip() and not line.startswith(" ")]
        if said:
            return said[-1]
    return "stopped before the first job; the terminal said why"
