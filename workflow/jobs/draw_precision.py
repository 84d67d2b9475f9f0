"""Draw one of the pictures of speed against error."""

from pathlib import Path
from typing import Literal

from benchmarks.report.work_precision_plots import (
    evaluations_over_error,
    time_over_error,
    wrong_points,
)
from benchmarks.work_precision import read_timings
from model.show.style import save
from model.study.datasets import read_dataset


def run(
    picture: Literal["evaluations", "times", "wrong_points"],
    titles: dict[str, str],
    sources: list[Path],
    pictures: list[Path],
) -> None:
    """Draw ``picture`` from its sources; ``titles`` are those of the cases."""
    if picture == "evaluations":
        figure = evaluations_over_error(read_dataset(sources[0]), titles)
    elif picture == "times":
        figure = time_over_error(read_timings(sources[0]), titles)
    else:
        figure = wrong_points([read_dataset(source) for source in sources])
    save(figure, pictures[0].with_suffix(""))
