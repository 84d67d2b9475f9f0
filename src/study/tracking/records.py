"""The record that a job leaves beside its results, and the look at whether they still fit it.

A run is a job of one start. Its name is the path of its log below ``logs/``: "chunk/fig06/0". Its
record, a file ``*.run.json``, is an output of its rule and is written last, so that the outputs are
complete if it exists. It holds what the run was made from and what it made: the hashes of its
code, of its configuration, of its inputs and of its outputs; its start, time and memory; host,
processor, versions of packages and state of the checkout.
"""

import contextlib
import hashlib
import json
import os
import platform
import re
import resource
import sys
from collections.abc import Iterable, Iterator, Set
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from model.sweeps.files import write_json
from study.tracking import TrackingError
from study.tracking.code import code_hash, code_of
from study.tracking.locks import hold_as_job

Record = dict[str, Any]

# The environment variable by which a start tells its jobs, on any machine: its number, the hashes
# of configuration and scripts' code, the versions of packages and the state of the checkout.
START = "VIBRALIGN_START"
_KEYS = {"run", "rule", "start", "inputs", "outputs"}
# The object ``snakemake`` that Snakemake gives to a script; None in any other process.
snakemake: Any = getattr(sys.modules["__main__"], "snakemake", None)


# --- Writing ------------------------------------------------------------------------------------


@contextlib.contextmanager
def recorded(snakemake: Any, *, part: bool = False) -> Iterator[Record]:
    """Send the output of a script to its log, and write the record of its run.

    Its record in the history is there from its begin, and tells how it ended; the one beside its
    outputs is the last that it writes.

    Args:
        snakemake: the object that Snakemake gives to a script.
        part: True if another job assembles the outputs of this one and of others.

    Yields:
        Entries of the record, to which the script adds.

    Raises:
        SystemExit: the job belongs to no start, its start was killed, or its code was edited since.
    """
    began = datetime.now(UTC)
    log, script = Path(snakemake.log[0]), Path(sys.modules["__main__"].__file__ or "")
    start = json.loads(os.environ.get(START, '{"start": null}'))
    with log.open("w", encoding="utf-8") as stream:
        os.dup2(stream.fileno(), 1)
        os.dup2(stream.fileno(), 2)
    record = Path(snakemake.output.record)
    run = log.with_suffix("").as_posix().rpartition("/logs/")[2]
    if start["start"] is None:
        raise SystemExit(f"{run} refused: only a start of the study runs its jobs: snakemake")
    root = Path(str(log).removesuffix(f"/logs/{run}.log"))
    hold_as_job(root, start["start"])
    kept = root / "history" / str(start["start"]) / f"{run}.json"
    known = {**named(run), "start": start["start"], "started": iso(began), "git": start["git"]}
    write_json({**known, "status": "running"}, kept)
    try:
        code = code_of(script.parents[2], f"workflow/scripts/{script.name}")
        if start["codes"].get(script.stem, code_hash(code)) != code_hash(code):
            words = "its code was edited after the start; start again"
            raise SystemExit(f"{run} refused: {words}")  # noqa: TRY301 - recorded below
        added: Record = {"code": code_hash(code), "sources": dict(each.split() for each in code)}
        if part:
            added["part"] = True
        yield added
        made = (each for each in snakemake.output if each != str(record))
        content = {
            **added,
            **known,
            "stated": stated_hash(snakemake.params),
            "inputs": _hashes(snakemake.input, record.parent),
            "outputs": _hashes(made, record.parent),
            "wall_seconds": round((datetime.now(UTC) - began).total_seconds(), 3),
            "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
            "host": platform.node(),
            "processor": platform.machine(),
            "versions": start["versions"],
        }
        write_json({**content, "status": "done"}, kept)
        write_json(content, record)
    except BaseException as error:
        status = "interrupted" if isinstance(error, KeyboardInterrupt) else "failed"
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        with contextlib.suppress(OSError):  # on a full disk
            write_json({**known, "status": status, "reason": reason}, kept)
        raise


def iso(moment: datetime) -> str:
    """Return a moment in the form that all records use: ISO 8601 with milliseconds."""
    return moment.isoformat(timespec="milliseconds")


def named(run: str) -> dict[str, str | None]:
    """Return the name of a run with the rule and the figure in it.

    The figure of "plot/fig13_round" is "fig13_round", which is a map of its own.
    """
    rule, *rest = run.split("/")
    figure = next((part for part in rest if re.match(r"fig\d\d", part)), None)
    return {"run": run, "rule": rule, "figure": figure and figure.removesuffix("_vibration")}


def stated_hash(params: Any) -> str:
    """Return a hash of the configuration of a job: of the params that have a name.

    Params without a name are the hashes of its code.
    """
    text = json.dumps(dict(params.items()), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def file_hash(path: Path) -> str:
    """Return the sha256 of a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _hashes(files: Iterable[str], folder: Path) -> dict[str, str]:
    """Return the hashes of files by their paths from ``folder``."""
    return {Path(os.path.relpath(file, folder)).as_posix(): file_hash(Path(file)) for file in files}


# --- Reading ------------------------------------------------------------------------------------


def read_record(path: Path, keys: Set[str] = frozenset(_KEYS)) -> Record:
    """Read the record of a run, or of a start with other ``keys``.

    Raises:
        TrackingError: the file is no record.
    """
    try:
        record = {**json.loads(path.read_text(encoding="utf-8"))}
        if missing := keys - set(record):
            raise ValueError(f"without {', '.join(sorted(missing))}")  # noqa: TRY301 - see below
    except (OSError, ValueError, TypeError) as error:
        raise TrackingError(f"{path}: cannot be read as a record ({error}): delete it") from None
    return record


def records(root: Path) -> list[Record]:
    """Return the records below a results root, in the order of their paths.

    ``folder`` is added to each: the folder from which its inputs and outputs are named. Folders
    that are links are followed.

    Raises:
        TrackingError: a folder cannot be listed, or a file is no record.
    """

    def refuse(error: OSError) -> None:
        raise TrackingError(f"{root}: its records cannot be read ({error})")

    found: list[Path] = []
    for folder, inside, names in os.walk(root, followlinks=True, onerror=refuse):
        here = Path(folder)
        if here == root:
            inside[:] = set(inside) - {"history", "logs"}
        found += [here / name for name in names if name.endswith(".run.json")]
    return [{**read_record(path), "folder": str(path.parent)} for path in sorted(found)]


def files_of(record: Record, kind: str) -> dict[Path, str]:
    """Return the hashes of the "inputs" or "outputs" of a run by path; ``..`` follows no link."""
    return {
        Path(os.path.normpath(Path(record["folder"], name))): sha256
        for name, sha256 in record[kind].items()
    }


def changed_inputs(record: Record) -> list[Path]:
    """Return the inputs of a run that are there and are not those that it read."""
    inputs = files_of(record, "inputs").items()
    return [path for path, sha256 in inputs if path.exists() and file_hash(path) != sha256]


# --- The look -----------------------------------------------------------------------------------


def look(jobs: Iterable[Any]) -> None:
    """Refuse results that are not what their records say.

    Args:
        jobs: Snakemake's jobs that it takes for done: it would build on their outputs as they are.

    Raises:
        TrackingError: a line for each file that is not as its job left it, has no record, or was
            made from other inputs, code or configuration; or files cannot be read, so that nobody
            knows.
    """
    try:
        faults = [fault for job in jobs for fault in _faults(job)]
    except OSError as error:
        raise TrackingError(f"the results cannot be checked: {error}: mend that first") from None
    if faults:
        shown = faults[:_SHOWN] + [f"and {len(faults) - _SHOWN} more"] * (len(faults) > _SHOWN)
        raise TrackingError(
            "\n".join(["results are not what their records say; nothing was computed", *shown])
            + "\nPut back what was there, or delete these files: the next start makes them anew."
        )


_SHOWN = 20


def _faults(job: Any) -> Iterator[str]:
    """Yield what is wrong with the outputs of a job and its record."""
    place = Path(job.output.record)
    there = [Path(each) for each in job.output if Path(each) != place and os.path.lexists(each)]
    if not there:
        return
    if not place.exists():
        yield from (f"{path}: has no record ({place})" for path in there)
        return
    try:
        record = {**read_record(place), "folder": str(place.parent)}
    except TrackingError as fault:
        yield str(fault)
        return
    made = files_of(record, "outputs")
    for path in there:
        if not path.exists():
            yield f"{path}: is a link to nothing"
        elif made.get(Path(os.path.normpath(path))) != file_hash(path):
            yield f"{path}: is not the file that its job left"
    yield from (f"{there[0]}: was made from another {path}" for path in changed_inputs(record))
    unnamed = len(job.params) - len(dict(job.params.items()))  # these come first: the code
    now = {"code": code_hash(job.params[:unnamed]), "stated": stated_hash(job.params)}
    for what, words in (("code", "code"), ("stated", "configuration")):
        if record.get(what) != now[what]:
            yield f"{there[0]}: was made with another {words}, which Snakemake was told to overlook"
