"""Gather the chunks of both accuracy trials into their tables, and say what they show."""

import argparse
from pathlib import Path

from model.tracking.provenance import Job, write_text
from verification.accuracy import read_tables, summary, write_table


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--error", required=True, type=Path, nargs="+")
    parser.add_argument("--settled", required=True, type=Path, nargs="+")
    parser.add_argument("--output", required=True, type=Path, help="folder of the results")
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    job = Job("judge")
    folder: Path = arguments.output
    error, settled = read_tables(arguments.error), read_tables(arguments.settled)
    made = [folder / "error.csv", folder / "settled.csv", folder / "summary.txt"]
    write_table(error, made[0])
    write_table(settled, made[1])
    write_text(summary(error, settled), made[2])
    job.finish(arguments.record, made, [*arguments.error, *arguments.settled])


if __name__ == "__main__":
    main()
