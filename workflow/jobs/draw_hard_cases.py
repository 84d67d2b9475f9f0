"""Draw one of the pictures of the hard cases."""

from pathlib import Path
from typing import Literal

from benchmarks.hard_cases import read_judged
from benchmarks.report.hard_cases_plots import error_over_stiffness, stability
from model.show.style import save
from model.study.config import HardCases


def run(
    picture: Literal["stability", "stiffness"], spec: HardCases, judged: Path, pictures: list[Path]
) -> None:
    """Draw ``picture`` from the table of all methods and cases."""
    rows = read_judged(judged)
    if picture == "stability":
        figure = stability(rows, {name: case.title for name, case in spec.all_cases.items()})
    else:
        figure = error_over_stiffness(rows, spec)
    save(figure, pictures[0].with_suffix(""))
