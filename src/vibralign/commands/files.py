"""Files that a command writes at the user's path: checked before anything is computed."""

import contextlib
import os
import stat
from collections.abc import Iterator, Sequence
from pathlib import Path

from model.sweeps.files import check_encoding

# Formats of matplotlib that are no pictures, or that need a LaTeX installation.
_NOT_PICTURES = {"pgf", "raw", "rgba"}


class WriteError(Exception):
    """A file of the user that could not be written, after all was computed: exit code 1."""


@contextlib.contextmanager
def writing(option: str = "", errors: tuple[type[Exception], ...] = (OSError,)) -> Iterator[None]:
    """Turn one of ``errors`` into a ``WriteError`` that names the ``option``."""
    try:
        yield
    except errors as error:
        raise WriteError(f"{option}: {error}" if option else str(error)) from None


def check_file(path: Path, option: str, extensions: Sequence[str]) -> None:
    """Refuse a file that could not be written.

    Raises:
        ValueError: another extension, a missing folder, a folder of this name, or no permission.
    """
    if path.suffix.lower().lstrip(".") not in extensions:
        one = "in" if len(extensions) == 1 else "in one of"
        raise ValueError(f"{option} {path}: must end {one} .{', .'.join(extensions)}")
    try:
        os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError as error:  # such as a name that is too long
        raise ValueError(f"{option} {path}: {error.strerror}") from None
    if not path.parent.is_dir():
        raise ValueError(f"{option} {path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise ValueError(f"{option} {path}: is a folder, must be a file")
    try:
        real = path.resolve(strict=False)
        mode = real.stat().st_mode if real.exists() or real.is_symlink() else stat.S_IFREG
    except (OSError, RuntimeError):  # RuntimeError: Python 3.11 and 3.12, a loop
        raise ValueError(f"{option} {path}: is a link that leads nowhere: delete it") from None
    if not stat.S_ISREG(mode):
        raise ValueError(f"{option} {path}: is no regular file but a device or a pipe; name a file")
    if not real.parent.is_dir():
        raise ValueError(f"{option} {path}: a link into {real.parent}, which does not exist")
    if not all(os.access(each, os.W_OK) for each in (real, real.parent) if each.exists()):
        raise ValueError(f"{option} {path}: cannot be written, permission denied")
    if "nc" in extensions:
        check_encoding(path)


def check_picture(path: Path, option: str = "--plot") -> None:
    """Refuse a picture that could not be written.

    Raises:
        ValueError: matplotlib has no such format, or the file cannot be written.
    """
    # Imported here: half a second that only plots need.
    from matplotlib.backend_bases import FigureCanvasBase  # noqa: PLC0415

    valid = sorted(set(FigureCanvasBase.get_supported_filetypes()) - _NOT_PICTURES)
    check_file(path, option, valid)
