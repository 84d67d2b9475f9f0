"""Write files that appear whole or not at all."""

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Yield a path beside ``target`` that replaces it when the block ends.

    If the block fails, ``target`` stays as it was and the new file is removed.

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
