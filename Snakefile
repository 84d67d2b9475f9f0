"""The study of vibratory part alignment: `snakemake -c2` builds every result of the paper."""

from pathlib import Path

from snakemake.utils import min_version

from model.study.config import COMPUTED, FIGURES, GRIDDED, HISTORIES, MAPS, SCHEMATICS
from model.study.config import ConfigError, check_study, study_files

min_version("9.0")


report: "workflow/report/study.rst"


include: "workflow/rules/recording.smk"


for file in study_files(Path("config/config.yaml")):

    configfile: file


try:
    study = check_study(config, "config")
except ConfigError as fault:
    unread = f"the configuration breaks a rule\n{fault}"
    raise WorkflowError(unread)

root = invocation.root = Path(study.results_root)
invocation.state(study=study.model_dump(mode="json"))


wildcard_constraints:
    figure=r"fig\d\d",
    chunk=r"\d+",
    map="|".join(study.map_names),


include: "workflow/rules/job.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/maps.smk"
include: "workflow/rules/methods.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/fuzz.smk"


rule all:
    default_target: True
    input:
        root / "report.html",
        root / "runs.csv",
        page_files,


if workflow.is_main_process:
    announce(study_hash, codes)
unread = None  # the rules are, from here
