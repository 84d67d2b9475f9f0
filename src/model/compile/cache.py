"""Files of machine code, in a folder named by a hash of the compiler.

The name of a file stands for all that its kernel is made of (identity.py). It holds a checksum, a
header and an object. A damaged file counts as one that is missing: its kernel is compiled and
stored again. Where nothing can be written, kernels are compiled for the process alone.
"""

import contextlib
import hashlib
import json
import os
import platform
import tempfile
import zlib
from functools import cache
from pathlib import Path
from typing import Any

from model.compile.code import CHECKED
from model.compile.machine_code import written_for
from model.compile.vector_code import WIDTH

_CHECKSUM = 4  # bytes
_UNWRITTEN: dict[str, tuple[dict[str, Any], bytes]] = {}  # what could not be written
# Read when the compiler is imported: an edit of it later is none of the compiler that runs.
_COMPILER = b"".join(each.read_bytes() for each in sorted(Path(__file__).parent.glob("*.py")))


def compiler_fingerprint() -> str:
    """Hash of the compiler and of what it writes machine code for (16 hex digits)."""
    versions = f"{written_for()} {platform.python_version()} {WIDTH} {CHECKED}"
    return hashlib.sha256(versions.encode() + _COMPILER).hexdigest()[:16]


def _base() -> Path:
    if base := os.environ.get("VIBRALIGN_CACHE"):
        return Path(base)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "vibralign"


@cache
def cache_folder() -> Path:
    """Folder of the machine code; ``VIBRALIGN_CACHE`` or ``XDG_CACHE_HOME`` moves it."""
    name = compiler_fingerprint()
    try:
        folder = _base() / name
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # a read-only home, or none: a temporary folder of this user's
        own = Path(tempfile.gettempdir()) / f"vibralign-{os.getuid()}"
        own.mkdir(exist_ok=True, mode=0o700)
        if own.lstat().st_uid != os.getuid() or own.lstat().st_mode & 0o022:
            own = Path(tempfile.mkdtemp())  # machine code that others can write is not loaded
        folder = own / name
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
