"""Compile the kernels into their cache, and record which ones they are."""

from pathlib import Path

from model.runs.align import align
from model.study.config import baseline
from model.tracking.provenance import write_json


def run(code: str, data: Path) -> None:
    """Compile by a short run; ``data`` states the hash of the kernels' ``code``."""
    align([baseline()], horizon=0.1, cores=1)
    write_json({"kernels": code}, data)
