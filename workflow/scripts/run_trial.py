"""Run one chunk of an accuracy trial."""

import argparse
from pathlib import Path

from model.study.accuracy import Trial, run_trial, write_table


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trial", required=True, type=Trial.model_validate_json)
    parser.add_argument("--chunk", required=True, type=int)
    parser.add_argument("--chunks", required=True, type=int)
    parser.add_argument("--output", required=True, type=Path)
    arguments = parser.parse_args()
    write_table(run_trial(arguments.trial, arguments.chunk, arguments.chunks), arguments.output)


if __name__ == "__main__":
    main()
