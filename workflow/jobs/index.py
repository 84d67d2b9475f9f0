"""Index all runs of a results root."""

from pathlib import Path

from model.tracking.index import write_index


def run(files: list[Path]) -> None:
    """Write the index into the folder of its ``files``."""
    write_index(files[0].parent)
