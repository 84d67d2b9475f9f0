"""Worth of the verdicts: devices drawn at random, and the study's under other assumptions."""

from study.evidence.assumptions import assumptions_plan
from study.evidence.null import null_plan

null_plans = {kind: stated(null_plan(study, kind)) for kind in study.evidence.draws}


rule null_part:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/null/{kind}/{part}.nc",
        record="<results>/data/null/{kind}/{part}.run.json",
    log:
        "<results>/logs/null_part/{kind}/{part}.log",
    params:
        *code("null_part"),
        plan=lambda wildcards: null_plans[wildcards.kind],
    message:
        "null: drawing part {wildcards.part} of the {wildcards.kind}"
    script:
        "../scripts/null_part.py"


rule null:
    input:
        [
            f"<results>/data/null/{kind}/{part}.nc"
            for kind, draws in study.evidence.draws.items()
            for part in range(draws.parts)
        ],
    output:
        data="<results>/data/null.nc",
        record="<results>/data/null.run.json",
    log:
        "<results>/logs/null.log",
    localrule: True
    params:
        *code("null"),
        plans=null_plans,
        titles=[draws.title for draws in study.evidence.draws.values()],
    message:
        "null: shares of random devices that show a claim"
    script:
        "../scripts/null.py"


rule assumptions:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/assumptions.nc",
        record="<results>/data/assumptions.run.json",
    log:
        "<results>/logs/assumptions.log",
    params:
        *code("assumptions"),
        plan=stated(assumptions_plan(study)),
        titles={name: each.title for name, each in study.evidence.assumptions.items()},
    message:
        "judging the device under other assumptions"
    script:
        "../scripts/assumptions.py"
