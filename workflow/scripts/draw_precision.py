"""Draw a picture of speed against error: evaluations, CPU times, or wrong points."""

import argparse
import json
from pathlib import Path

from model.show.style import save
from model.study.datasets import read_dataset
from model.tracking.provenance import Job
from verification.plans import PICTURES
from verification.report.work_precision_plots import (
    evaluations_over_error,
    time_over_error,
    wrong_points,
)
from verification.work_precision import read_timings


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture", required=True, choices=sorted(PICTURES))
    parser.add_argument("--titles", required=True, type=json.loads, help="of the cases")
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("sources", nargs="+", type=Path)
    arguments = parser.parse_args()
    job = Job(f"draw_{arguments.picture}")
    sources, titles = arguments.sources, arguments.titles
    if arguments.picture == "evaluations":
        figure = evaluations_over_error(read_dataset(sources[0]), titles)
    elif arguments.picture == "times":
        figure = time_over_error(read_timings(sources[0]), titles)
    else:
        figure = wrong_points([read_dataset(source) for source in sources])
    pictures = save(figure, arguments.output.with_suffix(""))
    job.finish(arguments.record, pictures, sources)


if __name__ == "__main__":
    main()
