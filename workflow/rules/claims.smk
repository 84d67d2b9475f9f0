"""The ledger: statements of the paper, judged by the figures."""


rule claims:
    input:
        "<results>/data/kernels.json",
        figures=expand("<results>/data/{figure}.nc", figure=study.computed),
    output:
        table=report("<results>/claims.csv", caption="../report/claims.rst", category="Claims"),
        record="<results>/claims.run.json",
    log:
        "<results>/logs/claims.log",
    localrule: True
    params:
        *code("claims"),
        settings=stated(study.settings),
        # When the jobs are planned: verdicts of random devices by another list stop the build.
        shares=lambda wildcards: stored_null(null_plan(study)).shares,
    message:
        "judging the statements of the paper"
    script:
        "../scripts/claims.py"
