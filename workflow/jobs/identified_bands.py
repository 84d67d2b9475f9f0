"""Compute the bands of the admissible sets, over all curves of Figs. 6 to 12."""

from pathlib import Path
from typing import Any

from model.study.identification.band_table import bands_text
from model.study.identification.bands import bands_of
from model.study.identification.candidate import Space
from model.study.identification.committed import read_identified
from model.tracking.provenance import write_text


def run(space: Space, tables: list[Path], data: Path) -> dict[str, Any]:
    """Run every admissible set of the committed tables, and write the bands as CSV."""
    sets = read_identified(tables[0].parent).points(space.names)
    write_text(bands_text(bands_of(space, space.point(sets))), data)
    return {"sweep": space.identity}
