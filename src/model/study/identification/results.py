"""The result of the searches: as datasets, tables, the study's configuration, and in words."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.study.config import Study
from model.study.identification.candidate import (
    Space,
    inertias,
    space_of,
    space_of_figures,
    space_of_reading,
)
from model.study.identification.committed import Identified, Split
from model.study.identification.score import Judge, judge_of, reproduced_shares
from model.study.identification.search import Samples, Search

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rows = NDArray[np.int64]
DIGITS = 4  # of an identified value; the ensemble spreads far wider
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


def candidates_dataset(search: Search, points: Array, margins: Array, title: str) -> xr.Dataset:
    """Return candidates with their values and the margin of each claim.

    Args:
        search: by which they were found; its judge's ``counted`` claims made the score.
        points: shape (m, unknowns).
        margins: shape (m, claims).
        title: of the dataset.
    """
    space, judge = search.space, search.judge
    return xr.Dataset(
        {
            "value": (("candidate", "unknown"), space.values(points)),
            "margin": (("candidate", "claim"), margins),
            "score": ("candidate", judge.score(margins)),
            "reproduced": ("candidate", judge.reproduced(margins)),
            "counted": ("claim", judge.counted.astype(np.int8)),
        },
        {"unknown": list(space.names), "claim": list(judge.ids)},
        _attributes(space, "candidates", title),
    )


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
        tried: number of candidates of the searches over all and over half of the claims.
        judged: number of them judged on the finer grids.
        best: point of the best of them on the study's own grids.
        ensemble: points of the admissible ones, shape (m, unknowns).
        ensemble_margins: their margins on the finer grids, shape (m, claims).
        identified: the same and more as committed.
    """

    search: Search
    tried: int
    judged: int
    best: Array
    ensemble: Array
    ensemble_margins: Array
    identified: Identified


def findings_of(
    study: Study,
    samples: Sequence[xr.Dataset],
    starts: Sequence[xr.Dataset],
    halves: Sequence[xr.Dataset],
    readings: Mapping[str, xr.Dataset],
) -> Findings:
    """Judge the best of every search on finer grids, and choose the device and the ensemble.

    Args:
        study: the study.
        samples: the pool.
        starts: candidates of the searches over all claims.
        halves: candidates of the searches over one half of the claims, by split.
        readings: candidates under each reading.
    """
    law = study.identification
    search, finer = search_of(space_of(study)), search_of(space_of(study, FINER))
    space, judge = search.space, search.judge
    # A set is admissible by what it shows, whichever claims it was searched by.
    tried = xr.concat([each[["value", "margin"]] for each in (*starts, *halves)], "candidate")
    rows, margins, _ = _judged_finer(finer, tried, law.finer)
    values = tried["value"].values[rows]
    last = space.point(values[judge.order(margins)[: law.final]])
    shown, against = search_of(space_of_figures(study)).judged(last)
    best = judge.order(shown, against)[0]
    kept = judge.admissible(margins, law.admissible)
    values, ensemble = values[kept], space.point(values[kept])
    ensemble_shares = reproduced_shares(margins[kept])
    identified = Identified(
        ensemble=dict(zip(space.names, values.T, strict=True)),
        claims=judge.ids,
        counted=judge.counted,
        margins=shown[best],
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
        made_with=made_with(space, judge),
    )
    return Findings(
        search=search,
        tried=tried.sizes["candidate"],
        judged=len(rows),
        best=last[best],
        ensemble=ensemble,
        ensemble_margins=margins[kept],
        identified=identified,
    )


def _judged_finer(finer: Search, found: xr.Dataset, count: int) -> tuple[Rows, Array, list[int]]:
    """Rows, margins and numbers of contradicted claims of a search's ``count`` best."""
    points = finer.space.point(found["value"].values)
    rows = finer.judge.contenders(points[:, : finer.size], found["margin"].values, count)
    return rows, *finer.judged(points[rows])


def _best_margins(finer: Search, found: xr.Dataset, count: int) -> Array:
    _, margins, against = _judged_finer(finer, found, count)
    return np.asarray(margins[finer.judge.order(margins, against)[0]])


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


def summary(findings: Findings) -> str:
    """Return the result in a few lines; the tables and the report say more."""
    judge, found = findings.search.judge, findings.identified
    counted = int(judge.counted.sum())

    def lacking(margins: Array) -> str:
        return ", ".join(np.array(judge.ids)[judge.counted & (margins <= 0.0)]) or "none"

    shown = f"{judge.reproduced(found.margins)} of {counted} claims"
    lines = [
        f"the best of {findings.tried} candidates reproduces {shown}, own grids",
        f"not reproduced: {lacking(found.margins)}",
        f"{len(findings.ensemble)} admissible sets of {findings.judged} judged on the finer grids",
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
