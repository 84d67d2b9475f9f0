"""A program with subcommands, ``vibralign`` or ``python -m study``; each subcommand has a module.

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
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NoReturn, TextIO

from model.sweeps.version import version
from vibralign.commands.files import WriteError
from vibralign.doubts import DoubtWarning

DONE, FAILED, REFUSED, INTERRUPTED = 0, 1, 2, 130
# Commands and options of release 1, and what to write instead (docs/from-1-to-2.md).
_GONE = {
    "invalid choice: 'export'": "export is gone: `python -m study runs --json` has its numbers",
    **{
        f"vibralign: invalid choice: '{name}'": f"in a checkout it is `python -m study {name}`"
        for name in ("runs", "show", "diff", "verify", "accept", "claims")
    },
    "arguments: --dimensionless": "vibralign in Python returns dimensionless numbers",
    "arguments: --animate": "vibralign explore animates the run, and runs it live",
    "arguments: --bases": "leave the base out of the device file: assess then tries bases",
    "arguments: --readings": "write --reading all=printed",
    "arguments: --from": "copy the file",
    "arguments: --out": "vibralign.design in Python returns every setting that was tried",
    "arguments: --plot": "assess --sheet and vibralign map draw where a device goes in",
    "arguments: --invocations": "--invocations is --starts now",
    **{
        f"arguments: --{name}": f"--{name} is gone: filter what --json prints"
        for name in ("parameter", "since", "until", "current")
    },
}


def add_command(
    commands: Any,
    name: str,
    run: Callable[[argparse.Namespace], int],
    words: str,
    more: str = ".",
    epilog: str | None = None,
) -> Any:
    """Add a command to the parsers of a program and return its own parser.

    ``run`` takes the parsed arguments and returns the exit code. ``words`` are the summary in the
    list of commands; the description is ``words`` followed by ``more``.
    """
    description = f"{words[0].upper()}{words[1:]}{more}"
    parser = commands.add_parser(
        name, help=words, description=description, epilog=epilog, allow_abbrev=False
    )
    parser.set_defaults(run=run)
    return parser


def add_json(parser: Any) -> None:
    """Add --json."""
    parser.add_argument("--json", action="store_true", help="print everything as JSON")


class Parser(argparse.ArgumentParser):
    """A parser that refuses in one line."""

    appendix: Callable[[], str] | None = None  # makes the end of the help, when it is asked for

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._negative_number_matcher = re.compile(r"-(\.?\d|inf)")  # -5deg is no option

    def error(self, message: str) -> NoReturn:
        """Refuse in one line, without the usage."""
        said = f"{self.prog}: {message.removeprefix('argument command: ')}"
        message += "".join(f": {words}" for old, words in _GONE.items() if old in said)
        if "unrecognized arguments" in message and re.search(r"\.ya?ml\b", message):
            message += ": a device file follows --device"
        self.exit(REFUSED, f"{self.prog}: error: {message} (see {self.prog} --help)\n")

    def format_help(self) -> str:
        """Return the help, with the appendix at its end."""
        return super().format_help() + (f"\n{self.appendix()}" if self.appendix else "")


def run_program(parser: Parser, argv: Sequence[str] | None = None) -> int:
    """Run a command of a program; the exit code is 0 done, 1 failed, 2 bad input, 130 interrupted.

    ``argv`` are the arguments, by default those of this process.
    """
    name = parser.prog
    os.environ["MPLBACKEND"] = "agg"  # files are drawn by it; that of a notebook fails here
    _open_streams()
    if isinstance(sys.stdout, io.TextIOWrapper):  # a terminal that cannot show τ gets a ? for it
        sys.stdout.reconfigure(errors="replace")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", DoubtWarning)
            warnings.showwarning = partial(_warn, name, set[str]())
            return _run(parser, argv)
    except SystemExit as ending:  # argparse: help, version, a refusal
        return ending.code if isinstance(ending.code, int) else DONE
    except ValueError as refusal:
        return _failed(name, REFUSED, refusal)
    except KeyboardInterrupt:
        with contextlib.suppress(OSError):
            print(f"{name}: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # `vibralign … | head`: nobody reads a message
        _discard(sys.stdout)
        return FAILED
    except WriteError as error:
        return _failed(name, FAILED, error)
    except OSError as error:
        denied = error.errno in (errno.EACCES, errno.EPERM, errno.EROFS)
        remedy = "allow access to it" if denied else "free some space"
        _failed(name, FAILED, f"{error}: {remedy} or choose another place and run it again")
        _discard(sys.stdout)
        return FAILED


def _warn(name: str, said: set[str], message: Warning | str, *_: Any) -> None:
    """Print a warning in one line, once."""
    if str(message) not in said:
        said.add(str(message))
        print(f"{name}: warning: {message}", file=sys.stderr)


def _open_streams() -> None:
    """Open the null device for standard streams that are closed, in which files would else land."""
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:
            number = os.open(os.devnull, os.O_RDWR)  # the lowest that is free
            setattr(sys, name, os.fdopen(number, "r" if name == "stdin" else "w"))


def _failed(name: str, code: int, words: object) -> int:
    try:
        print(f"{name}: error: {words}", file=sys.stderr, flush=True)
    except OSError:  # also standard error may be full
        _discard(sys.stderr)
    return code


def _discard(stream: TextIO) -> None:
    """Discard what is left of a stream: Python writes it at its end, and would fail again."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _run(parser: Parser, argv: Sequence[str] | None) -> int:
    arguments = parser.parse_args(argv)
    code = int(arguments.run(arguments))
    sys.stdout.flush()  # here, where ``run_program`` still handles a broken pipe
    return code


@dataclass(frozen=True)
class Program:
    """A program: its name in messages, the first words of its help, and its commands.

    ``commands`` are modules whose function ``add`` adds commands, in the help's order.
    """

    name: str
    description: str
    commands: Sequence[Any]

    def parser(self) -> Parser:
        """Return the parser of the program."""
        parser = Parser(prog=self.name, description=self.description, allow_abbrev=False)
        parser.add_argument("--version", action="version", version=f"%(prog)s {version()}")
        parsers = parser.add_subparsers(required=True, metavar="command", parser_class=Parser)
        for command in self.commands:
            command.add(parsers)
        return parser

    def main(self, argv: Sequence[str] | None = None) -> int:
        """Run a command of the program, by default that of this process; return its exit code."""
        return run_program(self.parser(), argv)
