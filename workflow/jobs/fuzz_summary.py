"""Add up the parts of `make fuzz`."""

from pathlib import Path

from model.tracking.provenance import write_text
from verification.fuzz_campaign import added, read_report, summary


def run(scene: str, seed: int, parts: list[Path], text: Path) -> None:
    """Write what all parts found, as ``text``."""
    write_text(summary(added([read_report(path) for path in parts]), seed, scene), text)
