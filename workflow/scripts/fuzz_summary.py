"""Add up the parts of `make fuzz`."""

from pathlib import Path

from model.sweeps.files import write_text
from study.tracking.records import recorded, snakemake
from verification.fuzz_campaign import added, read_report, summary

with recorded(snakemake):
    found = added([read_report(Path(file)) for file in snakemake.input])
    text = summary(found, snakemake.params.seed, snakemake.wildcards.scene)
    write_text(text, Path(snakemake.output.text))
