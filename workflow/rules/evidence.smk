"""What the verdicts are worth: other assumptions and devices; `make null` draws the random ones."""

from study.evidence.cases import cases_plan
from study.evidence.null import null_plan, stored_null


rule cases:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/cases.nc",
        record="<results>/data/cases.run.json",
    log:
        "<results>/logs/cases.log",
    params:
        *code("cases"),
        plan=stated(cases_plan(study)),
        null=stated(null_plan(study)),
    message:
        "judging the device under other assumptions"
    script:
        "../scripts/cases.py"


# The verdicts are stored beside the code, so that a build does not draw the devices.
rule null:
    input:
        "<results>/data/kernels.json",
    output:
        stored=update("src/study/evidence/null.csv"),
        record="<results>/null.run.json",
    log:
        "<results>/logs/null.log",
    params:
        *code("null"),
        plan=stated(null_plan(study)),
    message:
        "drawing random devices, and judging them"
    script:
        "../scripts/null.py"
