"""Locks of a results root: one start builds into it, and no job of a killed start beside it.

The system releases these locks when a process ends in any way. Snakemake's own locks outlast a
kill; the profiles turn them off with ``nolock``. The folder must be on a file system that passes
locks on to all machines that build there.
"""

import fcntl
import sys
from pathlib import Path
from typing import IO

from study.tracking import TrackingError

_held: list[IO[str]] = []  # until this process ends


def _open(root: Path, name: str) -> IO[str]:
    (root / "history").mkdir(parents=True, exist_ok=True)
    lock = (root / "history" / name).open("a+", encoding="utf-8")
    _held.append(lock)
    return lock


def lock_root(root: Path) -> IO[str]:
    """Lock a results root for this process, and wait for jobs of an earlier start to end.

    Returns:
        The file of the lock, into which ``tell`` writes the number of the start.

    Raises:
        TrackingError: another start builds here.
        OSError: the root cannot be written, or its file system has no locks.
    """
    lock = _open(root, "lock")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise TrackingError(
            f"another start builds {root} now: wait until it ends, or stop it; "
            "`python -m study runs --starts` shows it"
        ) from None
    tell(lock, 0)  # a job of an earlier start that begins from now on is refused
    jobs = _open(root, "jobs.lock")
    try:
        fcntl.flock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        say("waiting for jobs of an interrupted start to end")
        fcntl.flock(jobs, fcntl.LOCK_EX)
    fcntl.flock(jobs, fcntl.LOCK_UN)
    return lock


def tell(lock: IO[str], start: int) -> None:
    """Write the number of the start that holds a lock into its file."""
    lock.truncate(0)
    lock.write(str(start))
    lock.flush()


def hold_as_job(root: Path, start: int) -> None:
    """Lock a results root for a job, together with other jobs, until its process ends.

    Raises:
        TrackingError: the start that the job belongs to was killed, and another has the root.
    """
    fcntl.flock(_open(root, "jobs.lock"), fcntl.LOCK_SH)
    if (now := _holder(root)) != start:
        raise TrackingError(
            f"refused: this job's start, {start}, was killed (the lock names {now})"
        )


def _holder(root: Path) -> int | None:
    try:
        return int((root / "history/lock").read_text(encoding="utf-8"))
    except (FileNotFoundError, ValueError):
        return None


def is_running(root: Path, start: int) -> bool:
    """Return True if a start still runs: its process holds the lock, which names it."""
    try:
        with (root / "history/lock").open(encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return _holder(root) == start
    except FileNotFoundError:
        pass
    return False


def say(words: str) -> None:
    """Write a line to standard error, if it is open."""
    if sys.stderr is not None:
        sys.stderr.write(f"{words}\n")
