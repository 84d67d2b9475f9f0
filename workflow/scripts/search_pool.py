"""Draw structures from the priors and choose the operating points of their figures."""

from pathlib import Path

from model.sweeps.files import write_text
from study.config.identification import Stage
from study.identification.search import pool
from study.identification.space import Space
from study.identification.tables import found_text
from study.tracking.records import recorded, snakemake

with recorded(snakemake, part=True):
    space = Space.model_validate(snakemake.params.space)
    stages = [Stage.model_validate(stage) for stage in snakemake.params.stages]
    found = pool(space, snakemake.params.structures, stages, int(snakemake.wildcards.part))
    write_text(found_text(space, found), Path(snakemake.output.sets))
