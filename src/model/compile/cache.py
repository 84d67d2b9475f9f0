"""Folder of the compiled kernels and of the sources generated for them.

numba's cache does not notice an edit in another file that a kernel calls. The cache folder is
therefore named by a hash of every file that can hold a kernel.
"""

import contextlib
import hashlib
import os
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numba

PACKAGE = Path(__file__).resolve().parents[1]
KERNEL_LAYERS = ("compile", "physics", "events", "engines", "runs")


def kernel_fingerprint() -> str:
    """Hash of numba's version and every source file that can hold a kernel (16 hex digits)."""
    digest = hashlib.sha256(numba.__version__.encode())
    for layer in KERNEL_LAYERS:
        for source in sorted((PACKAGE / layer).rglob("*.py")):
            digest.update(source.relative_to(PACKAGE).as_posix().encode())
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Folder of the compiled kernels; ``VIBRALIGN_CACHE`` or ``XDG_CACHE_HOME`` moves it."""
    base = os.environ.get("VIBRALIGN_CACHE")
    if base is None:
        home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        base = str(Path(home) / "vibralign")
    folder = Path(base) / kernel_fingerprint()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: use a temporary folder of this user's own
        folder = Path(tempfile.gettempdir()) / f"vibralign-{os.getuid()}" / folder.name
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    return folder


config: Any = numba.config  # its settings are set at import, unseen by type checkers
_CACHE_SETTING = threading.Lock()


@contextlib.contextmanager
def numba_cache_in(folder: str) -> Iterator[None]:
    """Set numba's cache folder while a function is decorated; other users of numba keep theirs.

    The lock serialises threads that call kernels first at the same time.
    """
    with _CACHE_SETTING:
        previous = config.CACHE_DIR
        config.CACHE_DIR = folder
        try:
            yield
        finally:
            config.CACHE_DIR = previous
