"""The command ``vibralign``."""

import sys
from collections.abc import Sequence

from vibralign.commands import (
    assess,
    design,
    explore,
    map,  # noqa: A004  (the name of the command)
    new,
    simulate,
)
from vibralign.commands.program import DONE, FAILED, INTERRUPTED, REFUSED, run_program

__all__ = ["DONE", "FAILED", "INTERRUPTED", "REFUSED", "main"]

DESCRIPTION = (
    "Vibratory alignment of a peg with a hole: choose press force, tilt stiffness and excitation "
    "frequency."
)
COMMANDS = new, simulate, assess, design, map, explore  # in the order of the help


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command of ``vibralign`` and return its exit code."""
    return run_program("vibralign", DESCRIPTION, COMMANDS, argv)


if __name__ == "__main__":
    sys.exit(main())
