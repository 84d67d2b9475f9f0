"""Compute the bands of the admissible sets, over all curves of Figs. 6 to 12."""

import argparse
from pathlib import Path

from model.study.identification.band_table import bands_text
from model.study.identification.bands import bands_of
from model.study.identification.candidate import Space
from model.study.identification.committed import read_identified
from model.tracking.provenance import Job, write_text


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--space", required=True, type=Space.model_validate_json)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("tables", nargs="+", type=Path, help="what was identified")
    arguments = parser.parse_args()
    space, job = arguments.space, Job("identified_bands")
    sets = read_identified(arguments.tables[0].parent).points(space.names)
    write_text(bands_text(bands_of(space, space.point(sets))), arguments.output)
    job.finish(arguments.record, [arguments.output], arguments.tables, sweep=space.identity)


if __name__ == "__main__":
    main()
