"""Compile the kernels of runs without event location, and record which ones they are."""

from pathlib import Path

from model.runs.unlocated import align_unlocated, unlocated_problem
from model.study.config import baseline
from model.tracking.provenance import write_json


def run(code: str, data: Path) -> None:
    """Compile by a short run; ``data`` states the hash of the kernels' ``code``."""
    align_unlocated([baseline()], "rk4", 0.1, horizon=0.1)
    problem = unlocated_problem(baseline())
    problem.rates(0.0, problem.start)
    problem.fall(0.0, problem.start)
    write_json({"kernels": code}, data)
