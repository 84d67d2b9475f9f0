"""Compile the kernels of runs without event location, and write the hash of their code."""

from pathlib import Path

from model.physics.parameters import Parameters
from model.sweeps.files import write_json
from study.tracking.records import recorded, snakemake
from verification.bench.methods import compile_unlocated

with recorded(snakemake) as metadata:
    compile_unlocated(Parameters(**snakemake.params.parameters))
    write_json({"kernels": metadata["code"]}, Path(snakemake.output.data))
