"""Search parameter sets by all claims, or by half of them."""

from pathlib import Path
from typing import Any, Literal

import numpy as np

from model.study.config import Evolution
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import Space
from model.study.identification.evaluate import judge_of
from model.study.identification.results import candidates_dataset, samples_of
from model.study.identification.search import halves, search


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
    judge = judge_of(space)
    first = samples_of([read_dataset(path) for path in samples])
    if kind == "half":
        judge = judge.counting(halves(judge, space.law.seed, number)[0])
    begin = [space.point_of(values) for values in known.values()]
    seed = number if kind == "start" else 1000 + number  # other draws than those over all claims
    found = search(space, judge, first, rounds, seed, np.array(begin) if begin else None)
    title = f"Candidates of search {kind} {number}"
    write_dataset(candidates_dataset(space, judge, *found, title), data)
    return {"sweep": space.identity}
