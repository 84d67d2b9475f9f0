"""Draw a picture of the comparison of methods."""

from pathlib import Path

from study.tracking.job import recorded, snakemake
from verification.bench.report.stability_plot import stability
from verification.bench.report.work_precision_plots import evaluations_over_error, time_over_error
from verification.bench.work_precision import read_settings
from vibralign.plots.style import save

DRAW = {"evaluations": evaluations_over_error, "times": time_over_error, "stability": stability}

with recorded(snakemake):
    settings = read_settings(Path(snakemake.input[0]))
    figure = DRAW[snakemake.params.picture](settings, snakemake.params.titles)
    save(figure, Path(snakemake.output.png).with_suffix(""))
