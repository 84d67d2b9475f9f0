"""Draw the runs that only the claims ledger has."""

import argparse
from pathlib import Path

from model.show.claim_plots import draw_runs
from model.show.style import save
from model.study.datasets import read_dataset
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("datasets", nargs="+", type=Path)
    arguments = parser.parse_args()
    job = Job("draw_claims")
    datasets = {path.stem: read_dataset(path) for path in arguments.datasets}
    pictures = save(draw_runs(datasets), arguments.output.with_suffix(""))
    job.finish(arguments.record, pictures, arguments.datasets)


if __name__ == "__main__":
    main()
