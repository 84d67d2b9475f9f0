"""The result of the searches: as datasets, tables, the study's configuration, and in words."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.study.claims.regime import Summary
from model.study.config import Aims, Identification, Study
from model.study.identification.candidate import (
    Space,
    inertias,
    space_of,
    space_of_figures,
    space_of_reading,
)
from model.study.identification.committed import BudgetFront, FrontSet, Identified, Split
from model.study.identification.front import Wanted, on_front, promising
from model.study.identification.refine import refined, trials_of
from model.study.identification.score import Judge, judge_of, reproduced_shares
from model.study.identification.search import Found, Samples, Search, joined

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rows = NDArray[np.int64]
DIGITS = 4  # of an identified value; the ensemble spreads far wider
_PLACES = 9  # of coordinates by which a set found twice counts once
# Shares of the searches by scores and of the one by the aims, whose fronts are compared.
BUDGET_SHARES = ((0.5, 0.0), (1.0, 0.0), (1.0, 0.5), (1.0, 1.0))
SAFE = 0.03  # margin of a claim that other grids hardly turn
FINER = 3  # factor on the number of values along each axis where the best are judged again


def search_of(space: Space) -> Search:
    """Return the search of a space by its own judge."""
    return Search(space, judge_of(space))


def _attributes(space: Space, kind: str, title: str) -> dict[str, object]:
    return {
        "Conventions": "CF-1.11 ACDD-1.3",
        "title": title,
        "source": "vibralign, identification of what the paper leaves unstated",
        "license": "MIT",
        "figure": "identification",
        "kind": kind,
        "sweep": space.identity,
        "readings": json.dumps(space.readings),
    }


def samples_dataset(search: Search, samples: Samples) -> xr.Dataset:
    """Return a chunk of a pool as a dataset."""
    space = search.space
    return xr.Dataset(
        {
            "point": (("structure", "trial", "unknown"), samples.points),
            "margin": (("structure", "trial", "part", "claim"), samples.margins),
        },
        {
            "unknown": list(space.names),
            "part": list(space.figures),
            "claim": list(search.judge.ids),
        },
        _attributes(space, "samples", "First samples of a search"),
    )


def samples_of(chunks: Sequence[xr.Dataset]) -> Samples:
    """Return the pool from its chunks."""
    points = np.concatenate([chunk["point"].values for chunk in chunks])
    return Samples(points, np.concatenate([chunk["margin"].values for chunk in chunks]))


def candidates_dataset(search: Search, found: Found, title: str) -> xr.Dataset:
    """Return candidates with their values, the margin of each claim, and their regime.

    Args:
        search: by which they were found; its judge's ``counted`` claims made the score.
        found: the candidates.
        title: of the dataset.
    """
    space, judge = search.space, search.judge
    return xr.Dataset(
        {
            "value": (("candidate", "unknown"), space.values(found.points)),
            "margin": (("candidate", "claim"), found.margins),
            "regime": (("candidate", "number"), found.regimes),
            "score": ("candidate", judge.score(found.margins)),
            "reproduced": ("candidate", judge.reproduced(found.margins)),
            "counted": ("claim", judge.counted.astype(np.int8)),
        },
        {"unknown": list(space.names), "claim": list(judge.ids), "number": list(Summary._fields)},
        _attributes(space, "candidates", title),
    )


def found_in(space: Space, dataset: xr.Dataset) -> Found:
    """Return the candidates of a dataset."""
    value, margin, regime = (dataset[name].values for name in ("value", "margin", "regime"))
    return Found(space.point(value), margin, regime)


def rounded(value: float) -> float:
    """Return a value as it is written into the configuration."""
    return float(f"{value:.{DIGITS}g}")


def configured(space: Space, point: Array) -> dict[str, object]:
    """Return a candidate as the configuration states it, with the ends of Fig. 10's axis."""
    structure = {name: rounded(value) for name, value in space.structure(point).items()}
    held = {
        figure: {name: rounded(value) for name, value in space.held(point, figure).items()}
        for figure in space.figures
    }
    start, stop = (rounded(value) for value in inertias(structure))
    return {"structure": structure, "held": held, "inertia": {"start": start, "stop": stop}}


def made_with(space: Space, judge: Judge) -> dict[str, str]:
    """Return hashes of the search space and of the claims, without their wording."""
    claims = str([(c.id, c.asked, c.limit.demand, c.limit.scale) for c in judge.claims])
    return {"search": space.identity, "claims": hashlib.sha256(claims.encode()).hexdigest()[:16]}


# --- All searches together ----------------------------------------------------------------------


@dataclass(frozen=True)
class Findings:
    """The result of all searches.

    Attributes:
        search: the one over all claims.
        judged: sets judged on the finer grids.
        best: point of the device, on the study's own grids.
        ensemble: the admissible ones of those judged, on the finer grids.
        identified: the same and more as committed.
    """

    search: Search
    judged: Found
    best: Array
    ensemble: Found
    identified: Identified


def findings_of(
    study: Study,
    samples: Sequence[xr.Dataset],
    starts: Sequence[xr.Dataset],
    descent: xr.Dataset,
    halves: Sequence[xr.Dataset],
    readings: Mapping[str, xr.Dataset],
) -> Findings:
    """Judge the best of every search on finer grids, and choose the device and the ensemble.

    Args:
        study: the study.
        samples: the pool.
        starts: candidates of the searches over all claims.
        descent: candidates of the search by the aims.
        halves: candidates of the searches over one half of the claims, by split.
        readings: candidates under each reading.
    """
    law = study.identification
    space, aims = space_of(study), law.aims
    search, finer = search_of(space), search_of(space_of(study, FINER))
    searches = [found_in(space, each) for each in (*starts, descent)]
    # A set is admissible by what it shows, whichever claims it was searched by.
    tried = joined([*searches, *(found_in(space, each) for each in halves)])
    judge, whole = search.judge, Wanted(aims, space.everything)
    known = [space.point_of(values) for values in law.known.values()]
    contenders = np.array([*tried.points[_contenders(search, tried, law)], *known])
    judged, _ = finer.judged(np.unique(contenders.round(_PLACES), axis=0))
    order = promising(whole.ratios(judge, judged.margins, judged.regimes))
    order = order[judge.holds(judged.margins)[order]]
    safely = replace(whole, safe=SAFE)
    anew = [
        refined(
            finer,
            trials_of(finer, judged.points[row], judged.points[order], law.refine, number),
            safely,
        )
        for number, row in enumerate(order[: law.refined])
    ]
    judged = joined([judged, *(each for each in anew if each is not None)])
    ratios = whole.worst(judge, judged.margins, judged.regimes)
    order = np.argsort(ratios, kind="stable")
    # On the grids that decide a known set may be better than what coarse ones led to.
    finals = np.array([*judged.points[order[: law.final]], *known])
    last, _ = search_of(space_of_figures(study)).judged(finals)
    best = int(np.argmin(whole.worst(judge, last.margins, last.regimes)))
    kept = ratios <= law.admissible * ratios[order[0]]
    shown = shown_of(search.judge, judged.margins, aims)
    shown_last = shown_of(search.judge, last.margins, aims)
    values = space.values(judged.points[kept])
    ensemble_shares = reproduced_shares(judged.margins[kept])
    identified = Identified(
        ensemble=dict(zip(space.names, values.T, strict=True)),
        claims=search.judge.ids,
        counted=search.judge.counted,
        margins=last.margins[best],
        ensemble_shares=ensemble_shares,
        prior_shares=reproduced_shares(samples_of(samples).margins),
        splits=tuple(
            _split(finer, number, half, law.finer_each, ensemble_shares > 0.0)
            for number, half in enumerate(halves)
        ),
        readings={
            name: _best_margins(
                search_of(space_of_reading(study, name, FINER)), found, law.finer_each
            )
            for name, found in readings.items()
        },
        made_with=made_with(space, search.judge),
        front=(
            *_front_sets(
                search.judge, judged, shown, on_front(shown, judged.regimes, aims.aligned)
            ),
            *_front_sets(
                search.judge,
                Found(*(each[best : best + 1] for each in last)),
                shown_last[best : best + 1],
                np.array([True]),
                chosen=True,
            ),
        ),
        budget=budget_of(search, searches, study),
    )
    return Findings(
        search=search,
        judged=judged,
        best=last.points[best],
        ensemble=Found(*(each[kept] for each in judged)),
        identified=identified,
    )


def _front_sets(
    judge: Judge, found: Found, shown: Rows, best: Flags, chosen: bool = False
) -> list[FrontSet]:
    return [
        FrontSet(bool(beats), chosen, int(claims), " ".join(judge.lacking(margins)), *regime)
        for beats, claims, regime, margins in zip(
            best, shown, found.regimes.tolist(), found.margins, strict=True
        )
    ]


def shown_of(judge: Judge, margins: Array, aims: Aims) -> Rows:
    """Return how many claims sets show, without those that ask what the aims ask."""
    counted = judge.counted & ~np.isin(np.array(judge.ids), aims.beside)
    return np.asarray((margins[..., counted] > 0.0).sum(axis=-1))


def _contenders(search: Search, found: Found, law: Identification) -> Rows:
    """Rows of the best: half by the ratio to the aims, half by the scores of the searches."""
    structures = found.points[:, : search.size]
    wanted = Wanted(law.aims, search.space.searched)
    order = np.argsort(wanted.worst(search.judge, found.margins, found.regimes), kind="stable")
    _, first = np.unique(structures[order], axis=0, return_index=True)
    weights = sorted({start.weight for start in law.starts})
    rows = [order[np.sort(first)[: math.ceil(law.finer / 2)]]]
    rows += [
        search.weighing(weight).judge.contenders(
            structures, found.margins, math.ceil(law.finer / (2 * len(weights)))
        )
        for weight in weights
    ]
    return np.unique(np.concatenate(rows))


def budget_of(search: Search, searches: Sequence[Found], study: Study) -> tuple[BudgetFront, ...]:
    """Return the fronts that parts of the budget find, on the coarse grids.

    Args:
        search: on these grids.
        searches: those by scores, and last the one by the aims; candidates in order.
        study: the study.
    """
    law, found = study.identification, []
    for by_score, by_aims in BUDGET_SHARES:
        shares = [by_score] * (len(searches) - 1) + [by_aims]
        both = joined(
            [
                Found(*(a[: round(share * len(a))] for a in each))
                for share, each in zip(shares, searches, strict=True)
            ]
        )
        holds = search.judge.holds(both.margins)
        shown = shown_of(search.judge, both.margins, law.aims)[holds]
        regimes = both.regimes[holds]
        rows = np.flatnonzero(on_front(shown, regimes, law.aims.aligned))
        tried = law.pool.structures * law.pool.operating_points + round(
            by_score * len(law.starts) * sum(each.candidates for each in law.rounds)
            + by_aims * sum(each.candidates for each in law.descents)
        )
        found += [BudgetFront(tried, int(shown[row]), *regimes[row].tolist()) for row in rows]
    return tuple(found)


def _best_margins(finer: Search, found: xr.Dataset, count: int) -> Array:
    candidates = found_in(finer.space, found)
    rows = finer.judge.contenders(candidates.points[:, : finer.size], candidates.margins, count)
    judged, against = finer.judged(candidates.points[rows])
    return np.asarray(judged.margins[finer.judge.order(judged.margins, against)[0]])


def _split(finer: Search, number: int, half: xr.Dataset, count: int, possible: Flags) -> Split:
    halves = finer.judge.halves(finer.space.law.seed, number)
    return split_of(number, halves, _best_margins(finer.on_half(number), half, count), possible)


def split_of(number: int, halves: tuple[Flags, Flags], margins: Array, possible: Flags) -> Split:
    """Count the claims that the best candidate of a split's search reproduces.

    Args:
        number: of the split.
        halves: claims searched for and held out, each of shape (claims,).
        margins: of the best candidate, shape (claims,).
        possible: claims that some admissible set reproduces, shape (claims,).
    """
    first, second = halves
    reproduced = margins > 0.0
    asked = (first, first & reproduced, second, second & reproduced)
    shown = (second & possible, second & possible & reproduced)
    return Split(number, *(int(each.sum()) for each in (*asked, *shown)))


def summary(findings: Findings, aims: Aims) -> str:
    """Return the result in a few lines; the tables and the report say more."""
    judge, found = findings.search.judge, findings.identified
    counted = int(judge.counted.sum())
    chosen = found.front[-1]
    missing = len(chosen.lacking - set(aims.beside))

    def lacking(margins: Array) -> str:
        return ", ".join(judge.lacking(margins)) or "none"

    lines = [
        f"the device, of {found.budget[-1].candidates} candidates, own grids:",
        f"claims without {', '.join(aims.beside)}: {chosen.claims}",
        f"of these not: {missing} ({aims.missing})",
        f"not resting unvibrated, in the mean: {chosen.not_resting:.3f} ({aims.not_resting})",
        f"in the worst figure: {chosen.not_resting_most:.2f} ({aims.not_resting_most})",
        f"median tilt at alignment in the worst figure: {chosen.tilt:.3f} ({aims.tilt})",
        f"corner conditions in the worst figure: {chosen.corners:.3f} ({aims.corners})",
        f"points that align in the worst figure: {chosen.aligned:.2f} ({aims.aligned})",
        f"not reproduced: {lacking(found.margins)}",
        f"{len(findings.ensemble.points)} of {len(findings.judged.points)} sets are admissible",
        "",
        "identified on half of the claims, judged on the other half",
    ]
    lines += [
        f"split {each.number}: {each.searched_reproduced} of {each.searched} searched for, "
        f"{each.held_out_reproduced} of {each.held_out} held out ({100 * each.rate:.0f} %), "
        f"{each.possible_reproduced} of {each.possible} that an admissible set shows"
        for each in found.splits
    ]
    lines += ["", "reading, each with the same budget"]
    lines += [
        f"{name:22} {judge.reproduced(margins)} of {counted}; not {lacking(margins)}"
        for name, margins in found.readings.items()
    ]
    return "\n".join(lines) + "\n"
