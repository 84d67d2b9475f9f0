"""The commands of the study: ``python -m study``."""

import sys
from collections.abc import Sequence

from study.commands import claims, reference, tracking
from vibralign.commands.program import (
    DONE,
    FAILED,
    INTERRUPTED,
    REFUSED,
    Parser,
    parser_of,
    run_program,
)

__all__ = ["DONE", "FAILED", "INTERRUPTED", "REFUSED", "main", "parser"]

DESCRIPTION = "The study of vibratory part alignment: its recorded runs, its claims, its reference."
COMMANDS = tracking, reference, claims  # in the order of the help


def parser() -> Parser:
    """Return the parser of the study."""
    return parser_of("python -m study", DESCRIPTION, COMMANDS)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command of the study and return its exit code."""
    return run_program(parser(), argv)


if __name__ == "__main__":
    sys.exit(main())
