"""Plot where the part aligns only with vibration, only without, with and without, or not at all."""

from pathlib import Path

from model.show.maps import vibration_map
from model.show.style import save
from model.study.io import read_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    figure = vibration_map(read_dataset(Path(snakemake.input[0])))
    save(figure, Path(snakemake.output.png).with_suffix(""))
