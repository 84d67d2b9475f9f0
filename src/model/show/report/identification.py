"""The section on the identification: what the paper leaves unstated, and how unique it is."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from model.show.front import CAPTIONS as FRONT_CAPTIONS
from model.show.identification import CAPTIONS, READING_LABELS, UNKNOWNS
from model.show.report.section import Results, Section, Table
from model.show.words import figure_title, percent
from model.study.config import Aims, Range
from model.study.identification.candidate import searched_of, space_of
from model.study.identification.committed import PICTURES, FrontSet, Identified, read_identified
from model.study.identification.regimes import PRESENT, Row, read_regimes
from model.study.identification.results import made_with
from model.study.identification.score import judge_of

WORDS_OF_PARTS = {"search": "priors, figures, grids or settings", "claims": "claims"}


def section(results: Results) -> Section | None:
    """Return the section on the identification, if its tables are committed."""
    if not results.tables:
        return None
    study = results.study
    found, space = read_identified(results.tables[0].parent), space_of(study)
    now, aims = made_with(space, judge_of(space)), study.identification.aims
    content = {
        **content_of(found, searched_of(study.structure), study.identification.law.structure),
        "changed": [WORDS_OF_PARTS[part] for part in now if found.made_with.get(part) != now[part]],
        "pictures": {
            name: results.picture(place, {**CAPTIONS, **FRONT_CAPTIONS}[name])
            for name, place in PICTURES.items()
        },
        "regimes": regime_table(read_regimes(results.file("data/regimes.csv"))),
        "aims": aims,
        "missing": len(found.front[-1].lacking - set(aims.beside)),
        "exclusions": exclusions(found.front, aims),
        "pairs": pair_table(found.front, aims),
    }
    template = Path(__file__).with_suffix(".html.j2")
    lead = (
        "The paper does not state the size of the part, the suspension but for its scaling, nor "
        f"most operating points. The best set found reproduces {content['reproduced']} of the "
        f"{content['counted']} claims that counted in the search; {content['sets']} sets with a "
        "structure each are admissible, so it is one of many."
    )
    return Section("identification", "What the paper leaves unstated", template, content, lead)


def in_brief(found: Identified, rows: Sequence[Row], aims: Aims) -> str:
    """Return in three sentences what was found: regime, claims, and aims that are not met."""
    chosen = found.front[-1]
    asked = chosen.claims + len(chosen.lacking - set(aims.beside))
    resting: dict[str, list[float]] = {}
    for row in rows:
        resting.setdefault(row.device, []).append(1.0 - row.regime.not_resting)
    shares = {device: percent(float(np.mean(each))) for device, each in resting.items()}
    own = shares.pop(PRESENT)
    others = ", ".join(f"{share} of the {device} device's" for device, share in shares.items())
    missed = ", ".join(name for name, ratio in ratios_of(chosen, aims).items() if ratio > 1.0)
    return (
        f"The device is one that vibration aligns: without it {own} of the points that align rest "
        f"on the edge, slightly tilted, in the mean over the figures; {others}. It shows "
        f"{chosen.claims} of {asked} claims of the paper, and was chosen for both among "
        f"{found.budget[-1].candidates:,} candidates. None of them meets every aim; this one falls "
        f"short in {missed}."
    )


def regime_table(rows: Sequence[Row]) -> Table:
    """Return the regimes by figure, one device beside the other."""
    devices = list(dict.fromkeys(row.device for row in rows))
    names = ("aligned", "static", "not at rest", "median tilt", "largest", "corners", "lift-offs")
    by_figure: dict[str, list[str]] = {}
    for row in rows:
        cells = by_figure.setdefault(row.figure, [figure_title(row.figure)])
        cells += ["–" if math.isnan(each) else f"{each:.2f}" for each in row.regime]
    columns = ["", *(f">{name}, {device}" for device in devices for name in names)]
    return Table(columns, list(by_figure.values()))


def content_of(
    found: Identified, chosen: Mapping[str, float], ranges: Mapping[str, Range]
) -> dict[str, Any]:
    """Return what the template says of the result.

    Args:
        found: the committed result.
        chosen: the study's own values of the unknowns.
        ranges: the priors.
    """
    unknowns = []
    for name, law in ranges.items():
        low, median, high = np.quantile(found.ensemble[name], (0.05, 0.5, 0.95)).tolist()
        width = float(np.log(high / low) / (0.9 * np.log(law.high / law.low)))
        unknowns.append((*UNKNOWNS[name], chosen[name], low, median, high, width))
    chosen_set = found.front[-1]
    return {
        "chosen": chosen_set,
        "candidates": max(each.candidates for each in found.budget),
        "sets": len(next(iter(found.ensemble.values()))),
        "reproduced": int((found.counted & (found.margins > 0.0)).sum()),
        "counted": int(found.counted.sum()),
        "unknowns": unknowns,
        "splits": found.splits,
        "rate": float(np.mean([split.rate for split in found.splits])),
        "rate_of_possible": float(np.mean([split.rate_of_possible for split in found.splits])),
        "prior_rate": float(np.nanmean(found.prior_shares[found.counted])),
        **_of_readings(found),
    }


def exclusions(sets: Sequence[FrontSet], aims: Aims) -> list[tuple[str, str]]:
    """Return which claims no set near an aim shows, though another set does.

    Near is up to half as much again as the aim on the rest, and two claims fewer than the aim.
    """
    groups = {
        "rest unvibrated in nearly all figures": lambda s: s.not_resting <= 1.5 * aims.not_resting,
        "tilt slightly in every figure": lambda s: s.tilt <= aims.tilt,
        "align over the stated share of every figure": lambda s: s.aligned >= aims.aligned,
        "show most claims": lambda s: len(s.lacking - set(aims.beside)) <= aims.missing + 2,
    }
    everywhere = frozenset.intersection(*(each.lacking for each in sets))
    found = []
    for words, near in groups.items():
        chosen = [each.lacking for each in sets if near(each)]
        if chosen:
            never = frozenset.intersection(*chosen) - everywhere
            found.append((f"{words} ({len(chosen)} sets)", ", ".join(sorted(never)) or "none"))
    return found


def pair_table(sets: Sequence[FrontSet], aims: Aims) -> Table:
    """Return how near any set comes to two aims at once: the least worst ratio, 1 meets both."""
    ratios = np.array([list(ratios_of(each, aims).values()) for each in sets])
    names = list(ratios_of(sets[0], aims))
    nearest = np.maximum(ratios[:, :, None], ratios[:, None, :]).min(axis=0)
    rows = [
        [name, *(f"{each:.2f}" for each in row)] for name, row in zip(names, nearest, strict=True)
    ]
    return Table(["", *(f">{name}" for name in names)], rows)


def ratios_of(chosen: FrontSet, aims: Aims) -> dict[str, float]:
    """Return the ratios of a set to the aims, as ``Wanted.ratios`` does."""
    return {
        "claims": len(chosen.lacking - set(aims.beside)) / aims.missing,
        "rest": chosen.not_resting / aims.not_resting,
        "rest, worst figure": chosen.not_resting_most / aims.not_resting_most,
        "tilt": chosen.tilt / aims.tilt,
        "corners": (1.0 - chosen.corners) / (1.0 - aims.corners),
        "aligned": aims.aligned / max(chosen.aligned, 0.01),
    }


def _of_readings(found: Identified) -> dict[str, Any]:
    """Return which claims that count each variant of the equations shows, and which none does."""

    def named(chosen: np.ndarray) -> str:
        return ", ".join(np.array(found.claims)[found.counted & chosen])

    shown = {name: margins > 0.0 for name, margins in found.readings.items()}
    readings = [
        (READING_LABELS.get(name, name), int((found.counted & each).sum()), named(~each))
        for name, each in shown.items()
    ]
    consistent, printed = shown.pop("consistent"), shown.pop("printed")
    alone = np.logical_or.reduce([np.zeros_like(consistent), *shown.values()])
    gained = consistent & ~printed
    mended = {READING_LABELS.get(name, name): named(gained & each) for name, each in shown.items()}
    return {
        "readings": readings,
        "mended": [(label, names) for label, names in mended.items() if names],
        "together": named(gained & ~alone),
        "printed_only": named(printed & ~consistent),
        "nowhere": named(~(consistent | printed | alone)),
        "never_together": named((found.prior_shares > 0.0) & (found.ensemble_shares == 0.0)),
    }
