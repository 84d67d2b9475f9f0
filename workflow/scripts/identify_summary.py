"""Gather what the searches found: the best set, the ensemble, the splits and the readings."""

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr
import yaml

from model.study.config import Study
from model.study.csv_tables import csv_text
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import space_of
from model.study.identification.evaluate import contradicted, datasets_of, judge_of, known_margins
from model.study.identification.results import (
    Findings,
    admissible,
    candidates_dataset,
    configured,
    correlations,
    prior_shares,
    samples_of,
    shares,
    split_of,
    spreads,
    summary,
)
from model.study.identification.search import best_of, halves, most_shown
from model.study.provenance import Job, write_text

FINER = 3


def write_rows(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> Path:
    """Write a table as CSV, whole or not at all."""
    write_text(csv_text(header, (dict(zip(header, row, strict=True)) for row in rows)), path)
    return path


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
    law = arguments.study.identification
    space = space_of(arguments.study)
    judge = judge_of(space)

    starts = [read_dataset(path) for path in arguments.starts]
    values = np.concatenate([each["value"].values for each in starts])
    margins = np.concatenate([each["margin"].values for each in starts])
    points = space.point(values)
    leading = best_of(judge, margins, law.finer)
    finer = space_of(arguments.study, finer=FINER)
    shown = [datasets_of(finer, [(point, finer.everything)])[0] for point in points[leading]]
    judged = np.array([known_margins(judge, datasets) for datasets in shown])
    best = most_shown(judge, judged, [contradicted(judge, datasets) for datasets in shown])
    kept = admissible(margins, judge.counted, law.admissible)
    ensemble = candidates_dataset(space, judge, points[kept], margins[kept], "Admissible sets")

    splits = []
    for number, path in enumerate(arguments.halves):
        tried = read_dataset(path)["margin"].values
        first, second = halves(judge, space.law.seed, number)
        row = best_of(judge.counting(first), tried, 1)[0]
        splits.append(split_of(number, (first, second), tried[row]))
    readings: dict[str, np.ndarray] = {}
    for path in arguments.readings:
        tried = read_dataset(path)["margin"].values
        readings[path.stem] = tried[best_of(judge, tried, 1)[0]]

    found = Findings(
        space=space,
        judge=judge,
        tried=len(points),
        best=points[leading[best]],
        best_margins=judged[best],
        ensemble=values[kept],
        ensemble_margins=margins[kept],
        prior=prior_shares(samples_of([read_dataset(path) for path in arguments.samples])),
        splits=tuple(splits),
        readings=readings,
    )
    made = write_all(found, ensemble, folder)
    inputs = [*arguments.samples, *arguments.starts, *arguments.halves, *arguments.readings]
    job.finish(arguments.record, made, inputs, sweep=space.identity)


def write_all(found: Findings, ensemble: xr.Dataset, folder: Path) -> list[Path]:
    """The files, and their paths."""
    space, judge = found.space, found.judge
    write_dataset(ensemble, folder / "ensemble.nc")
    stated = yaml.safe_dump(configured(space, found.best), sort_keys=False, allow_unicode=True)
    write_text(stated, folder / "best.yaml")
    write_text(summary(found), folder / "summary.txt")
    ids, structure = judge.ids, list(space.law.structure)
    return [
        folder / "ensemble.nc",
        folder / "best.yaml",
        folder / "summary.txt",
        write_rows(folder / "ensemble.csv", space.names, found.ensemble.tolist()),
        write_rows(
            folder / "unknowns.csv",
            ("unknown", "low", "median", "high", "narrowed", *structure),
            [
                (*spread, *row)
                for spread, row in zip(
                    spreads(space, found.ensemble)[: len(structure)],
                    correlations(space, found.ensemble).tolist(),
                    strict=True,
                )
            ],
        ),
        write_rows(
            folder / "claims.csv",
            ("claim", "counted", "margin", "ensemble", "prior"),
            zip(
                ids,
                judge.counted.astype(int).tolist(),
                found.best_margins.tolist(),
                shares(found.ensemble_margins).tolist(),
                found.prior.tolist(),
                strict=True,
            ),
        ),
        write_rows(
            folder / "splits.csv",
            ("split", "searched", "searched_reproduced", "held_out", "held_out_reproduced"),
            found.splits,
        ),
        write_rows(
            folder / "readings.csv",
            ("reading", *ids),
            [(name, *margins.tolist()) for name, margins in found.readings.items()],
        ),
    ]


if __name__ == "__main__":
    main()
