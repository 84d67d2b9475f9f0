"""What the identification found: as datasets, as the study's configuration, and in words."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.study.identification.candidate import COMPUTED, Space, inertias
from model.study.identification.committed import Split
from model.study.identification.evaluate import Judge
from model.study.identification.search import Samples

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
DIGITS = 4  # of an identified value: what is known of it is far less


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


def samples_dataset(space: Space, judge: Judge, samples: Samples) -> xr.Dataset:
    """A chunk of a pool."""
    return xr.Dataset(
        {
            "point": (("structure", "trial", "unknown"), samples.points),
            "margin": (("structure", "trial", "part", "claim"), samples.margins),
        },
        {"unknown": list(space.names), "part": list(COMPUTED), "claim": list(judge.ids)},
        _attributes(space, "samples", "First samples of a search"),
    )


def samples_of(chunks: Sequence[xr.Dataset]) -> Samples:
    """The pool from its chunks."""
    points = np.concatenate([chunk["point"].values for chunk in chunks])
    return Samples(points, np.concatenate([chunk["margin"].values for chunk in chunks]))


def candidates_dataset(
    space: Space, judge: Judge, points: Array, margins: Array, title: str
) -> xr.Dataset:
    """Candidates with their values and the margin of each claim.

    Args:
        space: what the candidates are points of.
        judge: whose ``counted`` says which claims the score took in.
        points: shape (m, unknowns).
        margins: shape (m, claims).
        title: of the dataset.
    """
    return xr.Dataset(
        {
            "value": (("candidate", "unknown"), space.values(points)),
            "margin": (("candidate", "claim"), margins),
            "score": ("candidate", judge.score(margins)),
            "reproduced": ("candidate", (margins[:, judge.counted] > 0.0).sum(axis=1)),
            "counted": ("claim", judge.counted.astype(np.int8)),
        },
        {"unknown": list(space.names), "claim": list(judge.ids)},
        _attributes(space, "candidates", title),
    )


def rounded(value: float) -> float:
    """A value as it is written into the configuration."""
    return float(f"{value:.{DIGITS}g}")


def configured(space: Space, point: Array) -> dict[str, object]:
    """A candidate as the configuration states it, with the ends of Fig. 10's axis."""
    structure = {name: rounded(value) for name, value in space.structure(point).items()}
    held = {
        figure: {name: rounded(value) for name, value in space.held(point, figure).items()}
        for figure in COMPUTED
    }
    start, stop = (rounded(value) for value in inertias(structure))
    return {"structure": structure, "held": held, "inertia": {"start": start, "stop": stop}}


# --- What the ensemble says of itself -----------------------------------------------------------


def admissible(judge: Judge, margins: Array, fewer: int) -> NDArray[np.bool_]:
    """Which candidates show what is required and at most ``fewer`` claims less than the best.

    ``margins`` has shape (m, claims), what comes back (m,).

    Raises:
        ValueError: none shows what is required.
    """
    holds, reproduced = judge.holds(margins), judge.reproduced(margins)
    if not holds.any():
        raise ValueError("no set shows what is required: search further")
    return np.asarray(holds & (reproduced >= reproduced[holds].max() - fewer))


class Spread(NamedTuple):
    """How well one unknown is known: quantiles over the ensemble, and over the prior's range.

    ``narrowed`` is the width of the middle nine tenths on the logarithmic axis, over nine tenths of
    the prior's: 1 says that nothing was learnt.
    """

    name: str
    low: float
    median: float
    high: float
    narrowed: float


def spreads(space: Space, values: Array) -> tuple[Spread, ...]:
    """Spread of every unknown over an ensemble; ``values`` has shape (m, unknowns)."""
    points = space.point(values)
    low, median, high = np.quantile(values, (0.05, 0.5, 0.95), axis=0)
    ends = np.quantile(points, (0.05, 0.95), axis=0)
    narrowed = (ends[1] - ends[0]) / 0.9
    return tuple(
        Spread(name, *(float(each[i]) for each in (low, median, high, narrowed)))
        for i, name in enumerate(space.names)
    )


def correlations(space: Space, values: Array) -> Array:
    """Rank correlations of the structure's unknowns over an ensemble, shape (7, 7)."""
    structure = values[:, space.places["structure"]]
    ranks = structure.argsort(axis=0, kind="stable").argsort(axis=0, kind="stable")
    return np.asarray(np.corrcoef(ranks, rowvar=False))


def shares(margins: Array) -> Array:
    """Share of the ensemble that reproduces each claim, shape (claims,)."""
    return np.asarray((margins > 0.0).mean(axis=0))


def prior_shares(samples: Samples) -> Array:
    """Share of the first samples that reproduce each claim; NaN where one figure does not suffice.

    A claim on several figures is judged by each alone, and the shares are averaged.
    """
    known = np.isfinite(samples.margins)
    count = known.sum(axis=(0, 1, 2))
    held = (known & (np.nan_to_num(samples.margins, nan=-1.0) > 0.0)).sum(axis=(0, 1, 2))
    return np.divide(held, count, out=np.full(count.size, math.nan), where=count > 0)


def split_of(number: int, halves: tuple[Flags, Flags], margins: Array, possible: Flags) -> Split:
    """What the best candidate of a split's search shows; ``margins`` has shape (claims,).

    ``possible`` says which claims some admissible set of the searches over all claims reproduces.
    """
    first, second = halves
    reproduced = margins > 0.0
    asked = (first, first & reproduced, second, second & reproduced)
    shown = (second & possible, second & possible & reproduced)
    return Split(number, *(int(each.sum()) for each in (*asked, *shown)))


# --- In words -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Findings:
    """Everything that the searches found.

    Attributes:
        space: what was searched.
        judge: by which claims.
        tried: how many candidates the searches over all and over half of the claims tried.
        judged: how many of them were judged on the finer grids.
        best: point of the best of them on the study's own grids.
        best_margins: its margins there, shape (claims,).
        ensemble: values of the admissible ones, shape (m, unknowns).
        ensemble_margins: their margins on the finer grids, shape (m, claims).
        prior: share of the first samples that reproduces each claim, shape (claims,).
        splits: the splits.
        readings: margins of the best candidate of each reading, each of shape (claims,).
    """

    space: Space
    judge: Judge
    tried: int
    judged: int
    best: Array
    best_margins: Array
    ensemble: Array
    ensemble_margins: Array
    prior: Array
    splits: tuple[Split, ...]
    readings: Mapping[str, Array]


def summary(found: Findings) -> str:
    """What was found, as text."""
    judge, counted = found.judge, int(found.judge.counted.sum())
    ids = np.array(judge.ids)
    failing = ids[judge.counted & (found.best_margins <= 0.0)]
    shown = int(judge.reproduced(found.best_margins))
    lines = [
        f"the best of {found.tried} candidates reproduces {shown} of {counted} claims, own grids",
        f"not reproduced: {', '.join(failing) or 'none'}",
        f"{len(found.ensemble)} admissible sets of {found.judged} judged on the finer grids",
        "",
        f"{'unknown':28} {'5 %':>9} {'median':>9} {'95 %':>9}  width over the prior's",
    ]
    lines += [
        f"{each.name:28} {each.low:9.4g} {each.median:9.4g} {each.high:9.4g}  {each.narrowed:.2f}"
        for each in spreads(found.space, found.ensemble)
    ]
    lines += ["", f"{'claim':11} {'margin':>7} {'ensemble':>9} {'prior':>6}"]
    lines += [
        f"{name:11} {margin:7.2f} {share:9.2f} {prior:6.2f}{remark}"
        for name, margin, share, prior, remark in zip(
            ids, found.best_margins, shares(found.ensemble_margins), found.prior,
            np.where(judge.counted, "", np.where(judge.required, "  required", "  set aside")),
            strict=True,
        )
    ]  # fmt: skip
    lines += ["", "identified on half of the claims, judged on the other half"]
    lines += [
        f"split {each.number}: {each.searched_reproduced} of {each.searched} searched for, "
        f"{each.held_out_reproduced} of {each.held_out} held out ({100 * each.rate:.0f} %), "
        f"{each.possible_reproduced} of {each.possible} that an admissible set shows"
        for each in found.splits
    ]
    mean = 100.0 * float(np.mean([each.rate for each in found.splits]))
    of_possible = 100.0 * float(np.mean([each.rate_of_possible for each in found.splits]))
    lines += [
        f"held out, mean: {mean:.0f} %, of what an admissible set shows {of_possible:.0f} %",
        "",
        "reading, each with the same budget",
    ]
    for name, margins in found.readings.items():
        missing = ", ".join(ids[judge.counted & (margins <= 0.0)])
        lines.append(f"{name:22} {judge.reproduced(margins)} of {counted}; not {missing}")
    return "\n".join(lines) + "\n"
