"""The section on the identification: what the paper leaves unstated, and how unique it is."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from model.show.identification import CAPTIONS, READING_LABELS, SYMBOLS, WORDS
from model.show.report.section import Results, Section
from model.study.config import Range
from model.study.identification.candidate import searched_of, space_of
from model.study.identification.committed import PICTURES, Identified, Split, read_identified
from model.study.identification.results import made_with
from model.study.identification.score import judge_of

WORDS_OF_PARTS = {"search": "priors, figures, grids or settings", "claims": "claims"}


def section(results: Results) -> Section | None:
    """Return the section on the identification, if its tables are committed."""
    if not results.tables:
        return None
    study = results.study
    found = read_identified(results.tables[0].parent)
    space = space_of(study)
    now = made_with(space, judge_of(space))
    content = {
        "found": findings_of(
            found, searched_of(study.structure), study.identification.law.structure
        ),
        "changed": [WORDS_OF_PARTS[part] for part in now if found.made_with.get(part) != now[part]],
        "pictures": [results.picture(place, CAPTIONS[name]) for name, place in PICTURES.items()],
    }
    template = Path(__file__).with_suffix(".html.j2")
    return Section("identification", "What the paper leaves unstated", template, content)


@dataclass(frozen=True)
class Findings:
    """The result of the identification, summed up for the report.

    Attributes:
        sets: how many admissible sets.
        reproduced: claims that the best set reproduces on the study's own grids.
        counted: claims that counted.
        unknowns: of the structure: symbol, words, the study's value, 5 %, median, 95 %, and the
            width of the middle nine tenths over the prior's.
        held_out: the splits.
        rate: mean share of the claims held out that is reproduced.
        rate_of_possible: the same of those that some admissible set shows.
        prior_rate: share of the claims that a draw from the prior reproduces.
        readings: label, claims reproduced of those that counted, and names of the others.
        mended: of the claims that the consistent reading shows and the print does not, the label of
            each correction that shows some by itself, and their names.
        together: those of them that no correction shows by itself.
        printed_only: claims that the print shows and the consistent reading does not.
        nowhere: claims that no reading shows.
        never_together: claims that some draw from the prior shows, and no admissible set.
    """

    sets: int
    reproduced: int
    counted: int
    unknowns: tuple[tuple[str, str, float, float, float, float, float], ...]
    held_out: tuple[Split, ...]
    rate: float
    rate_of_possible: float
    prior_rate: float
    readings: tuple[tuple[str, int, str], ...]
    mended: tuple[tuple[str, str], ...]
    together: str
    printed_only: str
    nowhere: str
    never_together: str


def findings_of(
    found: Identified, chosen: Mapping[str, float], ranges: Mapping[str, Range]
) -> Findings:
    """Sum up the result of the identification.

    Args:
        found: the committed result.
        chosen: the study's own values of what was searched.
        ranges: the priors.
    """
    unknowns = []
    for name, law in ranges.items():
        low, median, high = np.quantile(found.ensemble[name], (0.05, 0.5, 0.95)).tolist()
        width = float(np.log(high / low) / (0.9 * np.log(law.high / law.low)))
        unknowns.append((SYMBOLS[name], WORDS[name], chosen[name], low, median, high, width))
    names = np.array(found.claims)
    readings = tuple(
        (
            READING_LABELS.get(name, name),
            int((found.counted & (margins > 0.0)).sum()),
            ", ".join(names[found.counted & (margins <= 0.0)]),
        )
        for name, margins in found.readings.items()
    )
    shown = {name: found.counted & (margins > 0.0) for name, margins in found.readings.items()}
    consistent, printed = shown.pop("consistent"), shown.pop("printed")
    any_alone = np.logical_or.reduce([np.zeros_like(consistent), *shown.values()])
    gained = consistent & ~printed
    return Findings(
        sets=len(next(iter(found.ensemble.values()))),
        reproduced=int((found.counted & (found.margins > 0.0)).sum()),
        counted=int(found.counted.sum()),
        unknowns=tuple(unknowns),
        held_out=found.splits,
        rate=float(np.mean([split.rate for split in found.splits])),
        rate_of_possible=float(np.mean([split.rate_of_possible for split in found.splits])),
        prior_rate=float(np.nanmean(found.prior_shares[found.counted])),
        readings=readings,
        mended=tuple(
            (READING_LABELS.get(name, name), ", ".join(names[gained & alone]))
            for name, alone in shown.items()
            if (gained & alone).any()
        ),
        together=", ".join(names[gained & ~any_alone]),
        printed_only=", ".join(names[printed & ~consistent]),
        nowhere=", ".join(names[found.counted & ~(consistent | printed | any_alone)]),
        never_together=", ".join(
            names[found.counted & (found.prior_shares > 0.0) & (found.ensemble_shares == 0.0)]
        ),
    )
