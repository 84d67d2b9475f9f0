"""The last step of a search: operating points chosen by the aims, on the finer grids.

Given the structure, each figure may take any operating point that was tried. The worst ratio to the
aims is lowered figure by figure, since claims on several figures tie them together.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from model.study.claims.reading import Data
from model.study.claims.regime import regime_of, summary_of
from model.study.identification.evaluate import datasets_of
from model.study.identification.front import Wanted
from model.study.identification.search import Found, Search

Array = NDArray[np.float64]
_PASSES = 2
_STEPS = (0.03, 0.1, 0.3)  # standard deviations of steps beside an operating point, over the range


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


def refined(search: Search, trials: Array, wanted: Wanted) -> Found:
    """Return the structure of ``trials`` with the operating points nearest to the aims.

    Args:
        search: on the grids that decide.
        trials: points with the same structure, shape (trials, n).
        wanted: the aims, and the figures and own runs that are computed.
    """
    space, judge = search.space, search.judge
    made = datasets_of(space, trials, list(wanted.names))
    regimes = [{name: regime_of(Data(each), name) for name in space.figures} for each in made]

    def regime_at(chosen: Sequence[int]) -> Array:
        pairs = zip(chosen, space.figures, strict=True)
        return np.array(summary_of(regimes[trial][name] for trial, name in pairs))

    def judged(chosen: Sequence[int]) -> tuple[Array, Array, tuple[float, float, float]]:
        datasets = {
            name: made[trial][name]
            for trial, names in zip(chosen, space.parts.values(), strict=True)
            for name in names
            if name in made[trial]
        }
        margins, _ = judge.judged(datasets)
        regime = regime_at(chosen)
        ratios = wanted.ratios(judge, margins[None], regime[None])[0]
        unheld = float(np.isinf(wanted.worst(judge, margins[None], regime[None])[0]))
        return margins, regime, (unheld, round(float(ratios.max()), 2), float(ratios.sum()))

    chosen = [0] * len(space.figures)
    best = judged(chosen)
    for _ in range(_PASSES):
        for number in range(len(chosen)):
            for trial in range(len(trials)):
                other = [*chosen[:number], trial, *chosen[number + 1 :]]
                # The regime is known without the claims, and may be worse already.
                known = wanted.ratios(judge, best[0][None], regime_at(other)[None])[0, 1:]
                if best[2][0] == 0.0 and round(float(known.max()), 2) > best[2][1]:
                    continue
                found = judged(other)
                if found[2] < best[2]:
                    chosen, best = other, found
    point = trials[0].copy()
    for trial, figure in zip(chosen, space.figures, strict=True):
        place = space.places.get(figure, slice(0))
        point[place] = trials[trial][place]
    return Found(point[None], best[0][None], best[1][None])
