"""``vibralign export``: write an invocation of the study for other tools."""

import argparse
from pathlib import Path
from typing import Any

from model.cli.arguments import add_command, add_root
from model.tracking.history import find_invocation, load_history

TOOLS = ("mlflow", "ro-crate")


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "export",
        _export,
        "write an invocation of the study as an MLflow run or a Workflow Run RO-Crate",
        ". Needs the extra: pip install 'vibralign[export]'.",
    )
    parser.add_argument("tool", choices=TOOLS)
    parser.add_argument(
        "target", type=Path, help="mlflow: the SQLite file, new or not; ro-crate: a new folder"
    )
    words = "the beginning of an invocation's name, or last (default: last)"
    parser.add_argument("--invocation", default="last", metavar="NAME", help=words)
    add_root(parser, "results root that it belongs to")
    words = "checkout that holds the Snakefile, for ro-crate (default: this folder)"
    parser.add_argument("--project", type=Path, default=Path(), metavar="DIR", help=words)


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
