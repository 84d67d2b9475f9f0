"""The integrator's accuracy on random sets: `snakemake -c2 accuracy`, apart from the study."""


rule trial:
    input:
        kernels=root / "data/kernels.json",
    output:
        table=root / "accuracy/{trial}/{chunk}.csv",
        record=root / "accuracy/{trial}/{chunk}.run.json",
    log:
        root / "logs/trial/{trial}/{chunk}.log",
    wildcard_constraints:
        trial="error|settled",
    conda:
        "../envs/study.yaml"
    params:
        code=code("run_trial"),
        trial=lambda wildcards: trial(wildcards.trial),
        chunks=lambda wildcards: len(trial_chunks(wildcards.trial)),
    message:
        "{wildcards.trial}: trying chunk {wildcards.chunk} ({params.chunks} in all, from 0)"
    shell:
        "python workflow/scripts/run_trial.py --trial {params.trial:q}"
        " --chunk {wildcards.chunk} --chunks {params.chunks}"
        " --output {output.table} --record {output.record} > {log} 2>&1"


rule judge:
    input:
        error=trial_chunks("error"),
        settled=trial_chunks("settled"),
    output:
        root / "accuracy/error.csv",
        root / "accuracy/settled.csv",
        summary=root / "accuracy/summary.txt",
        record=root / "accuracy/judge.run.json",
    log:
        root / "logs/judge.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("judge_trials"),
        folder=root / "accuracy",
    message:
        "judging the trials"
    shell:
        "python workflow/scripts/judge_trials.py --output {params.folder}"
        " --record {output.record}"
        " --error {input.error} --settled {input.settled} > {log} 2>&1"


# Prints, whether or not anything had to be computed.
rule accuracy:
    input:
        root / "accuracy/summary.txt",
    log:
        root / "logs/accuracy.log",
    conda:
        "../envs/study.yaml"
    message:
        "what the trials show"
    shell:
        "cat {input} | tee {log}"
