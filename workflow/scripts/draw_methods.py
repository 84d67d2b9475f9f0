"""Draw a picture of the comparison of methods."""

from pathlib import Path

from benchmarks.hard_cases import read_judged
from benchmarks.report.hard_cases_plots import stability
from benchmarks.report.work_precision_plots import evaluations_over_error, time_over_error
from benchmarks.work_precision import read_settings
from model.show.style import save
from model.study.config.methods import HardCases
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    file, titles = Path(snakemake.input[0]), snakemake.params.titles
    cases = HardCases.model_validate(snakemake.params.hard_cases)
    draw = {
        "evaluations": lambda: evaluations_over_error(read_settings(file), titles),
        "times": lambda: time_over_error(read_settings(file), titles),
        "stability": lambda: stability(
            read_judged(file), {name: case.title for name, case in cases.all_cases.items()}
        ),
    }[snakemake.params.picture]
    save(draw(), Path(snakemake.output.png).with_suffix(""))
