"""Judge one chunk of the identification's first samples."""

from pathlib import Path
from typing import Any

from model.study.config import Pool
from model.study.datasets import write_dataset
from model.study.identification.candidate import Space
from model.study.identification.evaluate import judge_of
from model.study.identification.results import samples_dataset
from model.study.identification.search import sample


def run(space: Space, pool: Pool, chunk: int, data: Path) -> dict[str, Any]:
    """Write the samples of a chunk of the pool with their margins."""
    judge = judge_of(space)
    write_dataset(samples_dataset(space, judge, sample(space, judge, pool, chunk)), data)
    return {"sweep": space.identity}
