"""A structure with the operating points nearest to the aims, each figure judged by itself.

Given the structure, figures depend on each other through sums and worst numbers alone. So each is
judged at operating points of its own, those first in which most structures fail; a structure is
given up at the first figure that comes near the aims at none. Of all combinations the best is found
directly.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.study.claims.reading import Data
from model.study.claims.regime import regime_of, summary_of
from model.study.config import Aims
from model.study.identification.evaluate import datasets_of
from model.study.identification.front import Wanted
from model.study.identification.search import Found, Search, joined

Array = NDArray[np.float64]
_STEPS = (0.03, 0.1, 0.3)  # standard deviations of steps beside an operating point, over the range
_FIRST = ("fig12", "fig07", "fig06", "fig09", "fig13")  # the figures in which most structures fail
_ALIGNS_LITTLE = 10.0  # factor on the ratio of a figure of which too little aligns
# Claims that a share of points not resting is worth, where combinations are weighed.
_WEIGHTS = (0.0, 3.0, 6.0, 10.0, 15.0, 20.0, 30.0, 60.0)
_LEVELS = 12  # worst ratios of single figures that are tried, from the least upwards
_LEVEL = 1.06  # from one to the next


class _Scan(NamedTuple):
    """One figure at several operating points: each array has shape (trials,)."""

    ratios: Array  # worst ratio to the aims of every single figure
    missing: Array  # claims that it does not show by itself
    resting: Array  # share that does not rest


def trials_of(search: Search, point: Array, others: Array, count: int, seed: int) -> Array:
    """Return operating points to try with the structure of ``point``, itself first.

    Args:
        search: whose space the points are of.
        point: shape (n,).
        others: points whose operating points are tried too, the best first, shape (m, n).
        count: number of trials.
        seed: of the steps beside the point.
    """
    rng = np.random.default_rng([search.space.law.seed, 4, seed])
    trials = np.repeat(point[None], count, axis=0)
    borrowed = others[: (count - 1) // 2]
    trials[1 : 1 + len(borrowed)] = borrowed
    steps = np.resize(_STEPS, count - 1 - len(borrowed))[:, None]
    trials[1 + len(borrowed) :] += steps * rng.normal(size=(steps.size, point.size))
    trials[:, : search.size] = point[: search.size]
    return np.clip(trials, 0.0, 1.0)


def refined(search: Search, trials: Array, wanted: Wanted, most: float = math.inf) -> Found | None:
    """Return the structure of ``trials`` with the operating points nearest to the aims.

    Args:
        search: on the grids that decide.
        trials: points with the same structure, shape (trials, n).
        wanted: the aims, and the figures and own runs that are computed.
        most: worst ratio above which a structure is given up.

    Returns:
        One candidate, no worse than the first trial; none if a figure exceeds ``most`` in all.
    """
    space = search.space
    scans: dict[str, _Scan] = {}
    for figure in sorted(space.figures, key=lambda name: (name not in _FIRST, name)):
        scans[figure] = _scanned(search, figure, trials, wanted)
        if scans[figure].ratios.min() > most:
            return None
    point = trials[0].copy()
    for figure, trial in _combined(scans, wanted.aims).items():
        place = space.places.get(figure, slice(0))
        point[place] = trials[trial][place]
    both = joined([_judged(search, each, wanted) for each in (trials[0], point)])
    ratios = wanted.ratios(search.judge, both.margins, both.regimes)
    worst = wanted.worst(search.judge, both.margins, both.regimes).round(2)
    best = np.lexsort([ratios.sum(axis=-1), ratios.max(axis=-1).round(2), worst])[0]
    return Found(*(each[best : best + 1] for each in both))


def _scanned(search: Search, figure: str, trials: Array, wanted: Wanted) -> _Scan:
    """Judge a figure and its own runs by themselves."""
    space, judge = search.space, search.judge
    names = [name for name in space.parts[figure] if name in wanted.names]
    made = datasets_of(space.only(names), trials, names)
    margins = np.array([judge.margins(each) for each in made])
    regimes = np.array([summary_of([regime_of(Data(each), figure)]) for each in made])
    ratios = wanted.ratios(judge, np.zeros_like(margins), regimes)[:, 2:]
    ratios[:, -1] = np.where(ratios[:, -1] > 1.0, _ALIGNS_LITTLE * ratios[:, -1], 0.0)
    asked = margins[:, wanted.asked(judge)]
    missing = np.clip(1.0 - asked / wanted.safe, 0.0, 1.0) if wanted.safe else asked <= 0.0
    held = (margins[:, judge.required] > 0.0) | np.isnan(margins[:, judge.required])
    return _Scan(
        np.where(held.all(axis=-1), ratios.max(axis=-1), np.inf),
        np.where(np.isnan(asked), 0.0, missing).sum(axis=-1),
        regimes[:, 0],
    )


def _combined(scans: Mapping[str, _Scan], aims: Aims) -> dict[str, int]:
    """Return the trial of each figure whose combination has the least worst ratio."""
    least = max(float(scan.ratios.min()) for scan in scans.values())
    best, chosen = math.inf, dict.fromkeys(scans, 0)
    for level in least * _LEVEL ** np.arange(_LEVELS):
        for weight in _WEIGHTS:
            found = {}
            for figure, scan in scans.items():
                costs = scan.missing + weight * scan.resting + 0.1 * scan.ratios
                found[figure] = int(np.argmin(np.where(scan.ratios <= level, costs, np.inf)))
            missing = sum(float(scans[name].missing[trial]) for name, trial in found.items())
            resting = np.mean([scans[name].resting[trial] for name, trial in found.items()])
            both = missing / aims.missing, float(resting) / aims.not_resting
            worst = max(*both, *(scans[name].ratios[trial] for name, trial in found.items()))
            if worst + 0.03 * sum(both) < best:
                best, chosen = worst + 0.03 * sum(both), found
    return chosen


def _judged(search: Search, point: Array, wanted: Wanted) -> Found:
    (made,) = datasets_of(search.space, point[None], list(wanted.names))
    margins, _ = search.judge.judged(made)
    regime = summary_of(regime_of(Data(made), name) for name in search.space.figures)
    return Found(point[None], margins[None], np.array(regime)[None])
