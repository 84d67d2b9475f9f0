"""A search by the aims themselves: structures beside the best, each with operating points anew.

The searches by a score find where to begin; the rule of the choice is the worst ratio to the aims.
"""

import numpy as np
from numpy.typing import NDArray

from model.study.config import Descent
from model.study.identification.front import Wanted
from model.study.identification.refine import refined, trials_of
from model.study.identification.search import Found, Search, joined

Array = NDArray[np.float64]
_ELITE = 8  # sets among which a step begins, of different structures
_STEPS = (0.01, 0.03, 0.1)  # standard deviations of steps of a structure, over the range
_SEED = 5  # of these draws, apart from those of the other searches
_NEAR = 1.1  # times the worst ratio of the best set: what exceeds it in a figure is given up


def descended(search: Search, before: Found, wanted: Wanted, descent: Descent, stage: int) -> Found:
    """Return the candidates of one round: first the best of ``before`` refined, then others.

    Structures that are given up are not among them.

    Args:
        search: on the coarse grids.
        before: candidates of other searches and of the rounds before.
        wanted: the aims.
        descent: the effort.
        stage: number of the round.
    """
    rng = np.random.default_rng([search.space.law.seed, _SEED, stage])
    found = before
    tried: list[Found] = []
    for number in range(descent.structures):
        rows = _best(search, found, wanted)
        best, most = found.points[rows], np.inf
        if number < (len(best) if stage == 0 else 1):
            point = best[number]
        else:
            least = wanted.worst(search.judge, found.margins, found.regimes)[rows[0]]
            most = _NEAR * least
            first, second, third = best[rng.integers(len(best), size=3)]
            point, part = first.copy(), slice(search.size)
            point[part] += rng.choice((0.0, 0.5)) * (second - third)[part]
            point[part] += rng.choice(_STEPS) * rng.normal(size=search.size)
            point = np.clip(point, 0.0, 1.0)
        # Any set may have found what suits one figure.
        others = np.concatenate([best, rng.permutation(found.points)[:_ELITE]])
        trials = trials_of(search, point, others, descent.trials, 1000 * (stage + 1) + number)
        made = refined(search, trials, wanted, most)
        if made is not None:
            tried.append(made)
            found = joined([before, *tried])
    return joined(tried)


def _best(search: Search, found: Found, wanted: Wanted) -> NDArray[np.int64]:
    """Rows of the best sets by the worst ratio, then the sum of the ratios; structures differ."""
    judge = search.judge
    ratios = wanted.ratios(judge, found.margins, found.regimes)
    worst = wanted.worst(judge, found.margins, found.regimes)
    order = np.lexsort([ratios.sum(axis=-1), worst.round(2)])
    _, first = np.unique(found.points[order, : search.size], axis=0, return_index=True)
    return np.asarray(order[np.sort(first)[:_ELITE]])
