"""Gather the chunks of both accuracy trials into their tables, and summarise them."""

from pathlib import Path

from model.tracking.provenance import write_text
from verification.accuracy import read_tables, summary, write_table


def run(error: list[Path], settled: list[Path], tables: list[Path], text: Path) -> None:
    """Write both tables, and the summary as ``text``."""
    gathered = read_tables(error), read_tables(settled)
    for table, path in zip(gathered, tables, strict=True):
        write_table(table, path)
    write_text(summary(*gathered), text)
