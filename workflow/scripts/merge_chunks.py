"""Merge the chunks of a figure's sweep into its dataset."""

import argparse
from pathlib import Path

from model.study.datasets import merge_chunks, read_dataset, write_dataset
from model.study.sweeps import Sweep


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweep", required=True, type=Sweep.model_validate_json)
    parser.add_argument("--title", required=True)
    parser.add_argument("--summary", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("chunks", nargs="+", type=Path)
    arguments = parser.parse_args()
    parts = [read_dataset(path) for path in arguments.chunks]
    dataset = merge_chunks(arguments.sweep, arguments.title, arguments.summary, parts)
    write_dataset(dataset, arguments.output)


if __name__ == "__main__":
    main()
