"""The claims ledger: what the paper says, judged by the figures' data and by a few runs more."""

claims_data = expand(root / "data/claims/{run}.nc", run=study.claims_runs)


# One job, because a start of Python costs as much as most of these runs.
rule claims_runs:
    input:
        kernels=root / "data/kernels.json",
    output:
        data=claims_data,
        record=root / "data/claims/runs.run.json",
    log:
        root / "logs/claims_runs.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("run_claims"),
        runs=runs_of_claims(),
        folder=root / "data/claims",
    message:
        "computing what only the claims ledger asks for"
    shell:
        "python workflow/scripts/run_claims.py --runs {params.runs:q}"
        " --output {params.folder} --record {output.record} > {log} 2>&1"


rule claims:
    input:
        figures=expand(root / "data/{figure}.nc", figure=computed),
        runs=claims_data,
    output:
        table=root / "claims.csv",
        record=root / "claims.run.json",
    log:
        root / "logs/claims.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("judge_claims"),
    message:
        "judging the claims of the paper"
    shell:
        "python workflow/scripts/judge_claims.py --output {output.table}"
        " --record {output.record} {input} > {log} 2>&1"


rule draw_claims:
    input:
        claims_data,
    output:
        png=root / "figures/claims.png",
        svg=root / "figures/claims.svg",
        pdf=root / "figures/claims.pdf",
        record=root / "figures/claims.run.json",
    log:
        root / "logs/draw_claims.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_claims"),
    message:
        "drawing what only the claims ledger asks for"
    shell:
        "python workflow/scripts/draw_claims.py --output {output.png}"
        " --record {output.record} {input} > {log} 2>&1"
