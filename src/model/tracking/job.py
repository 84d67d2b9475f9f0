"""Jobs of the study: what each script of the workflow does around its work.

``recorded`` sends what a script prints to its log, refuses code that was edited after the job was
submitted, and leaves a sidecar: what the job made, from what, and that it is whole.
"""

import contextlib
import hashlib
import importlib.metadata
import json
import os
import platform
import resource
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from model.study.files import write_json
from model.tracking import TrackingError
from model.tracking.code import code_hash, code_of
from model.tracking.lock import hold_job

# Environment variables by which Snakemake tells its jobs, on whatever machine, who started them,
# and the hashes of the configuration and of each script's code at that time.
INVOCATION, SUBMITTED = "VIBRALIGN_INVOCATION", "VIBRALIGN_SUBMITTED"
_PACKAGE = Path(__file__).resolve().parents[1]
_TRACKED = ("numpy", "scipy", "numba", "xarray", "netCDF4", "matplotlib", "snakemake")
# What Snakemake gives to a script, under this name; None in any other process.
snakemake: Any = getattr(sys.modules["__main__"], "snakemake", None)


def announce(study: str, codes: Mapping[str, str]) -> None:
    """Tell the jobs that this process starts what they are to run.

    Args:
        study: the configuration, as text.
        codes: ``code_hash`` of each script, by its name.

    Raises:
        TrackingError: this process runs a job of another, and the configuration was edited since.
    """
    now = hashlib.sha256(study.encode()).hexdigest()[:16]
    told = os.environ.setdefault(SUBMITTED, json.dumps({"study": now, "codes": dict(codes)}))
    if json.loads(told)["study"] != now:
        raise TrackingError(
            "refused: the configuration was edited after the job was submitted; start again"
        )


@contextlib.contextmanager
def recorded(snakemake: Any, *, part: bool = False) -> Iterator[dict[str, Any]]:
    """Run the work of a script: its log, the refusal of edited code, its sidecar.

    The sidecar is written last: where it is, the job's outputs are whole.

    Args:
        snakemake: what Snakemake gives to a script.
        part: True if the job's outputs are parts of another's.

    Yields:
        what the sidecar states besides files, machine and time; the work adds to it.

    Raises:
        SystemExit: code that was edited, or a job whose Snakemake was killed before it began.
    """
    log, script = Path(snakemake.log[0]), Path(sys.modules["__main__"].__file__ or "")
    with log.open("w", encoding="utf-8") as stream:
        os.dup2(stream.fileno(), 1)
        os.dup2(stream.fileno(), 2)
    hold_job(os.environ.get(INVOCATION))
    code = code_of(script.parents[2], f"workflow/scripts/{script.name}")
    hashed = code_hash(code)
    submitted = json.loads(os.environ.get(SUBMITTED, '{"codes": {}}'))["codes"]
    if submitted.get(script.stem, hashed) != hashed:
        raise SystemExit(
            f"job {script.stem} refused: its code was edited after it was submitted; start again"
        )
    facts: dict[str, Any] = {"code": hashed, "sources": dict(each.split() for each in code)}
    if part:
        facts["part"] = True
    yield facts
    record = Path(snakemake.output.record)
    made = [file for file in snakemake.output if file != str(record)]
    run = log.with_suffix("").as_posix().rpartition("/logs/")[2]
    # Snakemake writes the script anew before it starts a job, so that the imports count.
    started = datetime.fromtimestamp(Path(sys.argv[0]).stat().st_mtime, UTC)
    write_sidecar(record, run, made, snakemake.input, facts, started)


def write_sidecar(
    record: Path,
    run: str,
    outputs: Iterable[str | Path],
    inputs: Iterable[str | Path],
    facts: Mapping[str, Any],
    started: datetime,
) -> None:
    """Write the sidecar of the job of this process.

    Args:
        record: the file to write. Outputs and inputs are named by their paths from its folder.
        run: the rule and its wildcards, such as "chunk/fig06/0": the job's log below logs/.
        outputs: the files that the job made.
        inputs: the files that it read, besides code and configuration.
        facts: what else is known: code, parameters, settings, counts.
        started: when the job began.
    """
    rule, *rest = run.split("/")
    content = {
        "run": run,
        "rule": rule,
        "figure": next((part for part in rest if part.startswith("fig")), None),
        **facts,
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


def file_hash(path: Path) -> str:
    """Return the sha256 of a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _hashes(files: Iterable[str | Path], folder: Path) -> dict[str, str]:
    """Return ``file_hash`` of every file, by its path from ``folder``."""
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


def version() -> str:
    """Return the version of this package."""
    try:
        return importlib.metadata.version("vibralign")
    except importlib.metadata.PackageNotFoundError:
        return "(not installed)"


def git_state() -> dict[str, Any]:
    """Return the commit of the checkout and whether it has changes; empty outside a checkout."""

    def git(*arguments: str) -> str:
        # Only looking: a status that refreshes the index holds a lock, which would stay behind
        # where a job is killed, and stop whoever works in the checkout.
        command = ["git", "--no-optional-locks", "-C", str(_PACKAGE.parent), *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    try:
        return {"commit": git("rev-parse", "HEAD"), "dirty": bool(git("status", "--porcelain"))}
    except (OSError, subprocess.CalledProcessError):
        return {}
