"""Draw a picture of the hard cases: the stability table, or the error over the stiffness."""

import argparse
from pathlib import Path

from model.show.style import save
from model.study.config import HardCases
from model.tracking.provenance import Job
from verification.hard_cases import read_table
from verification.plans import HARD_PICTURES
from verification.report.hard_cases_plots import error_over_stiffness, stability


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture", required=True, choices=sorted(HARD_PICTURES))
    parser.add_argument("--spec", required=True, type=HardCases.model_validate_json)
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("source", type=Path)
    arguments = parser.parse_args()
    spec: HardCases = arguments.spec
    job = Job(f"draw_{arguments.picture}")
    judged = read_table(arguments.source)
    if arguments.picture == "stability":
        titles = {name: case.title for name, case in spec.all_cases.items()}
        figure = stability(judged, titles)
    else:
        figure = error_over_stiffness(judged, spec)
    pictures = save(figure, arguments.output.with_suffix(""))
    job.finish(arguments.record, pictures, [arguments.source])


if __name__ == "__main__":
    main()
