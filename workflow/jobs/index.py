"""Index all runs of a results root."""

from pathlib import Path

from model.tracking.index import write_index


def run(table: Path) -> None:
    """Write the index of the root that holds ``table``."""
    write_index(table.parent)
