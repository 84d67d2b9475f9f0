"""Jobs of the study: their logs, sidecars and locks.

The scripts of the workflow do their work inside ``recorded``. It sends their output to the log,
refuses code that was edited after the job was submitted, and writes a sidecar with the hashes of
inputs and outputs.

Locks keep two Snakemakes, or a Snakemake and the jobs of one that was killed, out of the same
folder. The system releases them when a process ends in any way. Snakemake's own locks outlast a
kill; the profiles turn them off with ``nolock``.
"""

import contextlib
import fcntl
import hashlib
import importlib.metadata
import json
import os
import platform
import re
import resource
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, Any

from model.sweeps.files import write_json
from study.tracking import TrackingError
from study.tracking.code import code_hash, code_of

# Environment variables from which a job, on any machine, learns the invocation that started it, and
# the hashes of the configuration and the scripts' code at that time.
INVOCATION, SUBMITTED = "VIBRALIGN_INVOCATION", "VIBRALIGN_SUBMITTED"
_SOURCES = Path(__file__).resolve().parents[2]
_TRACKED = ("numpy", "scipy", "llvmlite", "xarray", "netCDF4", "matplotlib", "snakemake")
_RUN, _JOBS = Path(".snakemake/run.lock"), Path(".snakemake/jobs.lock")
_locks: list[IO[str]] = []  # until this process ends
# Mount options with which a file system has no locks, or locks that other machines do not see.
_NFS = {"nolock", "local_lock=flock", "local_lock=all"}
_UNSAFE = {"nfs": _NFS, "nfs4": _NFS, "lustre": {"localflock", "noflock"}, "cifs": {"nobrl"}}
# The object ``snakemake`` that Snakemake gives to a script; None in any other process.
snakemake: Any = getattr(sys.modules["__main__"], "snakemake", None)


def announce(study: str, project: Path) -> None:
    """Tell the jobs of this process the configuration and code that they are to run.

    ``study`` is the configuration as text; ``project`` is the folder of the workflow.

    Raises:
        TrackingError: this process is a job, and the configuration was edited after its submission.
    """
    now = hashlib.sha256(study.encode()).hexdigest()[:16]
    if SUBMITTED not in os.environ:
        scripts = (project / "workflow" / "scripts").glob("*.py")
        codes = {each.stem: _hash_of_script(project, each.name) for each in scripts}
        os.environ[SUBMITTED] = json.dumps({"study": now, "codes": codes})
    if json.loads(os.environ[SUBMITTED])["study"] != now:
        raise TrackingError(
            "refused: the configuration was edited after the job was submitted; start again"
        )


def _hash_of_script(project: Path, name: str) -> str:
    return code_hash(code_of(project, f"workflow/scripts/{name}"))


@contextlib.contextmanager
def recorded(snakemake: Any, *, part: bool = False) -> Iterator[dict[str, Any]]:
    """Send the output of a script to its log, and write the sidecar of the job.

    The sidecar is written last: if it exists, the outputs are complete.

    Args:
        snakemake: the object that Snakemake gives to a script.
        part: True if another job assembles the outputs of this one and of others.

    Yields:
        metadata of the sidecar besides files, machine and time; the script adds to it.

    Raises:
        SystemExit: code was edited since, or the Snakemake that started the job was killed.
    """
    started = datetime.now(UTC)
    log, script = Path(snakemake.log[0]), Path(sys.modules["__main__"].__file__ or "")
    with log.open("w", encoding="utf-8") as stream:
        os.dup2(stream.fileno(), 1)
        os.dup2(stream.fileno(), 2)
    lock_job(os.environ.get(INVOCATION))
    code = code_of(script.parents[2], f"workflow/scripts/{script.name}")
    hashed = code_hash(code)
    submitted = json.loads(os.environ.get(SUBMITTED, '{"codes": {}}'))["codes"]
    if submitted.get(script.stem, hashed) != hashed:
        raise SystemExit(
            f"job {script.stem} refused: its code was edited after it was submitted; start again"
        )
    metadata: dict[str, Any] = {"code": hashed, "sources": dict(each.split() for each in code)}
    if part:
        metadata["part"] = True
    yield metadata
    record = Path(snakemake.output.record)
    made = [file for file in snakemake.output if file != str(record)]
    run = log.with_suffix("").as_posix().rpartition("/logs/")[2]
    write_sidecar(record, run, made, snakemake.input, metadata, started)


def write_sidecar(
    record: Path,
    run: str,
    outputs: Iterable[str | Path],
    inputs: Iterable[str | Path],
    metadata: Mapping[str, Any],
    started: datetime,
) -> None:
    """Write the sidecar of the job of this process.

    ``run`` is rule and wildcards, such as "chunk/fig06/0": the path of the log below logs/. Outputs
    and inputs are named by their paths from the folder of ``record``.
    """
    content = {
        **named(run),
        **metadata,
        "inputs": _hashes(inputs, record.parent),
        "outputs": _hashes(outputs, record.parent),
        "started": started.isoformat(timespec="milliseconds"),
        "wall_seconds": round((datetime.now(UTC) - started).total_seconds(), 3),
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
        "invocation": os.environ.get(INVOCATION),
        "host": platform.node(),
        "processor": platform.machine(),
        "versions": versions(),
        "git": git_state(),
    }
    write_json(content, record)


def say(words: str) -> None:
    """Write a line to standard error, if it is open."""
    if sys.stderr is not None:
        sys.stderr.write(f"{words}\n")


def named(run: str) -> dict[str, str | None]:
    """Return the name of a run with the rule and the figure in it."""
    figure = re.search(r"/(fig\d\d)", run)
    rule = run.split("/", maxsplit=1)[0]
    return {"run": run, "rule": rule, "figure": figure[1] if figure else None}


def file_hash(path: Path) -> str:
    """Return the sha256 of a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _hashes(files: Iterable[str | Path], folder: Path) -> dict[str, str]:
    """Return the hashes of files by their paths from ``folder``."""
    return {Path(os.path.relpath(file, folder)).as_posix(): file_hash(Path(file)) for file in files}


def versions() -> dict[str, str]:
    """Return the versions of Python and of the installed packages that results depend on."""
    found = {"python": platform.python_version()}
    for name in ("vibralign", *_TRACKED):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def git_state() -> dict[str, Any]:
    """Return the commit, and whether the checkout differs from it; empty outside a checkout."""

    def git(*arguments: str) -> str:
        # Without the option, a status writes git's index under a lock. A killed job would leave the
        # lock behind, and git would refuse to work in the checkout.
        # A checkout of another owner, as in a container, is asked too: its code runs here anyway.
        trusted = "--no-optional-locks", "-c", "safe.directory=*", "-C", str(_SOURCES)
        own = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
        command = ["git", *trusted, *arguments]
        asked = subprocess.run(command, capture_output=True, text=True, check=True, env=own)
        return asked.stdout.strip()

    changes = "status", "--porcelain", "--", ":(top)", ":(top,exclude)results*"
    try:
        return {"commit": git("rev-parse", "HEAD"), "dirty": bool(git(*changes))}
    except (OSError, subprocess.CalledProcessError):
        return {}


# --- Locks --------------------------------------------------------------------------------------


def _refuse_unsafe(path: Path) -> None:
    """Refuse a file system whose locks other machines do not see."""
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


def lock_folder(name: str, patience: float) -> None:
    """Lock this folder for the invocation ``name``, and wait for jobs of an earlier one to end.

    Jobs compare the name, which is written into the lock, with their own. A process that was just
    killed may still hold the lock: it is tried for ``patience`` seconds.

    Raises:
        TrackingError: another Snakemake runs here, on this machine or on another, or the file
            system has no locks that all machines see.
    """
    _RUN.parent.mkdir(exist_ok=True)
    lock, until = _RUN.open("a+", encoding="utf-8"), time.monotonic() + patience
    _refuse_unsafe(_RUN)
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
    _locks.append(lock)
    lock.truncate(0)
    lock.write(name)
    lock.flush()
    with _JOBS.open("w", encoding="utf-8") as jobs:
        try:
            fcntl.flock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for jobs of an interrupted run to end")
            fcntl.flock(jobs, fcntl.LOCK_EX)


def lock_job(invocation: str | None) -> None:
    """Lock the folder for a job, together with other jobs, until its process ends.

    Raises:
        SystemExit: the invocation that started the job was killed, and another has the folder.
    """
    _JOBS.parent.mkdir(exist_ok=True)
    lock = _JOBS.open("a", encoding="utf-8")
    fcntl.flock(lock, fcntl.LOCK_SH)
    _locks.append(lock)
    now = _RUN.read_text(encoding="utf-8") if _RUN.is_file() else ""
    if invocation and now not in ("", invocation):
        raise SystemExit(f"refused: {invocation}, which started this job, was killed")
