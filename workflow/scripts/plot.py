"""Plot a dataset, or several in one picture."""

from pathlib import Path

from model.show.plots import DRAWINGS
from model.show.style import save
from model.sweeps.io import read_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    datasets = [read_dataset(Path(file)) for file in snakemake.input]
    figure = DRAWINGS[snakemake.params.drawing](*datasets)
    save(figure, Path(snakemake.output.png).with_suffix(""))
