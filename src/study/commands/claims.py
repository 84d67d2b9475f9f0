"""``claims``: the ledger of a build, or the regime of its figures."""

import argparse
from dataclasses import asdict
from typing import Any

from study.commands.options import add_root
from vibralign.commands.program import add_command, add_json
from vibralign.commands.tables import print_json, table


def add(commands: Any) -> None:
    """Add the command to the parsers of the study."""
    parser = add_command(
        commands,
        "claims",
        _claims,
        "list every entry of the ledger with the verdict of a build",
        ": one line an entry, with the share of random devices that show it and the parts that "
        "fail, and a last line that counts the verdicts.",
        epilog="exit code: 0 listed; 2 bad input",
    )
    add_root(parser, "results root")
    parser.add_argument(
        "--regime",
        action="store_true",
        help="print the regime of each figure instead: the share of points that align, over all "
        "points, on the curve with the least, and up to f0 = 10; of the points that align, the "
        "shares that align without vibration, that do not rest without it, that meet the corner "
        "conditions, and that lift off; and the tilt at alignment",
    )
    add_json(parser)


def _claims(arguments: argparse.Namespace) -> int:
    # Imported here: importing xarray takes a second that no other command should wait for.
    from study.claims import tally  # noqa: PLC0415
    from study.claims.ledger import read_ledger  # noqa: PLC0415

    if arguments.regime:
        return _regime(arguments)
    path = arguments.root / "claims.csv"
    if not path.exists():
        raise _nothing_of(arguments, "claims")
    lines = read_ledger(path)
    if arguments.json:
        print_json([asdict(line) for line in lines])
        return 0
    rows = [
        {
            "entry": line.claim,
            "verdict": line.verdict,
            "random": f"{line.random:.2f}",
            "fails": line.fails,
            "says": f"{line.place}: {line.says}",
        }
        for line in lines
    ]
    print("\n".join(table(rows, ["entry", "verdict", "random", "fails", "says"])))
    print(tally([line.verdict for line in lines]))
    return 0


def _nothing_of(arguments: argparse.Namespace, what: str) -> ValueError:
    """Return the refusal of a results root in which the study has built nothing yet."""
    return ValueError(
        f"--root {arguments.root}: holds no {what} of the study; build the study (make), or name "
        "its results root"
    )


def _regime(arguments: argparse.Namespace) -> int:
    from model.sweeps.io import read_dataset  # noqa: PLC0415
    from study.claims.data import MissingDataError, figure_of  # noqa: PLC0415
    from study.claims.regime import regime_of  # noqa: PLC0415

    rows = []
    for path in sorted((arguments.root / "data").glob("fig??.nc")):
        try:
            regime = regime_of(figure_of(read_dataset(path)))
        except MissingDataError as missing:
            raise ValueError(f"{path}: {missing}; build it again (make)") from None
        numbers = {name: round(value, 3) for name, value in regime._asdict().items()}
        rows.append({"figure": path.stem, **numbers})
    if not rows:
        raise _nothing_of(arguments, "datasets")
    if arguments.json:
        print_json(rows)
    else:
        print("\n".join(table(rows, list(rows[0]))))
    return 0
