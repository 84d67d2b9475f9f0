"""Render the report: one page with every figure, its caption, parameters and outcomes."""

from pathlib import Path

from model.sweeps.files import write_text
from study.config.study import Study
from study.report.page import render_report
from study.report.section import Results
from study.tracking.records import recorded, snakemake
from verification.bench.report import SECTIONS

with recorded(snakemake):
    page, study = Path(snakemake.output.page), Study.model_validate(snakemake.params.study)
    results = Results(page.parent, study, live=True)
    text = render_report(results, SECTIONS)
    if unstated := {*map(str, results.inputs)} - {*snakemake.input}:
        raise ValueError(f"not an input of the rule: {', '.join(sorted(unstated))}")
    write_text(text, page)
