"""Draw the bands of the admissible sets behind the curves of Figs. 6 to 12."""

import argparse
from pathlib import Path

from model.show.identification import band_curves
from model.show.style import save
from model.study.datasets import read_dataset
from model.study.identification.band_table import read_bands
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bands", required=True, type=Path)
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("curves", nargs="+", type=Path, help="the figures' datasets")
    arguments = parser.parse_args()
    job = Job("draw_bands")
    figure = band_curves(
        read_bands(arguments.bands), [read_dataset(path) for path in arguments.curves]
    )
    pictures = save(figure, arguments.output.with_suffix(""))
    job.finish(arguments.record, pictures, [arguments.bands, *arguments.curves])


if __name__ == "__main__":
    main()
