"""``vibralign export``: write an invocation of the study for another tool."""

import argparse
from typing import Any

from model.cli.arguments import add_command, add_root
from model.tracking.history import find_invocation, load_history


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "export",
        _export,
        "write an invocation of the study as an MLflow run",
        ". Needs the extra: pip install 'vibralign[export]'.",
    )
    parser.add_argument("tool", choices=("mlflow",))
    words = "an MLflow server, or sqlite:///FILE, which may be new"
    parser.add_argument("--tracking-uri", required=True, metavar="URI", help=words)
    words = "the beginning of an invocation's name, or last (default: last)"
    parser.add_argument("--invocation", default="last", metavar="NAME", help=words)
    add_root(parser, "results root that it belongs to")


def _export(arguments: argparse.Namespace) -> int:
    from model.tracking.export import EXPERIMENT, to_mlflow  # noqa: PLC0415  (seldom needed)

    record = find_invocation(load_history(arguments.root), arguments.invocation)
    run = to_mlflow(record, arguments.root, arguments.tracking_uri)
    print(f"{arguments.tracking_uri}: run {run} of experiment {EXPERIMENT}")
    return 0
