"""Make the explorer of the study: the page that runs the engine."""

from pathlib import Path

from model.runs.in_browser import module_for
from model.sweeps.files import write_text
from study.config.study import Study
from study.explorer import study_model
from study.tracking.records import recorded, snakemake
from vibralign.explorer.page import build_page

with recorded(snakemake):
    made, study = module_for(), Study.model_validate(snakemake.params.study)
    page = build_page(study_model(study, made.interface), made)
    write_text(page, Path(snakemake.output.page))
