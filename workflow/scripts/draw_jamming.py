"""Draw jamming in the slot beside its closed forms."""

from pathlib import Path

from model.show.jamming import draw_jamming
from model.show.style import save
from model.study.io import read_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    figure = draw_jamming(read_dataset(Path(snakemake.input[0])))
    save(figure, Path(snakemake.output.png).with_suffix(""))
