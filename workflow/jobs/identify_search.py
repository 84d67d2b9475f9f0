"""Search parameter sets by all claims, or by half of them: one round, which continues the last."""

from pathlib import Path
from typing import Any, Literal

import numpy as np

from model.study.config import Evolution
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import Space
from model.study.identification.results import (
    candidates_dataset,
    found_in,
    samples_of,
    search_of,
)


def run(
    space: Space,
    evolution: Evolution,
    known: dict[str, dict[str, float]],
    kind: Literal["start", "half"],
    number: int,
    stage: int,
    weight: float,
    samples: list[Path],
    before: list[Path],
    data: Path,
) -> dict[str, Any]:
    """Search from the samples and the ``known`` sets, or from the round ``before``."""
    search = search_of(space).weighing(weight)
    first = samples_of([read_dataset(path) for path in samples])
    if kind == "half":
        search = search.on_half(number)
    begin = [space.point_of(values) for values in known.values()]
    seed = number if kind == "start" else 1000 + number  # other draws than those over all claims
    found = search.run(
        first,
        evolution,
        seed,
        stage,
        found_in(space, read_dataset(before[0])) if before else None,
        np.array(begin) if begin else None,
    )
    title = f"Candidates of search {kind} {number}, round {stage}"
    write_dataset(candidates_dataset(search, found, title), data)
    return {"sweep": space.identity}
