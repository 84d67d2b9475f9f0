"""Search parameter sets under another reading of the equations."""

from pathlib import Path
from typing import Any

from model.study.config import Evolution
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import Space
from model.study.identification.results import candidates_dataset, samples_of, search_of


def run(
    space: Space, reading: str, rounds: list[Evolution], samples: list[Path], data: Path
) -> dict[str, Any]:
    """Search from the samples of the consistent reading."""
    search = search_of(space)
    first = samples_of([read_dataset(path) for path in samples])
    found = search.run(first, rounds[0], 0, 0)
    for stage, evolution in enumerate(rounds[1:], start=1):
        found = search.run(first, evolution, 0, stage, found)
    title = f"Candidates under the reading {reading}"
    write_dataset(candidates_dataset(search, found, title), data)
    return {"sweep": space.identity}
