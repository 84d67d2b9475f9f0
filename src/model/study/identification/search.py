"""The search: a pool of first samples, then differential evolution from the best of them.

Given the structure, the figures do not depend on each other's operating points. So only structures
evolve, in seven dimensions; with each, some operating points are tried and every figure takes the
one that suits it best. Everything drawn depends on the law's seed alone.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from model.study.config import Evolution, Pool
from model.study.identification.candidate import COMPUTED, Space
from model.study.identification.evaluate import (
    Judge,
    contradicted,
    datasets_of,
    known_margins,
    margins_of,
)

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
_AT_ONCE = 8  # points judged together
# Of a step beside a known operating point: its standard deviation, over the range, and the chance
# that a coordinate is drawn anew.
_BESIDE, _ANEW = 0.1, 0.1


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


def sample(space: Space, judge: Judge, pool: Pool, chunk: int) -> Samples:
    """One chunk of the pool: every ``pool.chunks``-th structure.

    Raises:
        ValueError: a chunk that is not one of ``pool.chunks``.
    """
    if not 0 <= chunk < pool.chunks:
        raise ValueError(f"chunk = {chunk}: must be 0 to {pool.chunks - 1}")
    points = _drawn(space, pool)[chunk :: pool.chunks]
    margins = [
        _margins_by_figure(
            space, judge, datasets_of(space, [(point, space.everything) for point in trials])
        )
        for trials in points
    ]
    return Samples(points, np.array(margins))


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


def _margins_by_figure(
    space: Space, judge: Judge, made: Sequence[Mapping[str, xr.Dataset]]
) -> Array:
    """Margins by each figure and its own runs alone, shape (trials, figures, claims)."""
    return np.array(
        [
            [
                margins_of(judge, {name: each[name] for name in names})
                for names in space.parts.values()
            ]
            for each in made
        ]
    )


def _scores_by_figure(space: Space, judge: Judge, margins: Array) -> Array:
    """What each figure adds to the score; shape (..., figures, claims) to (..., figures).

    A claim on several figures counts for each of them by its share.
    """
    touched = [
        sum(not set(claim.figures).isdisjoint(names) for names in space.parts.values())
        for claim in judge.claims
    ]
    shares = 1.0 / np.array(touched)
    return (judge.worth(np.nan_to_num(margins, nan=0.0)) * shares).sum(axis=-1)


def first_population(space: Space, judge: Judge, samples: Samples, size: int) -> Array:
    """The best structures of a pool, each with the best operating point of each figure."""
    scores = _scores_by_figure(space, judge, samples.margins)
    best = scores.argmax(axis=1)
    total = scores.max(axis=1).sum(axis=-1)
    chosen = np.argsort(-total, kind="stable")[:size]
    population = samples.points[chosen, 0].copy()
    for figure, place in space.places.items():
        if figure in COMPUTED:
            trial = best[chosen, COMPUTED.index(figure)]
            population[:, place] = samples.points[chosen, trial, place]
    return population


def search(
    space: Space,
    judge: Judge,
    samples: Samples,
    rounds: Sequence[Evolution],
    number: int,
    known: Array | None = None,
) -> tuple[Array, Array]:
    """Search from a pool, and each further round from the best that was found before.

    Args:
        space: what is searched.
        judge: whose score is made great.
        samples: the pool.
        rounds: how far.
        number: of the search, so that searches draw differently.
        known: points found before, shape (k, n): half of the population then begins there.

    Returns:
        For every structure tried the point with its best operating points, (m, n), and the margins
        there, (m, claims).
    """
    points = np.empty((0, len(space.names)))
    margins = np.empty((0, len(judge.claims)))
    for stage, evolution in enumerate(rounds):
        drawn = [np.random.default_rng([space.law.seed, k, number, stage]) for k in (1, 3)]
        population = first_population(space, judge, samples, evolution.population)
        if known is not None:
            population = _beside(known, population, space.places["structure"].stop, drawn[0])
        if stage:
            population = points[best_of(judge, margins, evolution.population)]
        more = evolve(space, judge, population, evolution, drawn[0])
        points, margins = _joined((points, margins), more)
        best = points[best_of(judge, margins, evolution.polished)]
        more = polish(space, judge, best, evolution, drawn[1])
        points, margins = _joined((points, margins), more)
    return points, margins


def _beside(known: Array, population: Array, size: int, rng: Generator) -> Array:
    """A population whose first half is ``known`` and structures beside them; shape as given."""
    half = max(len(known), population.shape[0] // 2)
    near = np.resize(known, (half, known.shape[1]))
    near[len(known) :, :size] += rng.normal(0.0, _BESIDE, (half - len(known), size))
    return np.concatenate([np.clip(near, 0.0, 1.0), population[: len(population) - half]])


def _joined(one: tuple[Array, Array], other: tuple[Array, Array]) -> tuple[Array, Array]:
    return np.concatenate([one[0], other[0]]), np.concatenate([one[1], other[1]])


def evolve(
    space: Space, judge: Judge, population: Array, evolution: Evolution, rng: Generator
) -> tuple[Array, Array]:
    """Structures evolve, and operating points follow them; see ``search``."""
    size = space.places["structure"].stop
    known, scores = list(population), [-math.inf] * len(population)
    found: list[Array] = []

    def minus_score(columns: Array) -> Array:
        structures = np.atleast_2d(columns.T)
        tried = [
            _variants(structure, size, np.array(known), np.array(scores), evolution.trials, rng)
            for structure in structures
        ]
        fitted = [fit(space, judge, trials) for trials in tried]
        values = [float(judge.score(margins)) for _, margins in fitted]
        if not found:  # the population itself, now judged
            known.clear()
            scores.clear()
        known.extend(point for point, _ in fitted)
        scores.extend(values)
        found.extend(margins for _, margins in fitted)
        return -np.array(values)

    differential_evolution(
        minus_score,
        [(0.0, 1.0)] * size,
        init=population[:, :size],
        maxiter=evolution.generations,
        strategy="currenttobest1bin",
        mutation=(0.4, 0.9),
        recombination=0.8,
        tol=0.0,
        polish=False,
        vectorized=True,
        updating="deferred",
        seed=rng,
    )
    return np.array(known), np.array(found)


def polish(
    space: Space, judge: Judge, points: Array, evolution: Evolution, rng: Generator
) -> tuple[Array, Array]:
    """More operating points with each structure: half from everywhere, half beside the known one.

    Args:
        space: what the points are points of.
        judge: by whose score.
        points: shape (m, n).
        evolution: how many more, and how often.
        rng: draws them.

    Returns:
        Points with the same structures, shape (m, n), and their margins, (m, claims).
    """
    size = space.places["structure"].stop
    polished = []
    for point in points:
        for _ in range(evolution.passes):
            trials = np.repeat(point[None, :], evolution.polish, axis=0)
            shape = trials[1:, size:].shape
            beside = np.clip(trials[1:, size:] + rng.normal(0.0, _BESIDE, shape), 0.0, 1.0)
            anywhere, is_near = rng.random(shape), np.arange(shape[0])[:, None] % 2 == 0
            trials[1:, size:] = np.where(is_near, beside, anywhere)
            point, margins = fit(space, judge, trials)
        polished.append((point, margins))
    return np.array([each[0] for each in polished]), np.array([each[1] for each in polished])


def judged(space: Space, judge: Judge, points: Array) -> tuple[Array, list[int]]:
    """Points of shape (m, n) on the grids of ``space``.

    Returns:
        Their margins, shape (m, claims), and of each how many claims are contradicted.
    """
    margins, against = [], []
    for start in range(0, len(points), _AT_ONCE):
        wanted = [(point, space.everything) for point in points[start : start + _AT_ONCE]]
        for datasets in datasets_of(space, wanted):
            margins.append(known_margins(judge, datasets))
            against.append(contradicted(judge, datasets))
    return np.array(margins), against


def _variants(
    structure: Array, size: int, known: Array, scores: Array, trials: int, rng: Generator
) -> Array:
    """Operating points to try with a structure, shape (trials, n).

    Those of the nearest structure known and those of the best; then ones beside either, each
    coordinate anew from its whole range now and then.
    """
    distances = ((known[:, :size] - structure) ** 2).sum(axis=1)
    nearest, best = known[int(np.argmin(distances))], known[int(np.argmax(scores))]
    found = np.empty((trials, known.shape[1]))
    for i in range(trials):
        found[i] = best if i % 2 else nearest
        if i > 1:
            step = rng.normal(0.0, _BESIDE, known.shape[1])
            found[i] = np.clip(found[i] + step, 0.0, 1.0)
            drawn = rng.random((2, known.shape[1]))
            found[i] = np.where(drawn[0] < _ANEW, drawn[1], found[i])
    found[:, :size] = structure
    return found


def fit(space: Space, judge: Judge, trials: Array) -> tuple[Array, Array]:
    """One structure with the best of several operating points of each figure.

    Args:
        space: what the trials are points of.
        judge: by whose score.
        trials: points with the same structure, shape (trials, n).

    Returns:
        The point, shape (n,), and its margins, shape (claims,).
    """
    made = datasets_of(space, [(point, space.everything) for point in trials])
    margins = _margins_by_figure(space, judge, made)
    best = _scores_by_figure(space, judge, margins).argmax(axis=0)
    point = trials[0].copy()
    for figure, place in space.places.items():
        if figure in COMPUTED:
            point[place] = trials[best[COMPUTED.index(figure)], place]
    chosen = {
        name: made[trial][name]
        for trial, names in zip(best, space.parts.values(), strict=True)
        for name in names
    }
    return point, known_margins(judge, chosen)


def halves(judge: Judge, seed: int, split: int) -> tuple[Flags, Flags]:
    """A split of the claims that count into two halves, drawn; each of shape (claims,).

    The claims of a figure are dealt out to both, so that either half asks something of every
    operating point.
    """
    drawn = np.random.default_rng([seed, 2, split]).permutation(np.flatnonzero(judge.counted))
    dealt = sorted(drawn.tolist(), key=lambda row: judge.claims[row].figures[0])
    first = np.isin(np.arange(judge.counted.size), dealt[::2])
    return first, judge.counted & ~first


def most_shown(judge: Judge, margins: Array, contradicted: Sequence[int]) -> int:
    """Row of the candidate that shows what is required and reproduces most.

    Of equals it has the fewest contradicted claims; what is equal then is told apart by the score.
    ``margins`` has shape (m, claims).
    """
    lacks, reproduced = ~judge.holds(margins), judge.reproduced(margins)
    scores = judge.score(margins)
    return min(
        range(len(margins)),
        key=lambda row: (lacks[row], -reproduced[row], contradicted[row], -scores[row]),
    )


def contenders(judge: Judge, structures: Array, margins: Array, count: int) -> NDArray[np.int64]:
    """Rows of the candidates that show what is required and reproduce most, the best first.

    Args:
        judge: of what counts.
        structures: shape (m, 7); of those with the same structure only the best is taken.
        margins: shape (m, claims).
        count: at most how many.
    """
    order = foremost(judge, margins, len(margins))
    _, first = np.unique(structures[order], axis=0, return_index=True)
    return np.asarray(order[np.sort(first)[:count]])


def foremost(judge: Judge, margins: Array, count: int) -> NDArray[np.int64]:
    """Rows of the ``count`` that show what is required and reproduce most, the best first."""
    order = np.lexsort((-judge.score(margins), -judge.reproduced(margins), ~judge.holds(margins)))
    return np.asarray(order[:count])


def best_of(judge: Judge, margins: Array, count: int) -> NDArray[np.int64]:
    """Rows of the ``count`` candidates of greatest score, the best first."""
    return np.argsort(-judge.score(margins), kind="stable")[:count]
