"""Search parameter sets by the aims: one round, which continues the last."""

from pathlib import Path
from typing import Any

from model.study.config import Aims, Descent
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import Space
from model.study.identification.descent import descended
from model.study.identification.front import Wanted
from model.study.identification.results import SAFE, candidates_dataset, found_in, search_of
from model.study.identification.search import joined


def run(
    space: Space,
    aims: Aims,
    descent: Descent,
    stage: int,
    starts: list[Path],
    before: list[Path],
    data: Path,
) -> dict[str, Any]:
    """Search from the best of the searches ``starts`` and of the rounds ``before``."""
    search = search_of(space)
    rounds = [found_in(space, read_dataset(path)) for path in before]
    known = joined([*(found_in(space, read_dataset(path)) for path in starts), *rounds])
    wanted = Wanted(aims, space.searched, SAFE)
    found = descended(search, known, wanted, descent, stage)
    title = f"Candidates of the search by the aims, round {stage}"
    write_dataset(candidates_dataset(search, joined([*rounds, found]), title), data)
    return {"sweep": space.identity}
