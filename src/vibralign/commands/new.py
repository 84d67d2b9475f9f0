"""``vibralign new``: write a device file to fill in."""

import argparse
from importlib import resources
from pathlib import Path
from typing import Any

from model.sweeps.files import atomic_write
from vibralign.commands.files import check_file, writing
from vibralign.commands.program import add_command


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    words = "write a device file to fill in, with a comment on each quantity"
    parser = add_command(
        commands,
        "new",
        _new,
        words,
        epilog="exit code: 0 the file was written; 1 it could not be; 2 bad input",
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="file to write (.yaml)")


def _new(arguments: argparse.Namespace) -> int:
    path = arguments.file
    check_file(path, "new", ["yaml", "yml"])
    if path.exists():
        raise ValueError(f"new {path}: exists already: choose another name, or delete it")
    with writing(), atomic_write(path) as part:
        part.write_bytes(resources.files("vibralign.device").joinpath("new.yaml").read_bytes())
    print(f"fill in {path}, then: vibralign assess --device {path}")
    return 0
