"""Options that several commands of the study share."""

from pathlib import Path
from typing import Any

from model.physics.parameters import check_name
from study.config import Study


def add_root(
    parser: Any, words: str = "results root with the history", default: str = "results"
) -> None:
    """Add --root; ``words`` say which results root it is."""
    words = f"{words} (default: {default})"
    parser.add_argument("--root", type=Path, default=Path(default), metavar="DIR", help=words)


def figure_name(text: str, study: Study) -> str:
    """Return the name of a figure, ``fig06``, given as fig06, 06 or 6.

    Raises:
        ValueError: the study has no such figure.
    """
    name = f"fig{int(text):02}" if text.isdecimal() else text
    check_name(name, sorted(study.figures), "figure")
    return name
