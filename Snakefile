"""The study of vibratory part alignment: `snakemake -c2` builds all results."""

from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.utils import min_version

from study.config import ConfigError, check_files, check_study, study_files
from study.config.base import results_folder
from study.tracking.starts import begin, configure, refuse_module

min_version("9.14")
refuse_module(workflow)


report: "workflow/report/study.rst"


container: "vibralign.sif"  # for `--sdm apptainer` only: docs/howto/run-on-a-cluster.md


for file in study_files(Path(workflow.basedir, "config/config.yaml")):

    configfile: file


try:
    root = Path(results_folder(config["results_root"]))
except ValueError:  # refused below; the start is recorded all the same
    root = Path("results")
start = begin(workflow, root)
try:
    check_files(workflow.configfiles)
    study = check_study(config, "config")
except ConfigError as fault:
    raise WorkflowError(f"the configuration breaks a rule\n{fault}")
configure(start, study.model_dump(mode="json"))


pathvars:
    results=study.results_root,


wildcard_constraints:
    figure=r"fig\d\d",
    chunk=r"\d+",


include: "workflow/rules/common.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/pictures.smk"
include: "workflow/rules/methods.smk"
include: "workflow/rules/evidence.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/identification.smk"


rule all:
    default_target: True
    input:
        "<results>/report.html",
        rules.report.input,
    localrule: True
