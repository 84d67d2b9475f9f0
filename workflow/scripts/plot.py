"""Plot a dataset; a refined map is plotted with the points of its figure."""

from pathlib import Path

from model.show.plots import draw
from model.show.style import save
from model.study.io import read_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    datasets = [read_dataset(Path(file)) for file in snakemake.input]
    save(draw(*datasets), Path(snakemake.output.png).with_suffix(""))
