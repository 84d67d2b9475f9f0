"""Compute the regime of every figure, of the former devices and of the study's."""

from pathlib import Path

from model.study.config import Study
from model.study.identification.regimes import regimes_of, regimes_text
from model.tracking.provenance import write_text


def run(study: Study, table: Path) -> None:
    """Write the regimes as CSV."""
    write_text(regimes_text(regimes_of(study)), table)
