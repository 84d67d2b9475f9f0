"""Index all runs of a results root in runs.csv."""

import argparse
from pathlib import Path

from model.tracking.index import write_index


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", required=True, type=Path)
    write_index(parser.parse_args().root)


if __name__ == "__main__":
    main()
