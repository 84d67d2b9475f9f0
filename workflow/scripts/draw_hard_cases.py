"""Draw a picture of the hard cases."""

from pathlib import Path

from benchmarks.hard_cases import read_judged
from benchmarks.report.hard_cases_plots import error_over_stiffness, stability
from model.show.style import save
from model.study.config.methods import HardCases
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    rows = read_judged(Path(snakemake.input[0]))
    spec = HardCases.model_validate(snakemake.params.spec)
    if snakemake.params.picture == "stability":
        figure = stability(rows, {name: case.title for name, case in spec.all_cases.items()})
    else:
        figure = error_over_stiffness(rows, spec)
    save(figure, Path(snakemake.output.png).with_suffix(""))
