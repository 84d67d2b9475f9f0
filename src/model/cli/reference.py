"""``vibralign verify`` and ``accept``: a build against its reference, and a new reference."""

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from model.cli.tables import table
from model.cli.tracking import figure_name
from model.study.config import FIGURES

RED = 1


def add_commands(commands: Any) -> None:
    """Add the two commands to the parsers of ``vibralign``."""
    _add_verify(commands)
    _add_accept(commands)


def _folders(parser: argparse.ArgumentParser) -> None:
    words = "results root of the small study (default: results-smoke)"
    root = Path("results-smoke")
    parser.add_argument("--root", type=Path, default=root, metavar="DIR", help=words)
    words = "folder of the reference (default: tests/reference)"
    reference = Path("tests/reference")
    parser.add_argument("--reference", type=Path, default=reference, metavar="DIR", help=words)


def _add_verify(commands: Any) -> None:
    words = "compare a build of the small study with the accepted reference"
    parser = commands.add_parser(
        "verify",
        help=words,
        description=f"{words[0].upper()}{words[1:]}: every figure's data by variable, within their "
        "own estimated errors, then the claims, then what the figures draw. Pictures that look "
        "different are a warning, with a page that shows both. Exit code: 0 all agree, 1 something "
        "differs, 2 bad input.",
        allow_abbrev=False,
    )
    _folders(parser)
    words = "only this figure, such as fig06 or 6; may be repeated"
    parser.add_argument("--figure", action="append", default=[], metavar="FIG", help=words)
    parser.add_argument("--json", action="store_true", help="print everything as JSON")
    parser.set_defaults(run=_verify)


def _verify(arguments: argparse.Namespace) -> int:
    # Plotting and xarray take a second that no other command should wait for.
    from model.show.artists import disagreements  # noqa: PLC0415
    from model.show.before_after import differing_pictures, write_page  # noqa: PLC0415
    from model.tracking.comparison import open_dataset  # noqa: PLC0415
    from model.tracking.reference import COMPUTED, Disagreement, verify  # noqa: PLC0415

    root, reference = arguments.root, arguments.reference
    if not root.is_dir():
        raise ValueError(f"{root}: is no folder; build the small study first: make smoke")
    chosen = [figure_name(text) for text in arguments.figure] or list(FIGURES)
    computed = [name for name in chosen if name in COMPUTED]
    findings = verify(root, reference, computed)
    for name in computed:
        path = root / "data" / f"{name}.nc"
        if path.is_file():
            drawn = disagreements(open_dataset(path))
            findings += [Disagreement(name, "drawn", 1, words) for words in drawn]
    pictures = differing_pictures(root, reference, chosen)
    page = write_page(pictures, root, reference) if pictures else None
    if arguments.json:
        found = [asdict(each) for each in findings]
        print(json.dumps({"findings": found, "pictures": pictures}, indent=2, allow_nan=False))
    elif findings:
        rows = [{**asdict(each), "": each.words} for each in findings]
        print("\n".join(table(rows, ("figure", "variable", "points", ""))))
        print("what is meant to differ: vibralign accept --figure N --reason ...")
    else:
        print(f"{len(computed)} figures agree with {reference}")
    if page is not None:
        words = ", ".join(f"{name} ({how})" for name, how in pictures.items())
        print(f"warning: pictures look different, see {page}: {words}", file=sys.stderr)
    return RED if findings else 0


def _add_accept(commands: Any) -> None:
    words = "take what the small study gives as the reference from now on"
    parser = commands.add_parser(
        "accept",
        help=words,
        description=f"{words[0].upper()}{words[1:]}; the reason and the numbers that changed are "
        "added to accepted.csv beside it.",
        allow_abbrev=False,
    )
    _folders(parser)
    words = "a figure, such as fig06 or 6, or all of them; may be repeated"
    parser.add_argument("--figure", action="append", default=[], metavar="FIG|all", help=words)
    parser.add_argument("--claims", action="store_true", help="the verdicts on the paper's claims")
    parser.add_argument("--reason", required=True, help="why it is right that they changed")
    parser.set_defaults(run=_accept)


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
