"""Atomic writing of files: a file is replaced when it is complete, or stays as it was."""

import contextlib
import json
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


@contextlib.contextmanager
def atomic_write(target: Path) -> Iterator[Path]:
    """Yield the path of a temporary file, which replaces ``target`` when the block ends.

    If the block raises, ``target`` stays as it was and the temporary file is removed.

    Raises:
        OSError: the folder cannot be created or written.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(
        dir=target.parent, prefix=f".{target.name}-", suffix=".part", delete=False
    ) as made:
        part = Path(made.name)
    try:
        yield part
        part.chmod(0o644)  # a temporary file is created for its owner only
        part.replace(target)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def write_text(text: str, path: Path) -> None:
    """Write ``text`` atomically."""
    with atomic_write(path) as part:
        part.write_text(text, encoding="utf-8")


def write_json(record: Mapping[str, Any], path: Path) -> None:
    """Write ``record`` as JSON, atomically."""
    write_text(json.dumps(record, indent=1, sort_keys=True) + "\n", path)
