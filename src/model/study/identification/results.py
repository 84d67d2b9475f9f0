"""What the identification found: as datasets, as the study's configuration, and in words."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.study.config import SEARCHED
from model.study.identification.candidate import COMPUTED, Space, bare_inertia, inertias
from model.study.identification.evaluate import Judge
from model.study.identification.search import Samples

Array = NDArray[np.float64]
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
    """A candidate as the configuration states it: structure, each figure's ``held``, Fig. 10's axis."""
    structure = {name: rounded(value) for name, value in space.structure(point).items()}
    held = {
        figure: {name: rounded(value) for name, value in space.held(point, figure).items()}
        for figure in COMPUTED
    }
    start, stop = (rounded(value) for value in inertias(structure))
    return {"structure": structure, "held": held, "inertia": {"start": start, "stop": stop}}


# --- What the ensemble says of itself -----------------------------------------------------------


def admissible(margins: Array, counted: NDArray[np.bool_], fewer: int) -> NDArray[np.bool_]:
    """Which candidates reproduce at most ``fewer`` claims less than the best; shape (m,)."""
    reproduced = (margins[:, counted] > 0.0).sum(axis=1)
    return np.asarray(reproduced >= reproduced.max() - fewer)


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
