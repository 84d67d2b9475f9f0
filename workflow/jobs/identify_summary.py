"""Gather what the searches found: the best set, the ensemble, the splits and the readings."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

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
from model.tracking.provenance import write_text

FINER = 3

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Finer:
    """Candidates judged on finer grids: values (m, unknowns), margins (m, claims), the best row."""

    values: Array
    margins: Array
    best: int


def judged_finer(space: Space, judge: Judge, found: xr.Dataset, count: int) -> Finer:
    """Judge the ``count`` best of a search on the grids of ``space``."""
    points = space.point(found["value"].values)
    structures = points[:, space.places["structure"]]
    rows = contenders(judge, structures, found["margin"].values, count)
    margins, against = judged(space, judge, points[rows])
    return Finer(found["value"].values[rows], margins, most_shown(judge, margins, against))


def write_rows(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a table as CSV, whole or not at all; numbers to six digits."""
    written = [[f"{each:.6g}" if isinstance(each, float) else each for each in row] for row in rows]
    write_text(csv_text(header, (dict(zip(header, row, strict=True)) for row in written)), path)


def run(
    study: Study,
    samples: list[Path],
    starts: list[Path],
    half: list[Path],
    readings: list[Path],
    best: Path,
    ensemble: Path,
    tables: list[Path],
    text: Path,
) -> dict[str, Any]:
    """Write the best set as YAML, the admissible sets, the tables, and the summary as ``text``."""
    law = study.identification
    space = space_of(study)
    judge = judge_of(space)

    # A set is admissible by what it shows, whichever claims it was searched by.
    searches = [read_dataset(path) for path in (*starts, *half)]
    tried = xr.concat([each[["value", "margin"]] for each in searches], "candidate")
    finer = space_of(study, finer=FINER)
    leading = judged_finer(finer, judge, tried, law.finer)
    last = space.point(leading.values[foremost(judge, leading.margins, law.final)])
    shown, against = judged(space_of_figures(study), judge, last)
    row = most_shown(judge, shown, against)
    kept = admissible(judge, leading.margins, law.admissible)
    sets, margins = leading.values[kept], leading.margins[kept]
    possible = shares(margins) > 0.0

    splits = []
    for number, path in enumerate(half):
        pair = halves(judge, space.law.seed, number)
        best_half = judged_finer(finer, judge.counting(pair[0]), read_dataset(path), law.finer_each)
        splits.append(split_of(number, pair, best_half.margins[best_half.best], possible))
    under_readings: dict[str, Array] = {}
    for path in readings:
        under = space_of_reading(study, path.stem, finer=FINER)
        found_so = judged_finer(under, judge, read_dataset(path), law.finer_each)
        under_readings[path.stem] = found_so.margins[found_so.best]

    found = Findings(
        space=space,
        judge=judge,
        tried=tried.sizes["candidate"],
        judged=len(leading.margins),
        best=last[row],
        best_margins=shown[row],
        ensemble=sets,
        ensemble_margins=margins,
        prior=prior_shares(samples_of([read_dataset(path) for path in samples])),
        splits=tuple(splits),
        readings=under_readings,
    )
    title = "Admissible sets, on the finer grids"
    write_dataset(candidates_dataset(space, judge, space.point(sets), margins, title), ensemble)
    stated = yaml.safe_dump(configured(space, found.best), sort_keys=False, allow_unicode=True)
    write_text(stated, best)
    write_text(summary(found), text)
    contents = tables_of(found)
    for path in tables:
        write_rows(path, *contents[path.stem])
    return {"sweep": space.identity}


def tables_of(found: Findings) -> dict[str, tuple[Sequence[str], Iterable[Sequence[object]]]]:
    """Return header and rows of every table, by the name of its file."""
    space, judge = found.space, found.judge
    structure = list(space.law.structure)
    spread = spreads(space, found.ensemble)[: len(structure)]
    related = correlations(space, found.ensemble).tolist()
    claims = zip(
        judge.ids,
        judge.counted.astype(int).tolist(),
        found.best_margins.tolist(),
        shares(found.ensemble_margins).tolist(),
        found.prior.tolist(),
        strict=True,
    )
    return {
        "ensemble": (space.names, found.ensemble.tolist()),
        "unknowns": (
            ("unknown", "low", "median", "high", "narrowed", *structure),
            [(*each, *row) for each, row in zip(spread, related, strict=True)],
        ),
        "claims": (("claim", "counted", "margin", "ensemble", "prior"), claims),
        "splits": (Split._fields, found.splits),
        "readings": (
            ("reading", *judge.ids),
            [(name, *margins.tolist()) for name, margins in found.readings.items()],
        ),
    }
