"""``claims``: the ledger of a build."""

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
    add_json(parser)


def _claims(arguments: argparse.Namespace) -> int:
    # Imported here: importing xarray takes a second that no other command should wait for.
    from study.claims import tally  # noqa: PLC0415
    from study.claims.ledger import read_ledger  # noqa: PLC0415

    path = arguments.root / "claims.csv"
    if not path.exists():
        raise ValueError(
            f"--root {arguments.root}: holds no claims of the study; build the study (make), or "
            "name its results root"
        )
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
