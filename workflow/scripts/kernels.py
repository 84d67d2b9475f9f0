"""Compile the kernels into the cache, and write the hash of their code."""

from pathlib import Path

from model.events.insertion import INSERTION
from model.physics.parameters import Parameters
from model.runs.align import align
from model.runs.simulate import simulate
from model.sweeps.files import write_json
from study.tracking.records import recorded, snakemake

with recorded(snakemake) as metadata:
    device = Parameters(**snakemake.params.parameters)
    # In one process, because kernels compiled for one scene are reused for the other.
    align([device], horizon=0.1, cores=1)
    align([device], horizon=0.1, cores=1, scene=INSERTION)
    simulate(device, horizon=0.1)
    write_json({"kernels": metadata["code"]}, Path(snakemake.output.data))
