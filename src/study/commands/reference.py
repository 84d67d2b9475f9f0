"""``verify`` and ``accept``: a build of the small study and its accepted reference."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import Any

from study.commands.options import add_root, figure_name
from study.config import load_study, study_path
from vibralign.commands.program import add_command, add_json
from vibralign.commands.tables import print_json, table


def _add_folders(parser: Any) -> None:
    """Add the options for the folders of build and reference."""
    add_root(parser, "results root of the small study", "results-smoke")
    words = "folder of the reference (default: tests/reference)"
    reference = Path("tests/reference")
    parser.add_argument("--reference", type=Path, default=reference, metavar="DIR", help=words)


def add(commands: Any) -> None:
    """Add the commands to the parsers of the study."""
    parser = add_command(
        commands,
        "verify",
        _verify,
        "compare a build of the small study with the accepted reference",
        ": every figure's data by variable, within their own estimated errors, then the claims.",
        epilog="exit code: 0 all agree; 1 something differs; 2 bad input",
    )
    _add_folders(parser)
    words = "only this figure, such as fig06 or 6; may be repeated"
    parser.add_argument("--figure", action="append", default=[], metavar="FIG", help=words)
    add_json(parser)

    parser = add_command(
        commands,
        "accept",
        _accept,
        "accept the results of the small study as the reference",
        "; the reason and the changed numbers are added to accepted.csv beside it.",
    )
    _add_folders(parser)
    words = "a figure, such as fig06 or 6, or all of them; may be repeated"
    parser.add_argument("--figure", action="append", default=[], metavar="FIG|all", help=words)
    parser.add_argument("--claims", action="store_true", help="the verdicts on the paper's claims")
    parser.add_argument("--reason", required=True, help="reason why the change is right")


def _verify(arguments: argparse.Namespace) -> int:
    # Imported here: xarray takes a second that no other command should wait for.
    from study.tracking.reference import verify  # noqa: PLC0415

    root, reference = arguments.root, arguments.reference
    if not root.is_dir():
        raise ValueError(f"{root}: is no folder; build the small study first: make smoke")
    study = load_study(study_path())
    chosen = [figure_name(text, study) for text in arguments.figure] or study.computed
    computed = [name for name in chosen if name in study.computed]
    findings = verify(root, reference, computed)
    if arguments.json:
        print_json({"findings": [asdict(each) for each in findings]})
    elif findings:
        rows = [{**asdict(each), "": each.words} for each in findings]
        print("\n".join(table(rows, ("figure", "variable", "points", ""))))
        print("to accept what is meant to differ: python -m study accept --figure N --reason ...")
    else:
        print(f"{len(computed)} figures agree with {reference}")
    return int(bool(findings))


def _accept(arguments: argparse.Namespace) -> int:
    from study.tracking.reference import accept  # noqa: PLC0415  (as in _verify)

    study = load_study(study_path())
    if "all" in arguments.figure:
        names = sorted(study.figures)
    else:
        names = [figure_name(text, study) for text in arguments.figure]
    what = {name: name in study.computed for name in names}
    if arguments.claims:
        what["claims"] = False
    if not what:
        raise ValueError("name what to accept: --figure N, --figure all or --claims")
    print("\n".join(accept(arguments.root, arguments.reference, what, arguments.reason)))
    return 0
