"""The commands of the study: ``python -m study``."""

import sys

from study.commands import claims, reference, tracking
from vibralign.commands.program import DONE, FAILED, INTERRUPTED, REFUSED, Program

__all__ = ["DONE", "FAILED", "INTERRUPTED", "REFUSED", "main", "parser"]

_STUDY = Program(
    "python -m study",
    "The study of vibratory part alignment: its recorded runs, its claims, its reference.",
    (tracking, reference, claims),
)
parser, main = _STUDY.parser, _STUDY.main

if __name__ == "__main__":
    sys.exit(main())
