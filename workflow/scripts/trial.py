"""Run one chunk of an accuracy trial."""

from pathlib import Path

from study.tracking.records import recorded, snakemake
from verification.accuracy import run_trial, write_table
from verification.trials import Trial

with recorded(snakemake, part=True) as metadata:
    trial = Trial.model_validate(snakemake.params.trial)
    found = run_trial(trial, int(snakemake.wildcards.chunk), snakemake.params.chunks)
    write_table(found, Path(snakemake.output.table))
    metadata |= {
        "config_hash": trial.identity,
        "settings": trial.settings.model_dump(mode="json"),
        "counts": {"trajectories": int(found["set"].size)},
    }
