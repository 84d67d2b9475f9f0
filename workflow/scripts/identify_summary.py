"""Gather what the searches found: the best set, the ensemble, the splits and the readings."""

import argparse
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
import yaml
from numpy.typing import NDArray

from model.study.config import Study
from model.study.csv_tables import csv_text
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import (
    Space,
    space_of,
    space_of_figures,
    space_of_reading,
)
from model.study.identification.committed import Split
from model.study.identification.evaluate import Judge, judge_of
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
from model.study.identification.search import (
    contenders,
    foremost,
    halves,
    judged,
    most_shown,
)
from model.tracking.provenance import Job, write_text

FINER = 3

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Finer:
    """Candidates judged on finer grids: values (m, unknowns), margins (m, claims), the best row."""

    values: Array
    margins: Array
    best: int


def judged_finer(space: Space, judge: Judge, found: xr.Dataset, count: int) -> Finer:
    """The ``count`` best of a search, judged on the grids of ``space``."""
    points = space.point(found["value"].values)
    structures = points[:, space.places["structure"]]
    rows = contenders(judge, structures, found["margin"].values, count)
    margins, against = judged(space, judge, points[rows])
    return Finer(found["value"].values[rows], margins, most_shown(judge, margins, against))


def write_rows(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> Path:
    """Write a table as CSV, whole or not at all; numbers to six digits."""
    written = [[f"{each:.6g}" if isinstance(each, float) else each for each in row] for row in rows]
    write_text(csv_text(header, (dict(zip(header, row, strict=True)) for row in written)), path)
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

    # A set is admissible by what it shows, whichever claims it was searched by.
    searches = [read_dataset(path) for path in (*arguments.starts, *arguments.halves)]
    tried = xr.concat([each[["value", "margin"]] for each in searches], "candidate")
    finer = space_of(arguments.study, finer=FINER)
    leading = judged_finer(finer, judge, tried, law.finer)
    last = space.point(leading.values[foremost(judge, leading.margins, law.final)])
    shown, against = judged(space_of_figures(arguments.study), judge, last)
    best = most_shown(judge, shown, against)
    kept = admissible(judge, leading.margins, law.admissible)
    ensemble, margins = leading.values[kept], leading.margins[kept]
    possible = shares(margins) > 0.0

    splits = []
    for number, path in enumerate(arguments.halves):
        pair = halves(judge, space.law.seed, number)
        half = judged_finer(finer, judge.counting(pair[0]), read_dataset(path), law.finer_each)
        splits.append(split_of(number, pair, half.margins[half.best], possible))
    readings: dict[str, Array] = {}
    for path in arguments.readings:
        under = space_of_reading(arguments.study, path.stem, finer=FINER)
        found_so = judged_finer(under, judge, read_dataset(path), law.finer_each)
        readings[path.stem] = found_so.margins[found_so.best]

    found = Findings(
        space=space,
        judge=judge,
        tried=tried.sizes["candidate"],
        judged=len(leading.margins),
        best=last[best],
        best_margins=shown[best],
        ensemble=ensemble,
        ensemble_margins=margins,
        prior=prior_shares(samples_of([read_dataset(path) for path in arguments.samples])),
        splits=tuple(splits),
        readings=readings,
    )
    title = "Admissible sets, on the finer grids"
    made = write_all(
        found, candidates_dataset(space, judge, space.point(ensemble), margins, title), folder
    )
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
            Split._fields,
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
