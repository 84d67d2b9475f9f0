"""``claims``: judge the claims of the paper by the data on disk."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from study.commands.options import add_root
from vibralign.commands.program import add_command, add_json
from vibralign.commands.tables import print_json, table

if TYPE_CHECKING:
    from study.claims import Tables


def add(commands: Any) -> None:
    """Add the command to the parsers of the study."""
    parser = add_command(
        commands,
        "claims",
        _claims,
        "list every claim of the paper with its verdict, by the data on disk",
        ": one line a claim, with the share of random devices that show it, and last lines that "
        "count the verdicts and weigh them. A claim whose dataset is missing is not checkable.",
        epilog="exit code: 0 judged; 2 bad input",
    )
    add_root(parser, "results root")
    parser.add_argument(
        "--regime",
        action="store_true",
        help="print the regime of each figure instead: the share of points that align, on the "
        "curve where it is least; of the points that align, the shares that align without "
        "vibration, that do not rest without it, that meet the corner conditions and that lift "
        "off, and the tilt at alignment",
    )
    add_json(parser)


def _claims(arguments: argparse.Namespace) -> int:
    # Imported here: importing xarray takes a second that no other command should wait for.
    from model.sweeps.io import read_dataset  # noqa: PLC0415
    from study.claims import Tables, judge, tally  # noqa: PLC0415
    from study.claims.ledger import lines_of  # noqa: PLC0415
    from study.evidence.worth import summary, weighed  # noqa: PLC0415

    data: Path = arguments.root / "data"
    files = sorted(data.glob("fig*.nc"))
    if not arguments.regime:
        files += sorted((data / "claims").glob("*.nc"))
    if not files:
        raise ValueError(
            f"--root {arguments.root}: holds no datasets of the study; build it (make), or name "
            "its results root"
        )
    tables = Tables.of({path.stem: read_dataset(path) for path in files})
    if arguments.regime:
        return _regime(tables, arguments.json)
    lines, null = lines_of(judge(tables)), None
    if (drawn := data / "null.nc").is_file():
        null = read_dataset(drawn)
        lines = weighed(lines, null)
    if arguments.json:
        print_json([asdict(line) for line in lines])
        return 0
    rows = [
        {
            "claim": line.claim,
            "verdict": line.verdict,
            "number": line.value,
            "must be": line.demand,
            "margin": line.margin and f"{float(line.margin):.2f}",
            "random": line.random_devices,
            "statement": line.statement,
        }
        for line in lines
    ]
    columns = ("claim", "verdict", "number", "must be", "margin", "random", "statement")
    print("\n".join(table(rows, columns)))
    print(tally([line.verdict for line in lines]))
    if null is not None:
        print(summary(lines, null))
    return 0


def _regime(tables: "Tables", as_json: bool) -> int:
    from study.claims.data import MissingDataError  # noqa: PLC0415
    from study.claims.regime import regime_of  # noqa: PLC0415

    rows = []
    for figure in tables.frames:
        try:
            regime = regime_of(tables, figure)
        except MissingDataError as missing:
            raise ValueError(f"{missing}; build it again (make)") from None
        numbers = {name: round(value, 3) for name, value in regime._asdict().items()}
        rows.append({"figure": figure, **numbers})
    if as_json:
        print_json(rows)
    else:
        print("\n".join(table(rows, list(rows[0]))))
    return 0
