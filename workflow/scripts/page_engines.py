"""Compile the engine for the explorer into the cache, and write its interface and size."""

from pathlib import Path

from model.runs.in_browser import module_for
from model.sweeps.files import write_json
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    made = module_for()
    write_json({**made.interface, "bytes": len(made.binary)}, Path(snakemake.output.data))
