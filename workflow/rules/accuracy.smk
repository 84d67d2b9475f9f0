"""The integrator's accuracy on random sets: `snakemake -c2 accuracy`, apart from the study."""

from verification.trials import trial_of

trial_chunks = {"error": study.accuracy.chunks, "settled": study.accuracy.settled.chunks}

job(
    "trial",
    dict(table=root / "accuracy/{trial}/{chunk}.csv"),
    after_kernels,
    dict(
        trial=lambda wildcards: trial_of(study, wildcards.trial),
        chunk=lambda wildcards: int(wildcards.chunk),
        chunks=lambda wildcards: trial_chunks[wildcards.trial],
    ),
    wildcards=dict(trial="|".join(trial_chunks)),
    message="{wildcards.trial}: computing chunk {wildcards.chunk}",
)

job(
    "judge",
    dict(
        tables=expand(root / "accuracy/{trial}.csv", trial=trial_chunks),
        text=root / "accuracy/summary.txt",
    ),
    {
        trial: expand(root / f"accuracy/{trial}/{{chunk}}.csv", chunk=range(chunks))
        for trial, chunks in trial_chunks.items()
    },
    record=root / "accuracy/judge.run.json",
    message="judging the trials",
    local=True,
)

printed("accuracy", root / "accuracy/summary.txt", "the result of the trials")
