"""Search from nothing for a device that shows what the paper says."""

from pathlib import Path

from model.sweeps.files import write_text
from study.config.identification import Effort
from study.identification.search import result_text, search
from study.identification.space import Space
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    space = Space.model_validate(snakemake.params.space)
    found = search(space, Effort.model_validate(snakemake.params.effort))
    write_text(result_text(space, found), Path(snakemake.output.found))
