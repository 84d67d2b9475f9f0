"""Move the structures of one search for a round."""

from pathlib import Path

from model.sweeps.files import write_text
from study.config.identification import Round
from study.identification.search import evolve
from study.identification.space import Space
from study.identification.tables import found_text, read_found
from study.tracking.records import recorded, snakemake

with recorded(snakemake, part=True):
    space = Space.model_validate(snakemake.params.space)
    before = read_found(space, [Path(file) for file in snakemake.input])
    number, start = int(snakemake.wildcards.round), int(snakemake.wildcards.start)
    spec = Round.model_validate(snakemake.params.round)
    found = evolve(space, spec, number, start, before)
    write_text(found_text(space, found), Path(snakemake.output.sets))
