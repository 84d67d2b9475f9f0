"""Compile the kernels of runs without event location, and record which ones they are."""

from pathlib import Path

from model.study.config import baseline
from model.tracking.provenance import write_json
from verification import without_location


def run(code: str, data: Path) -> None:
    """Compile by a short run; ``data`` states the hash of the kernels' ``code``."""
    without_location.align([baseline()], "rk4", 0.1, horizon=0.1)
    problem = without_location.initial_value_problem(baseline())
    problem.rates(0.0, problem.start)
    problem.fall(0.0, problem.start)
    write_json({"kernels": code}, data)
