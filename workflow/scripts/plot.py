"""Plot a dataset."""

from pathlib import Path

from model.sweeps.io import read_dataset
from study.plots import DRAWINGS
from study.tracking.records import recorded, snakemake
from vibralign.plots.style import save

with recorded(snakemake):
    dataset = read_dataset(Path(snakemake.input[0]))
    figure = DRAWINGS[snakemake.params.drawing](dataset)
    save(figure, Path(snakemake.output.png).with_suffix(""))
