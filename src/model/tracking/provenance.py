"""Provenance of results: hashes of the code they depend on, and a sidecar for every job."""

import ast
import contextlib
import hashlib
import importlib.metadata
import json
import os
import platform
import resource
import subprocess
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from model.compile.cache import cache_folder
from model.study.files import whole_file

_PACKAGE = Path(__file__).resolve().parents[1]
# Environment variable with the name of the invocation that started a job.
INVOCATION = "VIBRALIGN_INVOCATION"
# Environment variable with what its jobs run: hashes of the study and of each job's code, as JSON.
SUBMITTED = "VIBRALIGN_SUBMITTED"
_TRACKED = ("numpy", "scipy", "numba", "xarray", "netCDF4", "matplotlib", "snakemake")


def _module_file(name: str) -> Path | None:
    """Return the source of a module of the package or of what the checkout adds, or None."""
    checkout = _PACKAGE.parents[1]
    folders = {_PACKAGE.name: _PACKAGE.parent, "verification": checkout, "benchmarks": checkout}
    folder = folders.get(name.split(".", maxsplit=1)[0])
    if folder is None:
        return None
    base = folder.joinpath(*name.split("."))
    for candidate in (base.with_suffix(".py"), base / "__init__.py"):
        if candidate.is_file():
            return candidate
    return None


_WITH_DOCSTRING = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def _outline(node: Any, imported: list[str]) -> list[Any]:
    """Return ``node`` with all below it as nested lists, without places in the file and docstrings.

    Names of modules that are imported, as far as they can be modules of this package, are added to
    ``imported``.
    """
    kind = node.__class__
    fields: list[Any] = [kind.__name__]
    for name in kind._fields:
        value = getattr(node, name, None)
        if value.__class__ is list:
            if name == "body" and kind in _WITH_DOCSTRING and ast.get_docstring(node, clean=False):
                value = value[1:]
            value = [_outline(v, imported) if isinstance(v, ast.AST) else v for v in value]
        elif isinstance(value, ast.AST):
            value = _outline(value, imported)
        fields.append(value)
    if kind is ast.Import:
        imported += [alias.name for alias in node.names]
    elif kind is ast.ImportFrom and node.module and node.level == 0:
        imported += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return fields


_COMPANIONS = {".j2", ".yaml", ".html", ".js", ".css"}


@cache
def _parsed(source: Path) -> tuple[str, tuple[Path, ...]]:
    """Return (hash of the syntax tree and companions, package files imported) of one source file.

    A companion is a template, table, script or style beside the source with its stem: page.html.j2,
    claims.yaml, page.map.js.
    The result is kept by the files' contents, since each start of Snakemake and of a job needs it.
    """
    beside = sorted(path for path in source.parent.glob(f"{source.stem}.*")
                    if path.suffix in _COMPANIONS)  # fmt: skip
    code, *companions = (path.read_bytes() for path in (source, *beside))
    kept = _outlines() / hashlib.sha256(b"\0".join([code, *companions])).hexdigest()
    try:
        hashed, *imported = kept.read_text(encoding="utf-8").split()
    except (OSError, ValueError):
        imported = []
        digest = hashlib.sha256(repr(_outline(ast.parse(code), imported)).encode())
        for companion in companions:
            digest.update(companion)
        hashed = digest.hexdigest()
        with contextlib.suppress(OSError):
            write_text(" ".join([hashed, *imported]), kept)
    files = (_module_file(name) for name in imported)
    return hashed, tuple(file for file in files if file)


@cache
def _outlines() -> Path:
    """Return the folder that keeps what ``_parsed`` finds, by Python's version and this code."""
    made_by = Path(__file__).read_bytes() + platform.python_version().encode()
    return cache_folder().parent / f"outlines-{hashlib.sha256(made_by).hexdigest()[:16]}"


def import_closure(*sources: Path) -> list[Path]:
    """Return ``sources`` and every file of this package that they import, directly or not, sorted.

    A package's ``__init__`` counts only if names are imported from it.
    """
    found: set[Path] = set()
    waiting = [source.resolve() for source in sources]
    while waiting:
        file = waiting.pop()
        if file not in found:
            found.add(file)
            waiting.extend(_parsed(file)[1])
    return sorted(found)


def closure_hash(*sources: Path) -> str:
    """Return a hash of the code that ``sources`` run: syntax trees of their import closure.

    Comments, layout and docstrings do not count, so that a reformat reruns nothing; neither does
    the place of script and package, which may be installed in different folders.
    """
    parts = sorted(file.name + _parsed(file)[0] for file in import_closure(*sources))
    return hashlib.sha256("".join(parts).encode()).hexdigest()[:16]


@cache
def _lock_hash(project: Path) -> str:
    return file_hash(project / "requirements.lock")


def code_hash(project: Path, *sources: str) -> str:
    """Return a hash of the import closure of ``sources`` and of the pinned packages.

    ``project`` is the folder that holds requirements.lock, ``sources`` are paths below it.
    """
    combined = closure_hash(*(project / source for source in sources)) + _lock_hash(project)
    return hashlib.sha256(combined.encode()).hexdigest()[:16]


def announce(study: str, codes: Mapping[str, str]) -> None:
    """Pass to the jobs that this process starts or submits the hashes of what they are to run.

    Args:
        study: hash of the configuration.
        codes: ``code_hash`` of each job, by its name.
    """
    os.environ[SUBMITTED] = json.dumps({"study": study, "codes": dict(codes)})


def edited_since(study: str, name: str, code: str) -> str | None:
    """Return what of a job is not as the process that submitted it announced, or None."""
    announced = json.loads(os.environ.get(SUBMITTED, "null"))
    if announced and announced["codes"].get(name, code) != code:
        return "code"
    if announced and announced["study"] != study:
        return "configuration"
    return None


def file_hash(path: Path) -> str:
    """Return the sha256 of a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _hashes(files: Sequence[Path], folder: Path) -> dict[str, str]:
    """Return ``file_hash`` of every file, by its path from ``folder``."""
    return {Path(os.path.relpath(file, folder)).as_posix(): file_hash(file) for file in files}


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


class Job:
    """One job of the study, from its start to the sidecar that it leaves.

    Make it first, ``finish`` it last: a sidecar on disk says that the job's outputs are whole.

    Args:
        place: the job's rule and wildcards, such as "chunk", "fig06", 0. Joined by slashes they
            are the run's name, and the name of its log below logs/.
        sources: the files whose import closure is the job's code.
    """

    def __init__(self, *place: str | int, sources: Sequence[Path] = ()) -> None:
        self.place = tuple(str(part) for part in place)
        self.sources = sources
        self.started = datetime.now(UTC)

    def finish(
        self, record: Path, outputs: Sequence[Path], inputs: Sequence[Path] = (), **facts: Any
    ) -> None:
        """Write the sidecar ``record``: outputs, inputs, code, machine and time of the job.

        Args:
            record: the file to write.
            outputs: the files that the job made.
            inputs: the files that it read, besides code and configuration. All are named by their
                paths from the folder of ``record``.
            facts: what else is known: parameters, settings, counts.
        """
        rule, *rest = self.place
        content = {
            "run": "/".join(self.place),
            "rule": rule,
            "figure": next((part for part in rest if part.startswith("fig")), None),
            **facts,
            "code": closure_hash(*self.sources) if self.sources else None,
            "inputs": _hashes(inputs, record.parent),
            "outputs": _hashes(outputs, record.parent),
            "started": self.started.isoformat(timespec="milliseconds"),
            "wall_seconds": round((datetime.now(UTC) - self.started).total_seconds(), 3),
            "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
            "invocation": os.environ.get(INVOCATION),
            "host": platform.node(),
            "processor": platform.machine(),
            "versions": versions(),
            "git": git_state(),
        }
        write_json(content, record)


def write_json(record: Mapping[str, Any], path: Path) -> None:
    """Write ``record`` as JSON, whole or not at all."""
    write_text(json.dumps(record, indent=1, sort_keys=True) + "\n", path)


def write_text(text: str, path: Path) -> None:
    """Write ``text``, whole or not at all."""
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")
