"""The command ``vibralign``."""

import sys
from collections.abc import Sequence

from vibralign.commands import (
    assess,
    calibrate,
    design,
    explore,
    map,  # noqa: A004  (the name of the command)
    new,
    simulate,
)
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

DESCRIPTION = (
    "Vibratory alignment of a peg with a hole: choose press force, tilt stiffness and excitation "
    "frequency."
)
COMMANDS = new, simulate, assess, design, calibrate, map, explore  # in the order of the help


def parser() -> Parser:
    """Return the parser of ``vibralign``."""
    return parser_of("vibralign", DESCRIPTION, COMMANDS)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command of ``vibralign`` and return its exit code."""
    return run_program(parser(), argv)


if __name__ == "__main__":
    sys.exit(main())
