"""Compile the engines for the explorer into the cache, and write their sizes and hashes."""

import hashlib
from pathlib import Path

from model.runs.in_browser import modules
from model.sweeps.files import write_json
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    made = modules()
    digests = {
        name: {"bytes": len(each), "sha256": hashlib.sha256(each).hexdigest()}
        for name, each in {"run_one": made.run_one, "run_many": made.run_many}.items()
    }
    write_json({**made.interface, "modules": digests}, Path(snakemake.output.data))
