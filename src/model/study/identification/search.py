"""The search: a pool of first samples, then differential evolution from the best of them.

Given the structure the figures do not depend on each other's operating points. So the pool tries
some operating points of every figure with each structure and a search starts from structures with
the best operating point of each figure. Everything drawn depends on the law's seed alone.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from model.study.config import Evolution, Pool
from model.study.identification.candidate import COMPUTED, Space
from model.study.identification.evaluate import Judge, datasets_of, evaluate, margins_of

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Samples:
    """A part of the pool.

    Attributes:
        points: shape (structures, trials, n): the structure is the same in all trials of a row.
        margins: shape (structures, trials, figures, claims): of each claim judged by one figure
            alone, NaN where that figure does not suffice.
    """

    points: Array
    margins: Array

    def every(self, first: int, step: int) -> "Samples":
        """Every ``step``-th structure from the ``first`` on."""
        return Samples(self.points[first::step], self.margins[first::step])


def sample(space: Space, judge: Judge, pool: Pool, chunk: int) -> Samples:
    """One chunk of the pool: every ``pool.chunks``-th structure.

    Raises:
        ValueError: a chunk that is not one of ``pool.chunks``.
    """
    if not 0 <= chunk < pool.chunks:
        raise ValueError(f"chunk = {chunk}: must be 0 to {pool.chunks - 1}")
    points = _drawn(space, pool)[chunk :: pool.chunks]
    margins = np.array([_margins_by_figure(space, judge, trials) for trials in points])
    return Samples(points, margins)


def _drawn(space: Space, pool: Pool) -> Array:
    """Points of the whole pool: Latin hypercubes, one of structures, one of operating points."""
    structure = space.places["structure"]
    size = pool.structures * pool.operating_points
    rng = np.random.default_rng([space.law.seed, 0])
    points = qmc.LatinHypercube(len(space.names), seed=rng).random(size)
    points = points.reshape(pool.structures, pool.operating_points, len(space.names))
    structures = qmc.LatinHypercube(len(space.law.structure), seed=rng).random(pool.structures)
    points[:, :, structure] = structures[:, None, :]
    return points


def _margins_by_figure(space: Space, judge: Judge, trials: Array) -> Array:
    made = datasets_of(space, [(point, COMPUTED) for point in trials])
    return np.array([[margins_of(judge, {name: each[name]}) for name in COMPUTED] for each in made])


def first_population(space: Space, judge: Judge, samples: Samples, size: int) -> Array:
    """The best structures of a pool, each with the best operating point of each figure.

    A claim on several figures counts for each of them by its share.
    """
    spread = np.array([len(set(claim.figures) & set(COMPUTED)) for claim in judge.claims])
    known = np.isfinite(samples.margins)
    worth = judge.counting(np.ones(len(judge.claims), dtype=np.bool_))
    scores = np.zeros(samples.margins.shape[:3])
    for i in range(len(judge.claims)):
        alone = np.arange(len(judge.claims)) == i
        margins = np.where(known[..., i], samples.margins[..., i], 0.0)[..., None] * alone
        scores += worth.counting(alone).score(margins) / spread[i]
    best = scores.argmax(axis=1)
    total = scores.max(axis=1).sum(axis=-1)
    chosen = np.argsort(-total, kind="stable")[:size]
    population = samples.points[chosen, 0].copy()
    for f, figure in enumerate(COMPUTED):
        place = space.places.get(figure)
        if place is not None:
            population[:, place] = samples.points[chosen, best[chosen, f], place]
    return population


@dataclass
class Trail:
    """Every candidate that a search tried, in order.

    Attributes:
        points: arrays of shape (m, n).
        margins: arrays of shape (m, claims).
    """

    points: list[Array] = field(default_factory=list)
    margins: list[Array] = field(default_factory=list)

    def all(self) -> tuple[Array, Array]:
        """Points and margins, each in one array."""
        return np.concatenate(self.points), np.concatenate(self.margins)


def evolve(
    space: Space, judge: Judge, population: Array, evolution: Evolution, number: int
) -> tuple[Array, Array]:
    """Carry a search on; returns all points tried, (m, n), and their margins, (m, claims).

    Args:
        space: what is searched.
        judge: whose score is made great.
        population: the first points, shape (m, n).
        evolution: how long.
        number: of the search, so that searches draw differently.
    """
    trail = Trail()

    def minus_score(columns: Array) -> Array:
        points = np.atleast_2d(columns.T)
        margins = evaluate(space, judge, points)
        trail.points.append(points.copy())
        trail.margins.append(margins)
        return -judge.score(margins)

    differential_evolution(
        minus_score,
        [(0.0, 1.0)] * len(space.names),
        init=population,
        maxiter=evolution.generations,
        strategy="currenttobest1bin",
        mutation=(0.3, 0.8),
        recombination=0.5,
        tol=0.0,
        polish=False,
        vectorized=True,
        updating="deferred",
        seed=np.random.default_rng([space.law.seed, 1, number]),
    )
    return trail.all()


def halves(judge: Judge, seed: int, split: int) -> tuple[Flags, Flags]:
    """A split of the claims that count into two halves, drawn; each of shape (claims,)."""
    counted = np.flatnonzero(judge.counted)
    drawn = np.random.default_rng([seed, 2, split]).permutation(counted)
    first = np.isin(np.arange(judge.counted.size), drawn[: (counted.size + 1) // 2])
    return first, judge.counted & ~first


def best_of(judge: Judge, margins: Array, count: int) -> NDArray[np.int64]:
    """Rows of the ``count`` candidates of greatest score, the best first."""
    return np.argsort(-judge.score(margins), kind="stable")[:count]
