"""Judge one chunk of the identification's first samples."""

from pathlib import Path
from typing import Any

from model.study.config import Pool
from model.study.datasets import write_dataset
from model.study.identification.candidate import Space
from model.study.identification.results import samples_dataset, search_of


def run(space: Space, pool: Pool, chunk: int, data: Path) -> dict[str, Any]:
    """Write the samples of a chunk of the pool with their margins."""
    search = search_of(space)
    write_dataset(samples_dataset(search, search.sample(pool, chunk)), data)
    return {"sweep": space.identity}
