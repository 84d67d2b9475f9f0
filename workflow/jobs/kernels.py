"""Compile the kernels into their cache, and record which ones they are."""

from pathlib import Path

from model.events.insertion import INSERTION
from model.runs.align import align
from model.runs.simulate import simulate
from model.study.config import baseline
from model.tracking.provenance import write_json


def run(code: str, data: Path) -> None:
    """Compile both engines by short runs; ``data`` states the hash of the kernels' ``code``.

    One process, in which the kernels of one scene shorten the compilation of the other's.
    """
    align([baseline()], horizon=0.1, cores=1)
    align([baseline()], horizon=0.1, cores=1, scene=INSERTION)
    simulate(baseline(), horizon=0.1)
    write_json({"kernels": code}, data)
