"""The study of vibratory part alignment: `snakemake -c2` builds every result of the paper."""

from pathlib import Path

from snakemake.utils import min_version

from model.study.config import CURVES, FIGURES, HISTORIES, MAPS, SCHEMATICS
from model.study.config import ConfigError, check_study

min_version("9.0")


include: "workflow/rules/recording.smk"


configfile: "config/config.yaml"


try:
    study = check_study(config, "config")
except ConfigError as fault:
    unread = f"the configuration breaks a rule\n{fault}"
    raise WorkflowError(unread)

root = invocation.root = Path(study.results_root)
gridded = CURVES + MAPS


wildcard_constraints:
    figure=r"fig\d\d",
    chunk=r"\d+",
    map="|".join(study.map_names),


include: "workflow/rules/common.smk"


rule all:
    input:
        root / "report.html",
        root / "claims.csv",
        root / "runs.csv",
        [drawn(figure) for figure in FIGURES],
        expand(root / "data/{figure}.nc", figure=computed),
        expand(root / "data/maps/{map}.nc", map=MAPS),
        [pictured(place) for place in (*PICTURES.values(), *HARD_PICTURES.values())],


include: "workflow/rules/compute.smk"
include: "workflow/rules/maps.smk"
include: "workflow/rules/precision.smk"
include: "workflow/rules/hard.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/contact.smk"
include: "workflow/rules/identification.smk"
include: "workflow/rules/show.smk"
include: "workflow/rules/accuracy.smk"


unread = None  # the rules are, from here
