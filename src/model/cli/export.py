"""``vibralign export``: an invocation of the study for other people's tools."""

import argparse
from pathlib import Path
from typing import Any

from model.tracking.history import find_invocation, load_history

TOOLS = ("mlflow", "ro-crate")


def add_commands(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    words = "write an invocation of the study as an MLflow run or a Workflow Run RO-Crate"
    parser = commands.add_parser(
        "export",
        help=words,
        description=f"{words[0].upper()}{words[1:]}. Needs the extra: pip install "
        "'vibralign[export]'.",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("tool", choices=TOOLS)
    add("target", type=Path, help="mlflow: the SQLite file, new or not; ro-crate: a new folder")
    words = "the beginning of an invocation's name, or last (default: last)"
    add("--invocation", default="last", metavar="NAME", help=words)
    words = "results root that it belongs to (default: results)"
    add("--root", type=Path, default=Path("results"), metavar="DIR", help=words)
    words = "checkout that holds the Snakefile, for ro-crate (default: this folder)"
    add("--project", type=Path, default=Path(), metavar="DIR", help=words)
    parser.set_defaults(run=_export)


def _export(arguments: argparse.Namespace) -> int:
    from model.tracking.export import to_mlflow, to_rocrate  # noqa: PLC0415  (seldom needed)

    record = find_invocation(load_history(arguments.root), arguments.invocation)
    if arguments.tool == "mlflow":
        run = to_mlflow(record, arguments.root, arguments.target)
        print(f"{arguments.target}: run {run} of experiment vibralign")
    else:
        to_rocrate(record, arguments.root, arguments.project, arguments.target)
        print(f"{arguments.target}: Workflow Run RO-Crate of {record['invocation']}")
    return 0
