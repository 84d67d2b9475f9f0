"""Render the report: one page with every figure, its caption, parameters and outcomes."""

import argparse
from pathlib import Path

from model.show.report.page import render_report
from model.show.report.section import Results
from model.study.config import Study
from model.tracking.provenance import Job, write_text
from verification.report import SECTIONS


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", required=True, type=Study.model_validate_json)
    parser.add_argument("--root", required=True, type=Path)
    parser.add_argument("--identified", type=Path, nargs="*", default=[], help="its tables")
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    job = Job("report")
    results = Results(arguments.root, arguments.study, arguments.identified)
    write_text(render_report(results, SECTIONS), arguments.output)
    job.finish(arguments.record, [arguments.output], results.inputs)


if __name__ == "__main__":
    main()
