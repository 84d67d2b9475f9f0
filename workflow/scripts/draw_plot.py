"""Plot a figure's dataset, with a sidecar."""

import argparse
from pathlib import Path

from model.show.plots import draw
from model.show.style import save
from model.study.datasets import read_dataset
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("dataset", type=Path)
    arguments = parser.parse_args()
    job = Job("plot", arguments.output.stem)
    pictures = save(draw(read_dataset(arguments.dataset)), arguments.output.with_suffix(""))
    job.finish(arguments.record, pictures, [arguments.dataset])


if __name__ == "__main__":
    main()
