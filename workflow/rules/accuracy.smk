"""Checks of the integrator on random sets: `snakemake -c2 accuracy` and `make fuzz`."""

from verification.fuzz_campaign import HOLDS
from verification.trials import trial_of

trial_chunks = {"error": study.accuracy.chunks, "settled": study.accuracy.settled.chunks}
campaign = study.accuracy.fuzz


rule trial:
    input:
        "<results>/data/kernels.json",
    output:
        table="<results>/accuracy/{trial}/{chunk}.csv",
        record="<results>/accuracy/{trial}/{chunk}.run.json",
    log:
        "<results>/logs/trial/{trial}/{chunk}.log",
    wildcard_constraints:
        trial="|".join(trial_chunks),
    params:
        *code("trial"),
        trial=lambda wildcards: stated(trial_of(study, wildcards.trial)),
        chunks=lambda wildcards: trial_chunks[wildcards.trial],
    message:
        "{wildcards.trial}: computing chunk {wildcards.chunk}"
    script:
        "../scripts/trial.py"


rule trial_summary:
    input:
        **{
            trial: expand(f"<results>/accuracy/{trial}/{{chunk}}.csv", chunk=range(chunks))
            for trial, chunks in trial_chunks.items()
        },
    output:
        tables=expand("<results>/accuracy/{trial}.csv", trial=trial_chunks),
        text="<results>/accuracy/summary.txt",
        record="<results>/accuracy/summary.run.json",
    log:
        "<results>/logs/trial_summary.log",
    localrule: True
    params:
        *code("trial_summary"),
    message:
        "summing up the trials"
    script:
        "../scripts/trial_summary.py"


# A larger number of sets adds parts; finished parts stay.
rule fuzz_part:
    input:
        "<results>/data/kernels.json",
    output:
        found="<results>/accuracy/fuzz/{scene}/{size}/{chunk}.json",
        record="<results>/accuracy/fuzz/{scene}/{size}/{chunk}.run.json",
    log:
        "<results>/logs/fuzz_part/{scene}/{size}/{chunk}.log",
    params:
        *code("fuzz_part"),
        numbers=numbers_of_part,
    message:
        "fuzz: trying part {wildcards.chunk}"
    script:
        "../scripts/fuzz_part.py"


rule fuzz_summary:
    input:
        expand(
            "<results>/accuracy/fuzz/{{scene}}/{size}/{part}.json",
            size=campaign.sets_a_job,
            part=range(-(-campaign.sets // campaign.sets_a_job)),
        ),
    output:
        text="<results>/accuracy/fuzz_{scene}.txt",
        record="<results>/accuracy/fuzz_{scene}.run.json",
    log:
        "<results>/logs/fuzz_summary/{scene}.log",
    localrule: True
    params:
        *code("fuzz_summary"),
        seed=campaign.seed,
    message:
        "fuzz: adding up its parts"
    script:
        "../scripts/fuzz_summary.py"


# These print a result even if nothing was computed. They are no runs: their logs are not below logs/.
for name, text, must_end in (
    ("accuracy", "accuracy/summary.txt", ""),
    ("fuzz", f"accuracy/fuzz_{campaign.scene}.txt", HOLDS),
):

    rule:
        name:
            name
        input:
            f"<results>/{text}",
        log:
            f"<results>/{text}.log",
        localrule: True
        params:
            must_end=must_end,
        message:
            f"the result of {name}"
        script:
            "../scripts/print_result.py"
