"""Compile the kernels of runs without event location, and record which ones they are."""

from pathlib import Path

from benchmarks.methods import compile_unlocated
from model.study.config import baseline
from model.tracking.provenance import write_json


def run(code: str, data: Path) -> None:
    """Compile by short runs; ``data`` states the hash of the kernels' ``code``."""
    compile_unlocated(baseline())
    write_json({"kernels": code}, data)
