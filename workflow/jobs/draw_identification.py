"""Draw one of the pictures of the identification."""

from pathlib import Path
from typing import Literal

import numpy as np

from model.show.front import budget_picture, front_picture
from model.show.identification import claim_shares, readings_by_claims, structure_pairs
from model.show.style import save
from model.study.config import Aims, SearchLaw
from model.study.identification.candidate import searched_of
from model.study.identification.committed import read_identified


def run(
    picture: Literal["structure", "claims", "readings", "front", "budget"],
    structure: dict[str, float],
    law: SearchLaw,
    aims: Aims,
    tables: list[Path],
    pictures: list[Path],
) -> None:
    """Draw ``picture`` from the committed tables; ``structure`` is the study's own."""
    found = read_identified(tables[0].parent)
    if picture == "structure":
        figure = structure_pairs(found.ensemble, searched_of(structure), law.structure)
    elif picture == "front":
        figure = front_picture(found.front, aims)
    elif picture == "budget":
        figure = budget_picture(found.budget, aims)
    elif picture == "claims":
        figure = claim_shares(
            found.claims, found.ensemble_shares, found.prior_shares, found.margins > 0.0
        )
    else:
        margins = np.array(list(found.readings.values()))
        figure = readings_by_claims(list(found.readings), found.claims, margins, found.counted)
    save(figure, pictures[0].with_suffix(""))
