"""Take small steps from a set that was scored, on the study's own grids."""

from pathlib import Path

from model.sweeps.files import write_text
from study.config.identification import Stage
from study.identification.search import polish
from study.identification.space import Space
from study.identification.tables import read_scored, scored_text
from study.tracking.records import recorded, snakemake

with recorded(snakemake, part=True):
    space = Space.model_validate(snakemake.params.space)
    found = read_scored(space, [Path(file) for file in snakemake.input])
    stages = [Stage.model_validate(stage) for stage in snakemake.params.stages]
    number, trials = int(snakemake.wildcards.number), int(snakemake.params.trials)
    choice, datasets = polish(space, stages, trials, number, found)
    write_text(scored_text(space, choice, datasets), Path(snakemake.output.scored))
