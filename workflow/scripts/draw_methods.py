"""Draw the picture of the comparison of methods."""

from pathlib import Path

from study.tracking.records import recorded, snakemake
from verification.bench.report.work_precision_plots import time_over_error
from verification.bench.work_precision import read_settings
from vibralign.plots.style import save

with recorded(snakemake):
    settings = read_settings(Path(snakemake.input.times))
    picture = time_over_error(settings, snakemake.params.cases)
    save(picture, Path(snakemake.output.png).with_suffix(""))
