"""Records of invocations of Snakemake, written when an invocation starts and when it ends.

The handlers onstart, onsuccess and onerror of the Snakefile report an invocation that runs jobs.
Snakemake calls no handler if there is nothing to do, or if it stops before the first job. The
plug-in for its loggers reports these, and dry runs: ``src/snakemake_logger_plugin_vibralign``.
"""

import contextlib
import fcntl
import io
import os
import platform
import secrets
import shlex
import sys
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from model.sweeps.files import write_json
from study.tracking import TrackingError
from study.tracking.history import (
    Record,
    completed,
    end_the_future,
    history_file,
    invocation_records,
    is_running,
    iso,
    set_aside_damaged,
    write_index,
)
from study.tracking.job import INVOCATION, git_state, lock_folder, say, versions
from study.tracking.slurm import refuse_held_jobs

PATIENCE = 5.0  # seconds: a process that was just killed may hold its lock for a moment


class Invocation:
    """One invocation of Snakemake.

    A running invocation holds a lock, which the system releases when the process ends in any way.
    An invocation that was recorded as running and holds no lock was therefore interrupted.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._begun = datetime.now(UTC)
        self.name = f"{self._begun:%Y%m%dT%H%M%SZ}-{secrets.token_hex(2)}"
        self.metadata: Record = {}  # more to record, such as the study; set before ``start``
        self._record: Record = {}
        self._lock: io.TextIOWrapper | None = None
        self._holds_folder = False

    def recover(self, patience: float = 0.0) -> None:
        """Lock the folder for this invocation, and set aside results damaged since they were made.

        Raises:
            TrackingError: another Snakemake runs here, or Slurm holds jobs of this folder.
        """
        if self._holds_folder:
            return
        refuse_held_jobs(Path.cwd())
        lock_folder(self.name, patience)
        self._holds_folder = True
        try:
            for name in set_aside_damaged(self.root, self.name):
                kept = self.root / "history" / self.name
                say(f"{name}: not as its job left it: moved to {kept}, made anew where asked for")
            for name in end_the_future(self.root):
                say(f"{name}: was dated in the future: set to now")
        except OSError as error:
            raise TrackingError(f"results cannot be checked: {error}: mend that first") from None

    def start(self) -> None:
        """Lock the folder and record the start of this invocation."""
        self.recover(PATIENCE)
        self.record()

    def record(self) -> None:
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
            **self.metadata,
        }
        with _or_say("the start of this invocation could not be recorded"):
            (self.root / "history").mkdir(parents=True, exist_ok=True)
            for record in invocation_records(self.root):
                if record["outcome"] == "running" and not is_running(
                    self.root, record["invocation"]
                ):
                    _write_end(self.root, record, "interrupted", None)
            self._lock = history_file(self.root, self.name, "lock").open("w", encoding="utf-8")
            fcntl.flock(self._lock, fcntl.LOCK_EX)
            write_json(self._record, history_file(self.root, self.name))

    def record_idle(self, outcome: str, reason: str | None = None) -> None:
        """Record the start and the end of an invocation that started no job."""
        if self._record:
            return
        self.record()
        self._record["idle"] = True
        if outcome != "done":
            self._record["reason"] = reason or "stopped before the first job"
        self.end(outcome)

    def end(self, outcome: str, log: str | None = None) -> list[str]:
        """Record the end and write the index; return a line for each failed or interrupted run.

        ``outcome`` is "done", "failed" or "interrupted"; ``log`` is Snakemake's. A failure in which
        no run failed is recorded as an interruption.
        """
        wrong: list[Record] = []
        with _or_say("the end of this invocation could not be recorded"):
            self._record["snakemake_log"] = log
            wrong = _write_end(self.root, self._record, outcome, datetime.now(UTC))
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
    """Report a record that cannot be written, and go on: the record must not stop the study."""
    try:
        yield
    except (OSError, TrackingError) as error:
        say(f"vibralign: {consequence}: {error}")


def _write_end(root: Path, record: Record, outcome: str, ended: datetime | None) -> list[Record]:
    """Write the end of an invocation; return its failures."""
    whole = completed(root, record, outcome, ended)
    write_json(whole, history_file(root, record["invocation"]))
    history_file(root, record["invocation"], "lock").unlink(missing_ok=True)
    return list(whole["failures"])


# --- This process -------------------------------------------------------------------------------


# Snakemake's logger plug-in in this process, None if it is off. It is set before the Snakefile is
# read, and takes the invocation.
logger: Any = None


def begin(config: Mapping[str, Any]) -> Invocation:
    """Return the invocation of this process; the Snakefile calls this with its configuration.

    Raises:
        TrackingError: results are to be deleted while another Snakemake runs here.
    """
    if shlex.quote(sys.executable) != sys.executable:  # Snakemake's shell commands set no quotes
        interpreter = Path(sys.executable)
        os.environ["PATH"] = f"{interpreter.parent}{os.pathsep}{os.environ['PATH']}"
        sys.executable = interpreter.name
    named = config.get("results_root")
    invocation = Invocation(Path(named if named and isinstance(named, str) else "results"))
    if logger is not None:
        logger.invocation = invocation
        os.environ[INVOCATION] = invocation.name
        # An option that deletes results begins so; Snakemake itself does not look for a run.
        if not logger.plans and any(word.startswith("--delete-") for word in sys.argv):
            invocation.recover()  # refused while another runs
    os.environ["MPLBACKEND"] = "agg"  # that of a notebook draws no files
    return invocation
