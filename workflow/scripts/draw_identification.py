"""Draw a picture of what was identified: the structure, the claims, or the readings."""

import argparse
import json
from pathlib import Path

import numpy as np

from model.show.identification import claim_shares, readings_by_claims, structure_pairs
from model.show.style import save
from model.study.config import SearchLaw
from model.study.identification.candidate import searched_of
from model.study.identification.committed import read_identified
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture", required=True, choices=["structure", "claims", "readings"])
    parser.add_argument("--structure", required=True, type=json.loads, help="the study's own")
    parser.add_argument("--law", required=True, type=SearchLaw.model_validate_json)
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("--tables", required=True, nargs="+", type=Path)
    arguments = parser.parse_args()
    job = Job("draw_identification", arguments.picture)
    found = read_identified(arguments.tables[0].parent)
    if arguments.picture == "structure":
        law: SearchLaw = arguments.law
        figure = structure_pairs(found.ensemble, searched_of(arguments.structure), law.structure)
    elif arguments.picture == "claims":
        figure = claim_shares(
            found.claims, found.ensemble_shares, found.prior_shares, found.margins > 0.0
        )
    else:
        margins = np.array(list(found.readings.values()))
        figure = readings_by_claims(list(found.readings), found.claims, margins, found.counted)
    pictures = save(figure, arguments.output.with_suffix(""))
    job.finish(arguments.record, pictures, arguments.tables)


if __name__ == "__main__":
    main()
