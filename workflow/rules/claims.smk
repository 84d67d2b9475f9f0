"""The claims ledger: the paper's claims, judged by figures and by runs of their own."""

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
        "<results>/data/null.nc",
    output:
        table=report("<results>/claims.csv", caption="../report/claims.rst", category="Claims"),
        record="<results>/claims.run.json",
    log:
        "<results>/logs/claims.log",
    localrule: True
    params:
        *code("claims"),
    message:
        "judging the claims of the paper"
    script:
        "../scripts/claims.py"
