"""The search: a pool of first samples, then differential evolution from the best of them.

Given the structure, the figures do not depend on each other's operating points. So only structures
evolve, in seven dimensions; with each, some operating points are tried and every figure takes the
one that suits it best. Everything drawn depends on the law's seed alone. Evolution is scipy's and
the pool a Latin hypercube of ``scipy.stats.qmc``; scipy has no search that is split like this one.
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
from model.study.identification.candidate import Space
from model.study.identification.evaluate import datasets_of
from model.study.identification.score import Judge

Array = NDArray[np.float64]
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


@dataclass(frozen=True)
class Search:
    """A search: the space, the judge whose score is maximized, and the draws."""

    space: Space
    judge: Judge

    @property
    def size(self) -> int:
        """Number of unknowns of the structure, which come first in a point."""
        return self.space.places["structure"].stop

    def on_half(self, split: int) -> "Search":
        """Return the same search by the first half of the claims of a split."""
        first, _ = self.judge.halves(self.space.law.seed, split)
        return Search(self.space, self.judge.counting(first))

    def sample(self, pool: Pool, chunk: int) -> Samples:
        """Judge one chunk of the pool: every ``pool.chunks``-th structure.

        Raises:
            ValueError: a chunk that is not one of ``pool.chunks``.
        """
        if not 0 <= chunk < pool.chunks:
            raise ValueError(f"chunk = {chunk}: must be 0 to {pool.chunks - 1}")
        points = self._drawn(pool)[chunk :: pool.chunks]
        margins = [
            self._by_figure(datasets_of(self.space, trials, self.space.everything))
            for trials in points
        ]
        return Samples(points, np.array(margins))

    def _drawn(self, pool: Pool) -> Array:
        """Points of the whole pool: Latin hypercubes of structures and of operating points."""
        unknowns = len(self.space.names)
        rng = np.random.default_rng([self.space.law.seed, 0])
        points = qmc.LatinHypercube(unknowns, seed=rng).random(
            pool.structures * pool.operating_points
        )
        points = points.reshape(pool.structures, pool.operating_points, unknowns)
        structures = qmc.LatinHypercube(self.size, seed=rng).random(pool.structures)
        points[:, :, : self.size] = structures[:, None, :]
        return points

    def _by_figure(self, made: Sequence[Mapping[str, xr.Dataset]]) -> Array:
        """Margins by each figure and its own runs alone, shape (trials, figures, claims)."""
        return np.array(
            [
                [
                    self.judge.margins({name: each[name] for name in names})
                    for names in self.space.parts.values()
                ]
                for each in made
            ]
        )

    def _scores_by_figure(self, margins: Array) -> Array:
        """Contribution of each figure to the score; shape (..., figures, claims) to (..., figures).

        A claim on several figures counts for each of them by its share.
        """
        touched = [
            sum(not set(claim.figures).isdisjoint(names) for names in self.space.parts.values())
            for claim in self.judge.claims
        ]
        shares = 1.0 / np.array(touched)
        return (self.judge.worth(np.nan_to_num(margins, nan=0.0)) * shares).sum(axis=-1)

    def _take(self, points: Array, trials: Array, best: NDArray[np.int64]) -> Array:
        """``points`` with each figure's operating point of its best trial.

        Args:
            points: shape (..., n).
            trials: shape (..., trials, n).
            best: shape (..., figures), the trial of each figure.
        """
        taken = points.copy()
        for number, figure in enumerate(self.space.figures):
            place = self.space.places.get(figure, slice(0))
            chosen = np.take_along_axis(trials, best[..., number, None, None], axis=-2)
            taken[..., place] = chosen[..., 0, place]
        return taken

    def first_population(self, samples: Samples, size: int) -> Array:
        """Return the best structures of a pool, with the best operating point of each figure."""
        scores = self._scores_by_figure(samples.margins)
        total = scores.max(axis=1).sum(axis=-1)
        chosen = np.argsort(-total, kind="stable")[:size]
        trials = samples.points[chosen]
        return self._take(trials[:, 0], trials, scores.argmax(axis=1)[chosen])

    def run(
        self,
        samples: Samples,
        rounds: Sequence[Evolution],
        number: int,
        known: Array | None = None,
    ) -> tuple[Array, Array]:
        """Search from a pool, and each further round from the best that was found before.

        Args:
            samples: the pool.
            rounds: the effort.
            number: of the search, so that searches draw differently.
            known: points found before, shape (k, n): half of the population then begins there.

        Returns:
            For every structure tried the point with its best operating points, (m, n), and the
            margins there, (m, claims).
        """
        points = np.empty((0, len(self.space.names)))
        margins = np.empty((0, len(self.judge.claims)))
        for stage, evolution in enumerate(rounds):
            seed = self.space.law.seed
            drawn = [np.random.default_rng([seed, k, number, stage]) for k in (1, 3)]
            population = self.first_population(samples, evolution.population)
            if known is not None:
                population = _beside(known, population, self.size, drawn[0])
            if stage:
                population = points[self.judge.highest(margins, evolution.population)]
            points, margins = _joined(
                (points, margins), self._evolve(population, evolution, drawn[0])
            )
            best = points[self.judge.highest(margins, evolution.polished)]
            points, margins = _joined((points, margins), self._polish(best, evolution, drawn[1]))
        return points, margins

    def _evolve(
        self, population: Array, evolution: Evolution, rng: Generator
    ) -> tuple[Array, Array]:
        """Evolve structures, with operating points that follow them; see ``run``."""
        known, scores = list(population), [-math.inf] * len(population)
        found: list[Array] = []

        def minus_score(columns: Array) -> Array:
            tried = [
                self._variants(each, np.array(known), np.array(scores), evolution.trials, rng)
                for each in np.atleast_2d(columns.T)
            ]
            fitted = [self.fit(trials) for trials in tried]
            values = [float(self.judge.score(margins)) for _, margins in fitted]
            if not found:  # the population itself, now judged
                known.clear()
                scores.clear()
            known.extend(point for point, _ in fitted)
            scores.extend(values)
            found.extend(margins for _, margins in fitted)
            return -np.array(values)

        differential_evolution(
            minus_score,
            [(0.0, 1.0)] * self.size,
            init=population[:, : self.size],
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

    def _variants(
        self, structure: Array, known: Array, scores: Array, trials: int, rng: Generator
    ) -> Array:
        """Operating points to try with a structure, shape (trials, n).

        Those of the nearest known structure and those of the best; then steps beside either, each
        coordinate anew from its whole range now and then.
        """
        distances = ((known[:, : self.size] - structure) ** 2).sum(axis=1)
        nearest, best = known[int(np.argmin(distances))], known[int(np.argmax(scores))]
        found = np.empty((trials, known.shape[1]))
        for i in range(trials):
            found[i] = best if i % 2 else nearest
            if i > 1:
                step = rng.normal(0.0, _BESIDE, known.shape[1])
                found[i] = np.clip(found[i] + step, 0.0, 1.0)
                drawn = rng.random((2, known.shape[1]))
                found[i] = np.where(drawn[0] < _ANEW, drawn[1], found[i])
        found[:, : self.size] = structure
        return found

    def _polish(self, points: Array, evolution: Evolution, rng: Generator) -> tuple[Array, Array]:
        """Try more operating points with each structure: half from everywhere, half beside its own.

        Returns:
            Points with the same structures, shape (m, n), and their margins, (m, claims).
        """
        polished = []
        for point in points:
            for _ in range(evolution.passes):
                trials = np.repeat(point[None, :], evolution.polish, axis=0)
                own = trials[1:, self.size :]
                beside = np.clip(own + rng.normal(0.0, _BESIDE, own.shape), 0.0, 1.0)
                anywhere = rng.random(own.shape)
                is_near = np.arange(own.shape[0])[:, None] % 2 == 0
                trials[1:, self.size :] = np.where(is_near, beside, anywhere)
                point, margins = self.fit(trials)
            polished.append((point, margins))
        return np.array([each[0] for each in polished]), np.array([each[1] for each in polished])

    def fit(self, trials: Array) -> tuple[Array, Array]:
        """Give one structure the best of several operating points of each figure.

        Args:
            trials: points with the same structure, shape (trials, n).

        Returns:
            The point, shape (n,), and its margins, shape (claims,).
        """
        made = datasets_of(self.space, trials, self.space.everything)
        best = self._scores_by_figure(self._by_figure(made)).argmax(axis=0)
        chosen = {
            name: made[trial][name]
            for trial, names in zip(best, self.space.parts.values(), strict=True)
            for name in names
        }
        return self._take(trials[0], trials, best), self.judge.judged(chosen)[0]

    def judged(self, points: Array) -> tuple[Array, list[int]]:
        """Judge points of shape (m, n).

        Returns:
            Their margins, shape (m, claims), and of each how many claims are contradicted.
        """
        found = [
            self.judge.judged(datasets)
            for start in range(0, len(points), _AT_ONCE)
            for datasets in datasets_of(
                self.space, points[start : start + _AT_ONCE], self.space.everything
            )
        ]
        return np.array([margins for margins, _ in found]), [against for _, against in found]


def _beside(known: Array, population: Array, size: int, rng: Generator) -> Array:
    """A population whose first half is ``known`` and structures beside them; shape as given."""
    half = max(len(known), population.shape[0] // 2)
    near = np.resize(known, (half, known.shape[1]))
    near[len(known) :, :size] += rng.normal(0.0, _BESIDE, (half - len(known), size))
    return np.concatenate([np.clip(near, 0.0, 1.0), population[: len(population) - half]])


def _joined(one: tuple[Array, Array], other: tuple[Array, Array]) -> tuple[Array, Array]:
    return np.concatenate([one[0], other[0]]), np.concatenate([one[1], other[1]])
