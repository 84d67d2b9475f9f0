"""The claims ledger: the paper's claims, judged by figures and by runs of their own; jamming."""


localrules:
    claims,
    draw_claims,
    draw_jamming,


claims_data = expand("<results>/data/claims/{run}.nc", run=study.claims_runs)


# One job for all runs, because a start of Python costs as much as most of them.
rule claims_runs:
    input:
        "<results>/data/kernels.json",
    output:
        data=claims_data,
        record="<results>/data/claims/runs.run.json",
    log:
        "<results>/logs/claims_runs.log",
    params:
        *code("claims_runs"),
        sweeps={name: stated(sweep_of(study, name)) for name in study.claims_runs},
        titles={name: run.title for name, run in study.claims_runs.items()},
    message:
        "computing the runs that only the claims ledger needs"
    script:
        "../scripts/claims_runs.py"


rule claims:
    input:
        expand("<results>/data/{figure}.nc", figure=COMPUTED),
        claims_data,
    output:
        table=report("<results>/claims.csv", caption="../report/claims.rst", category="Claims"),
        record="<results>/claims.run.json",
    log:
        "<results>/logs/claims.log",
    params:
        *code("claims"),
    message:
        "judging the claims of the paper"
    script:
        "../scripts/claims.py"


rule draw_claims:
    input:
        claims_data,
    output:
        multiext("<results>/figures/claims", ".svg", ".pdf"),
        png=report(
            "<results>/figures/claims.png", caption="../report/claims_runs.rst", category="Claims"
        ),
        record="<results>/figures/claims.run.json",
    log:
        "<results>/logs/draw_claims.log",
    params:
        *code("draw_claims"),
    message:
        "drawing the runs that only the claims ledger needs"
    script:
        "../scripts/draw_claims.py"


rule jamming:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/jamming.nc",
        record="<results>/data/jamming.run.json",
    log:
        "<results>/logs/jamming.log",
    params:
        *code("sweep"),
        sweep=stated(sweep_of(study, "jamming")),
        title=study.jamming.title,
    message:
        "following parts into the slot"
    script:
        "../scripts/sweep.py"


rule draw_jamming:
    input:
        "<results>/data/jamming.nc",
    output:
        multiext("<results>/figures/jamming", ".svg", ".pdf"),
        png=report(
            "<results>/figures/jamming.png", caption="../report/jamming.rst", category="Claims"
        ),
        record="<results>/figures/jamming.run.json",
    log:
        "<results>/logs/draw_jamming.log",
    params:
        *code("draw_jamming"),
    message:
        "drawing jamming in the slot"
    script:
        "../scripts/draw_jamming.py"
