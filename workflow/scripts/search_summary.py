"""Order the sets that were scored, and state the best one as the configuration does."""

from pathlib import Path

from model.sweeps.files import write_text
from study.identification.space import Space
from study.identification.tables import summary_texts
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    space = Space.model_validate(snakemake.params.space)
    texts = summary_texts(space, [Path(file) for file in snakemake.input])
    for name, text in texts.items():
        write_text(text, Path(snakemake.output[name]))
