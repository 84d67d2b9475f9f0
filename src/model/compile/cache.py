"""Folder and files of the compiled kernels, and of the sources generated for them.

numba's cache does not notice an edit in another file that a kernel calls. The cache folder is
therefore named by a hash of the code in every file that can hold a kernel.
"""

import ast
import contextlib
import hashlib
import os
import pickle
import platform
import re
import tempfile
import zlib
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import IndexDataCacheFile

from model.compile.outline import outline

PACKAGE = Path(__file__).resolve().parents[1]
_CHECKSUM = 4  # bytes
KERNEL_LAYERS = ("compile", "physics", "events", "engines", "runs")  # folders that hold kernels


def kernel_fingerprint() -> str:
    """Hash of numba's version and the code of every file that can hold a kernel (16 hex digits).

    An edit of comments, layout or docstrings leaves it the same. It is kept on disk under a hash of
    the files' contents, since parsing them takes a second.
    """
    sources = {
        source.relative_to(PACKAGE).as_posix(): source.read_bytes()
        for layer in KERNEL_LAYERS
        for source in sorted((PACKAGE / layer).rglob("*.py"))
    }
    versions = f"{numba.__version__} {platform.python_version()}"
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


def cache_folder() -> Path:
    """Folder of the compiled kernels; ``VIBRALIGN_CACHE`` or ``XDG_CACHE_HOME`` moves it."""
    folder = _base() / kernel_fingerprint()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: use a temporary folder of this user's own
        folder = Path(tempfile.gettempdir()) / f"vibralign-{os.getuid()}" / folder.name
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    return folder


class CheckedFiles(IndexDataCacheFile):
    """The files of one kernel: an index and machine code, each with a checksum in front.

    A damaged file counts as one that is missing: the kernel is compiled and stored again.
    """

    def _stored(self, path: str) -> Any:
        """Return what a file holds, None if it is missing or damaged."""
        with contextlib.suppress(FileNotFoundError):
            content = Path(path).read_bytes()
            if content[:_CHECKSUM] == _checksum(content[_CHECKSUM:]):
                return pickle.loads(content[_CHECKSUM:])  # noqa: S301 - written below
        return None

    def _store(self, path: str, data: Any) -> None:
        content = self._dump(data)
        with self._open_for_write(path) as file:
            file.write(_checksum(content) + content)

    def _load_index(self) -> dict[Any, str]:
        stamp, overloads = self._stored(self._index_path) or (None, {})
        return overloads if stamp == self._source_stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._store(self._index_path, (self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        return self._stored(self._data_path(name))

    def _save_data(self, name: str, data: Any) -> None:
        self._store(self._data_path(name), data)


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(_CHECKSUM, "little")
