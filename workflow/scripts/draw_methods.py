"""Draw the pictures of the comparison of methods."""

from pathlib import Path

from study.tracking.records import recorded, snakemake
from verification.bench.plans import PICTURES
from verification.bench.report.work_precision_plots import evaluations_over_error, time_over_error
from verification.bench.work_precision import read_settings
from vibralign.plots.style import save

with recorded(snakemake):
    settings, timed = (read_settings(Path(file)) for file in snakemake.input)
    cases = snakemake.params.cases
    drawn = {
        "evaluations": evaluations_over_error(settings, cases),
        "times": time_over_error(timed, cases),
    }
    for name, picture in zip(PICTURES, snakemake.output.png, strict=True):
        save(drawn[name], Path(picture).with_suffix(""))
