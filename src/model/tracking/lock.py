"""One Snakemake at a time in a folder, and none beside jobs that outlived a killed one.

The system drops these locks with the process that holds them, however that dies; Snakemake's own
stay after a kill, so that the profiles have ``nolock``.
"""

import fcntl
import subprocess
import sys
import time
from pathlib import Path
from typing import IO

from model.tracking import TrackingError

_RUN, _JOBS = Path(".snakemake/run.lock"), Path(".snakemake/jobs.lock")
_held: list[IO[str]] = []  # until this process ends
# Mount options by which a file system keeps locks on the machine, or has none.
_UNSAFE = {
    "nfs": {"nolock", "local_lock=flock", "local_lock=all"},
    "nfs4": {"nolock", "local_lock=flock", "local_lock=all"},
    "lustre": {"localflock", "noflock"},
    "cifs": {"nobrl"},
}


def refuse_unsafe(path: Path) -> None:
    """Refuse a file system whose locks do not hold on other machines.

    Raises:
        TrackingError: that which holds ``path`` is mounted so.
    """
    question = ["findmnt", "--first-only", "--noheadings", "--output=FSTYPE,OPTIONS", "--target"]
    try:
        asked = subprocess.run([*question, path], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):  # no Linux
        return
    kind, options = asked.stdout.rstrip().split(maxsplit=1)
    if told := sorted(_UNSAFE.get(kind, set()).intersection(options.split(","))):
        raise TrackingError(
            f"{path}: {kind} is mounted here with {', '.join(told)}, so that no other machine "
            "sees a lock: have it mounted without, or work in another folder"
        )


def hold_folder(name: str, patience: float) -> None:
    """Hold this folder for the invocation ``name``, once no job of an earlier one is left.

    Args:
        name: written into the lock, for jobs to know whose they are.
        patience: seconds to wait for a process that was just killed, which may still hold it.

    Raises:
        TrackingError: another Snakemake runs here, on this machine or on another.
    """
    _RUN.parent.mkdir(exist_ok=True)
    lock, until = _RUN.open("a+", encoding="utf-8"), time.monotonic() + patience
    refuse_unsafe(_RUN)
    while True:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            break
        except BlockingIOError:
            if time.monotonic() > until:
                raise TrackingError(
                    "another Snakemake runs the study in this directory; wait for it or stop it"
                ) from None
            time.sleep(0.1)
        except OSError as error:
            raise TrackingError(
                f"{_RUN}: the file system has no locks ({error}): work in another folder"
            ) from None
    _held.append(lock)
    lock.truncate(0)
    lock.write(name)
    lock.flush()
    with _JOBS.open("w", encoding="utf-8") as jobs:
        try:
            fcntl.flock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            sys.stderr.write("waiting for jobs of an interrupted run to end\n")
            fcntl.flock(jobs, fcntl.LOCK_EX)


def hold_job(invocation: str | None) -> None:
    """Hold the folder for a job, beside others, until its process ends.

    Raises:
        SystemExit: the invocation that started it was killed, and another holds the folder.
    """
    _JOBS.parent.mkdir(exist_ok=True)
    lock = _JOBS.open("a", encoding="utf-8")
    fcntl.flock(lock, fcntl.LOCK_SH)
    _held.append(lock)
    now = _RUN.read_text(encoding="utf-8") if _RUN.is_file() else ""
    if invocation and now not in ("", invocation):
        raise SystemExit(f"refused: {invocation}, which started this job, was killed")
