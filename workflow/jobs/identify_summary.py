"""Gather the searches: the best set, the admissible sets, the splits and the readings."""

from pathlib import Path
from typing import Any

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
from model.tracking.provenance import write_text


def run(
    study: Study,
    samples: list[Path],
    starts: list[Path],
    descent: Path,
    half: list[Path],
    readings: list[Path],
    best: Path,
    ensemble: Path,
    tables: list[Path],
    text: Path,
) -> dict[str, Any]:
    """Write the best set as YAML, the admissible sets, the tables, and the summary as ``text``."""
    pool, searches, halves = (
        [read_dataset(path) for path in paths] for paths in (samples, starts, half)
    )
    under_readings = {path.stem: read_dataset(path) for path in readings}
    found = findings_of(study, pool, searches, read_dataset(descent), halves, under_readings)
    title = "Admissible sets, on the finer grids"
    sets = candidates_dataset(found.search, found.ensemble, title)
    write_dataset(sets, ensemble)
    stated = configured(found.search.space, found.best)
    write_text(yaml.safe_dump(stated, sort_keys=False, allow_unicode=True), best)
    contents = tables_of(found.identified)
    for path in tables:
        write_text(contents[path.stem], path)
    write_text(summary(found, study.identification.aims), text)
    return {"sweep": found.search.space.identity}
