"""Score a set of the search on the study's own grids."""

from pathlib import Path

from model.sweeps.files import write_text
from study.config.identification import Stage
from study.identification.search import final
from study.identification.space import Space
from study.identification.tables import read_found, scored_text
from study.tracking.records import recorded, snakemake

with recorded(snakemake, part=True):
    space = Space.model_validate(snakemake.params.space)
    found = read_found(space, [Path(file) for file in snakemake.input])
    stages = [Stage.model_validate(stage) for stage in snakemake.params.stages]
    choice, datasets = final(space, stages, int(snakemake.wildcards.number), found)
    write_text(scored_text(space, choice, datasets), Path(snakemake.output.scored))
