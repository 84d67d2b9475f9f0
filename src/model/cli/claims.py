"""``vibralign claims``: what the paper says, judged by the data on disk."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from model.cli.tables import table


def add_commands(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    words = "list every claim of the paper with its verdict, by the data on disk"
    parser = commands.add_parser(
        "claims",
        help=words,
        description=f"{words[0].upper()}{words[1:]}: one line a claim, and a last line that counts "
        "the verdicts. A claim whose dataset is missing is not checkable. Exit code: 0 judged, 2 "
        "bad input.",
        allow_abbrev=False,
    )
    words = "results root (default: results)"
    parser.add_argument("--root", type=Path, default=Path("results"), metavar="DIR", help=words)
    parser.add_argument("--json", action="store_true", help="print everything as JSON")
    parser.set_defaults(run=_claims)


def _claims(arguments: argparse.Namespace) -> int:
    # Data are read with xarray, which no other command should wait for.
    from model.study.claims import judge, tally  # noqa: PLC0415
    from model.study.claims.table import lines_of  # noqa: PLC0415
    from model.tracking.comparison import open_dataset  # noqa: PLC0415

    data: Path = arguments.root / "data"
    found = [*sorted(data.glob("fig*.nc")), *sorted((data / "claims").glob("*.nc"))]
    if not found:
        raise ValueError(
            f"--root {arguments.root}: holds no datasets of the study; build it (make), or name "
            "its results root"
        )
    lines = lines_of(judge({path.stem: open_dataset(path) for path in found}))
    if arguments.json:
        print(json.dumps([asdict(line) for line in lines], indent=2, ensure_ascii=False))
        return 0
    rows = [
        {
            "claim": line.claim,
            "verdict": line.verdict,
            "number": line.value,
            "must be": line.demand,
            "margin": line.margin and f"{float(line.margin):.2f}",
            "statement": line.statement,
        }
        for line in lines
    ]
    print("\n".join(table(rows, ("claim", "verdict", "number", "must be", "margin", "statement"))))
    print(tally([line.verdict for line in lines]))
    return 0
