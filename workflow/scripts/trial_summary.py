"""Gather the chunks of both accuracy trials into their tables, and summarise them."""

from pathlib import Path

from model.sweeps.files import write_text
from study.tracking.records import recorded, snakemake
from verification.accuracy import read_tables, summary, write_table

with recorded(snakemake):
    gathered = [
        read_tables([Path(file) for file in files])
        for files in (snakemake.input.error, snakemake.input.settled)
    ]
    for table, file in zip(gathered, snakemake.output.tables, strict=True):
        write_table(table, Path(file))
    write_text(summary(*gathered), Path(snakemake.output.text))
