"""The command ``vibralign``; each subcommand has a module.

All input is checked before anything is computed; the message of a refusal is one line with the
value, the rule and the valid choices. Slow modules are imported where they are needed.
"""

import argparse
import contextlib
import errno
import io
import os
import re
import sys
from collections.abc import Callable, Sequence
from typing import Any, NoReturn, TextIO

from model.cli import (
    assess,
    claims,
    design,
    explore,
    map,  # noqa: A004  (the name of the command)
    new,
    reference,
    simulate,
    tracking,
)
from model.cli.files import WriteError
from model.sweeps.version import version

# In the order of the help. The function ``add`` of a module adds its commands to the parsers.
COMMANDS = new, simulate, assess, design, map, explore, tracking, reference, claims
DONE, FAILED, REFUSED, INTERRUPTED = 0, 1, 2, 130


class _Parser(argparse.ArgumentParser):
    appendix: Callable[[], str] | None = None  # makes the end of the help, when it is asked for

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._negative_number_matcher = re.compile(r"-(\.?\d|inf)")  # -5deg is no option

    def error(self, message: str) -> NoReturn:
        """Refuse in one line, without the usage."""
        self.exit(REFUSED, f"{self.prog}: error: {message} (see {self.prog} --help)\n")

    def format_help(self) -> str:
        """Return the help, with the appendix at its end."""
        return super().format_help() + (f"\n{self.appendix()}" if self.appendix else "")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; the exit code is 0 done, 1 failed, 2 bad input, 130 interrupted."""
    os.environ["MPLBACKEND"] = "agg"  # files are drawn by it; that of a notebook fails here
    _open_streams()
    if isinstance(sys.stdout, io.TextIOWrapper):  # a terminal that cannot show τ gets a ? for it
        sys.stdout.reconfigure(errors="replace")
    try:
        return _run(argv)
    except SystemExit as ending:  # argparse: help, version, a refusal
        return ending.code if isinstance(ending.code, int) else DONE
    except ValueError as refusal:
        return _failed(REFUSED, refusal)
    except ModuleNotFoundError as missing:
        if missing.name is None or missing.name.startswith("model"):
            raise
        remedy = "pip install 'vibralign[study]'"
        return _failed(REFUSED, f"needs {missing.name}, which is not installed: {remedy}")
    except KeyboardInterrupt:
        with contextlib.suppress(OSError):
            print("vibralign: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # `vibralign … | head`: nobody reads a message
        _discard(sys.stdout)
        return FAILED
    except WriteError as error:
        return _failed(FAILED, error)
    except OSError as error:
        denied = error.errno in (errno.EACCES, errno.EPERM, errno.EROFS)
        remedy = "allow access to it" if denied else "free some space"
        _failed(FAILED, f"{error}: {remedy} or choose another place and run it again")
        _discard(sys.stdout)
        return FAILED


def _open_streams() -> None:
    """Open the null device for standard streams that are closed, in which files would else land."""
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:
            number = os.open(os.devnull, os.O_RDWR)  # the lowest that is free
            setattr(sys, name, os.fdopen(number, "r" if name == "stdin" else "w"))


def _failed(code: int, words: object) -> int:
    try:
        print(f"vibralign: error: {words}", file=sys.stderr, flush=True)
    except OSError:  # also standard error may be full
        _discard(sys.stderr)
    return code


def _discard(stream: TextIO) -> None:
    """Discard what is left of a stream: Python writes it at its end, and would fail again."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _run(argv: Sequence[str] | None) -> int:
    arguments = _parser().parse_args(argv)
    code = int(arguments.run(arguments))
    sys.stdout.flush()  # here, where ``main`` still handles a broken pipe
    return code


def _parser() -> _Parser:
    parser = _Parser(
        prog="vibralign",
        description="Vibratory alignment of a peg with a hole: choose press force, tilt stiffness "
        "and excitation frequency.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {version()}")
    commands = parser.add_subparsers(required=True, metavar="command", parser_class=_Parser)
    for command in COMMANDS:
        command.add(commands)
    return parser


if __name__ == "__main__":
    sys.exit(main())
