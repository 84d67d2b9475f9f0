"""Hashes of the code that results depend on: one for each file that a script imports.

A file is hashed by its syntax tree, so that an edit of comments, layout or docstrings reruns
nothing. Snakemake does not look into imported files; the rules give it these hashes as params.
"""

import ast
import contextlib
import hashlib
import platform
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from model.compile.cache import cache_folder
from model.sweeps.files import write_text
from study import outline as outlined
from study.outline import outline

_SOURCES = Path(__file__).resolve().parents[2]
_PACKAGES = ("model", "vibralign", "study")  # in the folder of the sources
_BESIDE = ("verification",)  # packages of the checkout
_RECORDS = ["study", "tracking"]  # not hashed: recording a job changes none of its results


def _module_file(name: str) -> Path | None:
    """Return the source of a module of this project, or None."""
    parts = name.split(".")
    if parts[0] in _PACKAGES and parts[:2] != _RECORDS:
        base = _SOURCES.joinpath(*parts)
    elif parts[0] in _BESIDE:
        base = _SOURCES.parent.joinpath(*parts)
    else:
        return None
    candidates = (base.with_suffix(".py"), base / "__init__.py")
    return next((file for file in candidates if file.is_file()), None)


_KEPT = re.compile(r"[0-9a-f]{64}(?: [\w.]+)*\n")  # hash and imports; no damaged file matches
_COMPANIONS = {".j2", ".yaml", ".csv", ".html", ".js", ".css"}


@cache
def _parsed(source: Path) -> tuple[str, tuple[Path, ...]]:
    """Return the hash of a source file with its companions, and the project files it imports.

    A companion is a template, table, script or style beside the source and named after it:
    page.html.j2, claims.yaml, page.map.js. Results are cached on disk by the files' contents, since
    every start of Snakemake and of a job needs them.
    """
    beside = sorted(path for path in source.parent.glob(f"{source.stem}.*")
                    if path.suffix in _COMPANIONS)  # fmt: skip
    code, *companions = (path.read_bytes() for path in (source, *beside))
    kept = _outlines() / hashlib.sha256(b"\0".join([code, *companions])).hexdigest()
    try:
        whole = _KEPT.fullmatch(kept.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError):
        whole = None
    if whole:
        hashed, *imported = whole[0].split()
    else:
        imported = []
        digest = hashlib.sha256(repr(outline(ast.parse(code), imported)).encode())
        for companion in companions:
            digest.update(companion)
        hashed = digest.hexdigest()
        with contextlib.suppress(OSError):
            write_text(" ".join([hashed, *imported]) + "\n", kept)
    files = (_module_file(name) for name in imported)
    return hashed, tuple(file for file in files if file)


@cache
def _outlines() -> Path:
    """Return the cache folder of ``_parsed``, by the version of Python and the code of both."""
    made_by = b"".join(Path(file).read_bytes() for file in (__file__, outlined.__file__))
    made_by += platform.python_version().encode()
    return cache_folder().parent / f"outlines-{hashlib.sha256(made_by).hexdigest()[:16]}"


def import_closure(*sources: Path) -> list[Path]:
    """Return ``sources`` and every file of this project that they import, directly or not, sorted.

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


def code_of(project: Path, source: str) -> list[str]:
    """Return "FILE HASH" for the lock file, a source file and all files of the project it imports.

    ``source`` is a path below ``project``. Names of files do not depend on where the package and
    the project are installed.
    """
    roots = (_SOURCES, project.resolve(), _SOURCES.parent)

    def name(file: Path) -> str:
        root = next(root for root in roots if file.is_relative_to(root))
        return file.relative_to(root).as_posix()

    files = import_closure(project / source)
    pins = hashlib.sha256((project / "requirements.lock").read_bytes()).hexdigest()
    named = sorted(f"{name(file)} {_parsed(file)[0][:12]}" for file in files)
    return [f"requirements.lock {pins[:12]}", *named]


def code_hash(code: Sequence[str]) -> str:
    """Return a single hash of the list that ``code_of`` returns."""
    return hashlib.sha256("\n".join(code).encode()).hexdigest()[:16]
