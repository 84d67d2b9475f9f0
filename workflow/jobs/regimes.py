"""Compute the regime of every figure, of the sets compared and of the study's device."""

from pathlib import Path

from model.study.identification.candidate import Space
from model.study.identification.regimes import regimes_of, regimes_text
from model.tracking.provenance import write_text


def run(space: Space, sets: dict[str, dict[str, float]], table: Path) -> None:
    """Write the regimes of ``sets``, by device, as CSV."""
    write_text(regimes_text(regimes_of(space, sets)), table)
