"""Files that a command writes at the user's path: checked before anything is computed."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from model.study.files import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Formats of matplotlib that are no pictures, or that need a LaTeX installation.
_NOT_PICTURES = {"pgf", "raw", "rgba"}


def check_file(path: Path, option: str, extensions: Sequence[str]) -> None:
    """Refuse a file that could not be written."""
    if path.suffix.lower().lstrip(".") not in extensions:
        one = "in" if len(extensions) == 1 else "in one of"
        raise ValueError(f"{option} {path}: must end {one} .{', .'.join(extensions)}")
    if not path.parent.is_dir():
        raise ValueError(f"{option} {path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise ValueError(f"{option} {path}: is a folder, must be a file")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ValueError(f"{option} {path}: cannot be written, permission denied")


def check_picture(path: Path) -> None:
    """Refuse a picture that could not be written, before the run is computed."""
    try:
        # Half a second that only a plot is worth, and a package that only a plot needs.
        from matplotlib.backend_bases import FigureCanvasBase  # noqa: PLC0415
    except ImportError:
        raise ValueError(
            "--plot needs matplotlib, which is not installed: pip install 'vibralign[plot]'"
        ) from None
    valid = sorted(set(FigureCanvasBase.get_supported_filetypes()) - _NOT_PICTURES)
    check_file(path, "--plot", valid)


def save_picture(figure: "Figure", path: Path) -> None:
    """Write a figure in the format of the file's extension, whole or not at all."""
    from model.show import style  # noqa: PLC0415  (as in check_picture)

    with whole_file(path) as part, style.context():
        figure.savefig(part, format=path.suffix.lower().lstrip("."))
