"""Render the report: one page with every figure, its caption, parameters and outcomes."""

import argparse
from pathlib import Path

from model.show.precision import Comparison
from model.show.report import render_report
from model.study.config import FIGURES, SCHEMATICS, Study
from model.study.datasets import read_dataset
from model.study.plans import PICTURES
from model.study.precision import read_timings
from model.study.provenance import report_provenance, write_text


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", required=True, type=Study.model_validate_json)
    parser.add_argument("--root", required=True, type=Path)
    parser.add_argument("--output", required=True, type=Path)
    arguments = parser.parse_args()
    root: Path = arguments.root
    computed = [name for name in FIGURES if name not in SCHEMATICS]
    datasets = {name: read_dataset(root / f"data/{name}.nc") for name in computed}
    pictures = {name: root / f"figures/{name}.png" for name in FIGURES}
    comparison = Comparison(
        rungs=read_timings(root / "benchmarks/precision.csv"),
        wrong={
            name: read_dataset(root / f"data/fixed_steps/{name}.nc")
            for name in arguments.study.precision.fixed_steps.figures
        },
        pictures={name: root / f"{place}.png" for name, place in PICTURES.items()},
    )
    provenance = report_provenance(root)
    page = render_report(arguments.study, datasets, pictures, provenance, comparison)
    write_text(page, arguments.output)


if __name__ == "__main__":
    main()
