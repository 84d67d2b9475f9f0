"""Plot a dataset, or several in one picture."""

from pathlib import Path

from model.sweeps.io import read_dataset
from study.plots import DRAWINGS
from study.tracking.records import recorded, snakemake
from vibralign.plots.style import save

with recorded(snakemake):
    datasets = [read_dataset(Path(file)) for file in snakemake.input]
    figure = DRAWINGS[snakemake.params.drawing](*datasets)
    save(figure, Path(snakemake.output.png).with_suffix(""))
