"""Compile the kernels into their cache, and record which ones they are."""

from pathlib import Path

from model.events.insertion import INSERTION
from model.physics.parameters import Parameters
from model.runs.align import align
from model.runs.simulate import simulate
from model.study.files import write_json
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as metadata:
    device = Parameters(**snakemake.params.parameters)
    # One process, in which the kernels of one scene shorten the compilation of the other's.
    align([device], horizon=0.1, cores=1)
    align([device], horizon=0.1, cores=1, scene=INSERTION)
    simulate(device, horizon=0.1)
    write_json({"kernels": metadata["code"]}, Path(snakemake.output.data))
