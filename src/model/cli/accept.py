"""``vibralign accept``: accept the results of the small study as the reference."""

import argparse
from typing import Any

from model.cli.arguments import add_command, figure_name
from model.cli.verify import add_folders
from model.study.config import FIGURES


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "accept",
        _accept,
        "accept the results of the small study as the reference",
        "; the reason and the changed numbers are added to accepted.csv beside it.",
    )
    add_folders(parser)
    words = "a figure, such as fig06 or 6, or all of them; may be repeated"
    parser.add_argument("--figure", action="append", default=[], metavar="FIG|all", help=words)
    parser.add_argument("--claims", action="store_true", help="the verdicts on the paper's claims")
    parser.add_argument("--reason", required=True, help="reason why the change is right")


def _accept(arguments: argparse.Namespace) -> int:
    from model.tracking.reference import accept  # noqa: PLC0415  (as in _verify)

    if "all" in arguments.figure:
        what = list(FIGURES)
    else:
        what = list(dict.fromkeys(figure_name(text) for text in arguments.figure))
    what += ["claims"] if arguments.claims else []
    if not what:
        raise ValueError("name what to accept: --figure N, --figure all or --claims")
    print("\n".join(accept(arguments.root, arguments.reference, what, arguments.reason)))
    return 0
