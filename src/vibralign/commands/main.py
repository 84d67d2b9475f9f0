"""The command ``vibralign``."""

import sys

from vibralign.commands import (
    assess,
    calibrate,
    design,
    explore,
    map,  # noqa: A004  (the name of the command)
    new,
    simulate,
)
from vibralign.commands.program import DONE, FAILED, INTERRUPTED, REFUSED, Program

__all__ = ["DONE", "FAILED", "INTERRUPTED", "REFUSED", "main", "parser"]

_TOOL = Program(
    "vibralign",
    "Vibratory alignment of a peg with a hole: choose press force, tilt stiffness and excitation "
    "frequency.",
    (new, simulate, assess, design, calibrate, map, explore),
)

parser, main = _TOOL.parser, _TOOL.main

if __name__ == "__main__":
    sys.exit(main())
