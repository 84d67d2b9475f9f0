"""Gather what the searches found: the best set, the ensemble, the splits and the readings."""

import argparse
from pathlib import Path

import yaml

from model.study.config import Study
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.committed import tables_of
from model.study.identification.results import (
    candidates_dataset,
    configured,
    findings_of,
    summary,
)
from model.tracking.provenance import Job, write_text


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", required=True, type=Study.model_validate_json)
    for name in ("samples", "starts", "halves", "readings"):
        parser.add_argument(f"--{name}", required=True, type=Path, nargs="+")
    parser.add_argument("--output", required=True, type=Path, help="folder of the results")
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    job, folder = Job("identify_summary"), arguments.output
    samples, starts, halves, readings = (
        [read_dataset(path) for path in getattr(arguments, name)]
        for name in ("samples", "starts", "halves", "readings")
    )
    by_name = dict(zip((path.stem for path in arguments.readings), readings, strict=True))
    found = findings_of(arguments.study, samples, starts, halves, by_name)
    title = "Admissible sets, on the finer grids"
    sets = candidates_dataset(found.search, found.ensemble, found.ensemble_margins, title)
    write_dataset(sets, folder / "ensemble.nc")
    stated = configured(found.search.space, found.best)
    texts = {f"{name}.csv": text for name, text in tables_of(found.identified).items()}
    texts["best.yaml"] = yaml.safe_dump(stated, sort_keys=False, allow_unicode=True)
    texts["summary.txt"] = summary(found)
    for name, text in texts.items():
        write_text(text, folder / name)
    made = [folder / name for name in ("ensemble.nc", *texts)]
    inputs = [*arguments.samples, *arguments.starts, *arguments.halves, *arguments.readings]
    job.finish(arguments.record, made, inputs, sweep=found.search.space.identity)


if __name__ == "__main__":
    main()
