"""Make the explorer of the study: the page that runs the engines."""

from pathlib import Path

from model.runs.in_browser import module_for
from model.show.explorer.content import study_model
from model.show.explorer.page import build_page
from model.study.config.study import Study
from model.sweeps.files import write_text
from model.tracking.job import recorded, snakemake

with recorded(snakemake):
    made, study = module_for(), Study.model_validate(snakemake.params.study)
    maps = [Path(file) for file in snakemake.input.maps]
    page = build_page(study_model(study, made.interface, maps), made)
    write_text(page, Path(snakemake.output.page))
