"""Folder of the compiled kernels and of the sources generated for them.

numba's cache does not notice an edit in another file that a kernel calls. The cache folder is
therefore named by a hash of the code in every file that can hold a kernel.
"""

import ast
import contextlib
import hashlib
import os
import platform
import tempfile
from pathlib import Path

import numba

from model.compile.outline import outline

PACKAGE = Path(__file__).resolve().parents[1]
KERNEL_LAYERS = ("compile", "physics", "events", "engines", "runs")


def kernel_fingerprint() -> str:
    """Hash of numba's version and the code of every file that can hold a kernel (16 hex digits).

    An edit of comments, layout or docstrings keeps it. It is kept on disk by the files' contents,
    since parsing them takes a second.
    """
    sources = {
        source.relative_to(PACKAGE).as_posix(): source.read_bytes()
        for layer in KERNEL_LAYERS
        for source in sorted((PACKAGE / layer).rglob("*.py"))
    }
    versions = f"{numba.__version__} {platform.python_version()}"
    contents = hashlib.sha256(f"{versions}{[*sources.items()]}".encode()).hexdigest()
    kept = _base() / "fingerprints" / contents
    with contextlib.suppress(OSError):
        if len(found := kept.read_text()) == 16:
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
