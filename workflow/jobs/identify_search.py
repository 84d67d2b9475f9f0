"""Search parameter sets by all claims, or by half of them."""

from pathlib import Path
from typing import Any, Literal

import numpy as np

from model.study.config import Evolution
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import Space
from model.study.identification.results import candidates_dataset, samples_of, search_of


def run(
    space: Space,
    rounds: list[Evolution],
    known: dict[str, dict[str, float]],
    kind: Literal["start", "half"],
    number: int,
    samples: list[Path],
    data: Path,
) -> dict[str, Any]:
    """Search from the samples, and from the ``known`` sets where there are any."""
    search = search_of(space)
    first = samples_of([read_dataset(path) for path in samples])
    if kind == "half":
        search = search.on_half(number)
    begin = [space.point_of(values) for values in known.values()]
    seed = number if kind == "start" else 1000 + number  # other draws than those over all claims
    found = search.run(first, rounds, seed, np.array(begin) if begin else None)
    title = f"Candidates of search {kind} {number}"
    write_dataset(candidates_dataset(search, *found, title), data)
    return {"sweep": space.identity}
