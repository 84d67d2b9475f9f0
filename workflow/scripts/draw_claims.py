"""Draw the runs of the claims ledger that no figure has."""

from pathlib import Path

from model.show.curves import draw_runs
from model.show.style import save
from model.study.io import read_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    datasets = {Path(file).stem: read_dataset(Path(file)) for file in snakemake.input}
    save(draw_runs(datasets), Path(snakemake.output.png).with_suffix(""))
