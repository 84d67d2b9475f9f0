"""Gather the chunks of both accuracy trials into their tables, and say what they show."""

import argparse
from pathlib import Path

from model.study.accuracy import read_tables, summary, write_table
from model.study.provenance import write_text


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--error", required=True, type=Path, nargs="+")
    parser.add_argument("--settled", required=True, type=Path, nargs="+")
    parser.add_argument("--output", required=True, type=Path, help="folder of the results")
    arguments = parser.parse_args()
    error, settled = read_tables(arguments.error), read_tables(arguments.settled)
    write_table(error, arguments.output / "error.csv")
    write_table(settled, arguments.output / "settled.csv")
    write_text(summary(error, settled), arguments.output / "summary.txt")


if __name__ == "__main__":
    main()
