"""Draw a picture of speed against error."""

from pathlib import Path

from benchmarks.report.work_precision_plots import (
    evaluations_over_error,
    time_over_error,
    wrong_points,
)
from benchmarks.work_precision import read_timings
from model.show.style import save
from model.study.io import read_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    sources, titles = [Path(file) for file in snakemake.input], snakemake.params.titles
    if snakemake.params.picture == "evaluations":
        figure = evaluations_over_error(read_dataset(sources[0]), titles)
    elif snakemake.params.picture == "times":
        figure = time_over_error(read_timings(sources[0]), titles)
    else:
        figure = wrong_points([read_dataset(source) for source in sources])
    save(figure, Path(snakemake.output.png).with_suffix(""))
