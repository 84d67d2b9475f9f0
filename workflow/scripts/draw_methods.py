"""Draw a picture of the comparison of methods."""

from pathlib import Path

from benchmarks.hard_cases import read_judged
from benchmarks.report.hard_cases_plots import stability
from benchmarks.report.work_precision_plots import (
    evaluations_over_error,
    time_over_error,
    wrong_points,
)
from benchmarks.work_precision import read_timings
from model.show.style import save
from model.study.config.methods import HardCases
from model.study.io import read_dataset
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    files, titles = [Path(file) for file in snakemake.input], snakemake.params.titles
    cases = HardCases.model_validate(snakemake.params.hard_cases)
    draw = {
        "evaluations": lambda: evaluations_over_error(read_dataset(files[0]), titles),
        "times": lambda: time_over_error(read_timings(files[0]), titles),
        "wrong_points": lambda: wrong_points([read_dataset(file) for file in files]),
        "stability": lambda: stability(
            read_judged(files[0]), {name: case.title for name, case in cases.all_cases.items()}
        ),
    }[snakemake.params.picture]
    save(draw(), Path(snakemake.output.png).with_suffix(""))
