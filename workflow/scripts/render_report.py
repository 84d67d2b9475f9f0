"""Render the report: one page with every figure, its caption, parameters and outcomes."""

import argparse
from pathlib import Path

from model.show.report import render_report
from model.study.config import FIGURES, SCHEMATICS, Study
from model.study.datasets import read_dataset
from model.study.provenance import Job, file_hash, versions, write_text


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", required=True, type=Study.model_validate_json)
    parser.add_argument("--root", required=True, type=Path)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    root: Path = arguments.root
    job = Job("report")
    computed = [name for name in FIGURES if name not in SCHEMATICS]
    data = {name: root / f"data/{name}.nc" for name in computed}
    pictures = {name: root / f"figures/{name}.png" for name in FIGURES}
    datasets = {name: read_dataset(path) for name, path in data.items()}
    # Nothing of the day, the machine or the checkout, so that the same data give the same bytes.
    provenance = {
        "made with": versions(),
        "from datasets": {path.name: file_hash(path)[:16] for path in data.values()},
        "when, where, at which commit": "runs.csv and history/ beside this page; vibralign runs",
    }
    page = render_report(arguments.study, datasets, pictures, provenance)
    write_text(page, arguments.output)
    job.finish(arguments.record, [arguments.output], [*data.values(), *pictures.values()])


if __name__ == "__main__":
    main()
