"""Files of machine code, in a folder named by a hash of the package's code.

A file holds a checksum, a header and an object. A damaged file counts as one that is missing: its
kernel is compiled and stored again. Where nothing can be written, kernels are compiled for the
process alone.
"""

import ast
import contextlib
import hashlib
import json
import os
import platform
import re
import tempfile
import zlib
from functools import cache
from pathlib import Path
from typing import Any

from model.compile.identity import PACKAGE
from model.compile.machine_code import written_for
from model.compile.outline import outline

_CHECKSUM = 4  # bytes
_UNWRITTEN: dict[str, tuple[dict[str, Any], bytes]] = {}  # what could not be written
KERNEL_LAYERS = ("compile", "physics", "events", "engine", "runs")  # folders that hold kernels


def kernel_fingerprint() -> str:
    """Hash of the processor and the code of every file that can hold a kernel (16 hex digits).

    An edit of comments, layout or docstrings leaves it the same. It is kept on disk under a hash of
    the files' contents, since parsing them takes a second.
    """
    sources = {
        source.relative_to(PACKAGE).as_posix(): source.read_bytes()
        for layer in KERNEL_LAYERS
        for source in sorted((PACKAGE / layer).rglob("*.py"))
    }
    versions = f"{written_for()} {platform.python_version()}"
    contents = hashlib.sha256(f"{versions}{[*sources.items()]}".encode()).hexdigest()
    kept = _base() / "fingerprints" / contents
    with contextlib.suppress(OSError, UnicodeDecodeError):
        if re.fullmatch("[0-9a-f]{16}", found := kept.read_text(encoding="ascii")):
            return found
    digest = hashlib.sha256(versions.encode())
    for name, source in sources.items():
        digest.update(f"{name}{outline(ast.parse(source), [])}".encode())
    with contextlib.suppress(OSError):
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(digest.hexdigest()[:16])
    return digest.hexdigest()[:16]


def _base() -> Path:
    if base := os.environ.get("VIBRALIGN_CACHE"):
        return Path(base)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "vibralign"


@cache
def cache_folder() -> Path:
    """Folder of the machine code; ``VIBRALIGN_CACHE`` or ``XDG_CACHE_HOME`` moves it."""
    folder = _base() / kernel_fingerprint()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: use a temporary folder of this user's own
        own = Path(tempfile.gettempdir()) / f"vibralign-{os.getuid()}"
        own.mkdir(exist_ok=True, mode=0o700)
        if own.lstat().st_uid != os.getuid() or own.lstat().st_mode & 0o022:
            own = Path(tempfile.mkdtemp())  # machine code that others can write is not loaded
        folder = own / folder.name
        folder.mkdir(exist_ok=True)
    return folder


def read(name: str) -> tuple[dict[str, Any], bytes] | None:
    """Return header and object stored under a name; None if they are missing or damaged."""
    if name in _UNWRITTEN:
        return _UNWRITTEN[name]
    with contextlib.suppress(OSError):
        content = _path(name).read_bytes()
        body = content[_CHECKSUM:]
        if content[:_CHECKSUM] == _checksum(body):
            header, _, stored = body.partition(b"\n")
            return json.loads(header), stored
    return None


def write(name: str, header: dict[str, Any], stored: bytes) -> None:
    """Store a header and an object under a name, whole or not at all."""
    body = json.dumps(header).encode() + b"\n" + stored
    path = _path(name)
    made = path.with_name(f".{name}-{os.getpid()}")
    try:
        made.write_bytes(_checksum(body) + body)
        made.replace(path)
    except OSError:
        _UNWRITTEN[name] = header, stored
        with contextlib.suppress(OSError):
            made.unlink(missing_ok=True)


def _path(name: str) -> Path:
    return cache_folder() / f"{name}.o"


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(_CHECKSUM, "little")
