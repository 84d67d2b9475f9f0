"""The search: a pool of first samples, then differential evolution from the best of them.

Given the structure, the figures do not depend on each other's operating points. So only structures
evolve, in seven dimensions; with each, some operating points are tried and every figure takes the
one that suits it best. Everything drawn depends on the law's seed alone. Evolution is scipy's and
the pool a Latin hypercube of ``scipy.stats.qmc``; scipy has no search that is split like this one.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from model.study.claims.reading import Data
from model.study.claims.regime import regime_of, summary_of
from model.study.config import Evolution, Pool
from model.study.identification.candidate import Space
from model.study.identification.evaluate import datasets_of
from model.study.identification.score import Judge

Array = NDArray[np.float64]
_AT_ONCE = 8  # points judged together
_HOPELESS = -1e6  # score of a structure that cannot replace any
# Of a step beside a known operating point: its standard deviation, over the range, and the chance
# that a coordinate is drawn anew.
_BESIDE, _ANEW = 0.1, 0.1
_NEAR = 0.03  # standard deviation of a small step
_CLOSE = 0.02  # distance of structures, over the ranges, that do not begin a round together
# The figures whose axes begin where friction is 0 or end at ten times the excitation: tried first,
# because most structures fail there.
_HARD = ("fig06", "fig07", "fig09", "fig13")


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


class Found(NamedTuple):
    """Candidates of a search.

    Attributes:
        points: shape (m, n).
        margins: shape (m, claims).
        regimes: shape (m, fields of ``claims.regime.Summary``).
    """

    points: Array
    margins: Array
    regimes: Array


def joined(parts: Sequence[Found]) -> Found:
    """Return the candidates of all parts, in order."""
    return Found(*map(np.concatenate, zip(*parts, strict=True)))


@dataclass(frozen=True)
class Search:
    """A search: the space, the judge whose score is maximized, and the draws."""

    space: Space
    judge: Judge

    @property
    def size(self) -> int:
        """Number of unknowns of the structure, which come first in a point."""
        return self.space.places["structure"].stop

    def weighing(self, weight: float) -> "Search":
        """Return the same search with a weight of the claims on the regime."""
        return Search(self.space, self.judge.weighing(self.space.law.regime, weight))

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
            self._by_figure(datasets_of(self.space, trials, self.space.searched))
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
        parts = [names for figure, names in self.space.parts.items() if figure in made[0]]
        return np.array(
            [
                [
                    self.judge.margins({name: each[name] for name in names if name in each})
                    for names in parts
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
        evolution: Evolution,
        number: int,
        stage: int,
        before: Found | None = None,
        known: Array | None = None,
    ) -> Found:
        """Search on from the best that was found before, at first from a pool.

        Args:
            samples: the pool.
            evolution: the effort.
            number: of the search, so that searches draw differently.
            stage: number of the round.
            before: candidates of all rounds before, as returned.
            known: points found before, shape (k, n): half of the first population begins there.

        Returns:
            Every structure tried, before or now, with its best operating points.
        """
        seed = self.space.law.seed
        drawn = [np.random.default_rng([seed, k, number, stage]) for k in (1, 3)]
        if before is None:
            population = self.first_population(samples, evolution.population)
            if known is not None:
                population = _beside(known, population, self.size, drawn[0])
        else:
            population = self._spread(before, evolution.population)
            # Half of them small steps beside the others: differences of the spread ones are wide.
            near = population[evolution.population // 2 :]
            near[:] = population[: len(near)]
            near[:, : self.size] += drawn[0].normal(0.0, _NEAR, (len(near), self.size))
            near[:] = np.clip(near, 0.0, 1.0)
        evolved = self._evolve(population, evolution, drawn[0])
        found = evolved if before is None else joined([before, evolved])
        best = self._spread(found, evolution.polished)
        return joined([found, self._polish(best, evolution, drawn[1])])

    def _spread(self, found: Found, size: int) -> Array:
        """The best points whose structures are not close to a better one; shape (size, n)."""
        points, order = found.points, self.judge.highest(found.margins, len(found.points))
        chosen: list[int] = []
        for row in order.tolist():
            apart = np.abs(points[chosen, : self.size] - points[row, : self.size]).max(axis=-1)
            if (apart > _CLOSE).all():
                chosen.append(row)
            if len(chosen) == size:
                return np.asarray(points[chosen])
        others = [row for row in order.tolist() if row not in set(chosen)]
        return np.asarray(points[(chosen + others)[:size]])

    def _evolve(self, population: Array, evolution: Evolution, rng: Generator) -> Found:
        """Evolve structures, with operating points that follow them; see ``run``."""
        known, scores = list(population), [-math.inf] * len(population)
        members = np.full(len(population), -math.inf)  # scores of the population
        found: list[Found] = []
        others: list[float] = []

        def minus_score(columns: Array) -> Array:
            tried = [
                self._variants(each, np.array(known), np.array(scores), evolution.trials, rng)
                for each in np.atleast_2d(columns.T)
            ]
            # Each competes with one member of the population, of the same number.
            fitted = [
                self.fit(trials, least, others)
                for trials, least in zip(tried, members, strict=True)
            ]
            if not found:  # the population itself, now judged
                known.clear()
                scores.clear()
            values = np.full(len(members), _HOPELESS)
            for number, each in enumerate(fitted):
                if each is not None:
                    values[number] = self.judge.score(each.margins[0])
                    found.append(each)
                    known.append(each.points[0])
                    scores.append(values[number])
            members[:] = np.maximum(members, values)
            return -values

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
        return joined(found)

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
                step = rng.normal(0.0, _NEAR if i % 2 else _BESIDE, known.shape[1])
                found[i] = np.clip(found[i] + step, 0.0, 1.0)
                drawn = rng.random((2, known.shape[1]))
                found[i] = np.where(drawn[0] < _ANEW, drawn[1], found[i])
        found[:, : self.size] = structure
        return found

    def _polish(self, points: Array, evolution: Evolution, rng: Generator) -> Found:
        """Try more operating points with each structure: half from everywhere, half beside its own.

        Returns:
            One candidate for each structure.
        """
        polished: list[Found] = []
        for point in points:
            fitted: list[Found | None] = []
            for _ in range(evolution.passes):
                trials = np.repeat(point[None, :], evolution.polish, axis=0)
                own = trials[1:, self.size :]
                is_near = np.arange(own.shape[0])[:, None] % 2 == 0
                step = np.where(np.arange(own.shape[0])[:, None] % 4 == 0, _NEAR, _BESIDE)
                beside = np.clip(own + step * rng.normal(size=own.shape), 0.0, 1.0)
                anywhere = rng.random(own.shape)
                trials[1:, self.size :] = np.where(is_near, beside, anywhere)
                # Nothing is below minus infinity, so that there is a candidate.
                fitted = [self.fit(trials, -math.inf, [])]
                point = joined([each for each in fitted if each]).points[0]
            polished += [each for each in fitted if each]
        return joined(polished)

    def fit(self, trials: Array, least: float, others: list[float]) -> Found | None:
        """Give one structure the best of several operating points of each figure.

        Args:
            trials: points with the same structure, shape (trials, n).
            least: score below which a structure is of no use.
            others: scores of the figures that are not hard, of the structures judged so far; that
                of this one is appended.

        Returns:
            One candidate; None if its hard figures and the best of ``others`` stay below ``least``.
        """
        names = [name for name in _HARD if name in self.space.parts]
        parts = [name for figure in names for name in self.space.parts[figure]]
        made = datasets_of(self.space, trials, [p for p in parts if p in self.space.searched])
        hard = self._scores_by_figure(self._by_figure(made)).max(axis=0).sum()
        if others and hard + max(others) < least:
            return None
        rest = [name for name in self.space.searched if name not in parts]
        more = datasets_of(self.space, trials, rest)
        made = [{**one, **other} for one, other in zip(made, more, strict=True)]
        scores = self._scores_by_figure(self._by_figure(made))
        others.append(float(scores.max(axis=0).sum() - hard))
        best = scores.argmax(axis=0)
        chosen = {
            name: made[trial][name]
            for trial, names in zip(best, self.space.parts.values(), strict=True)
            for name in names
            if name in made[trial]
        }
        margins, _ = self.judge.judged(chosen)
        point = self._take(trials[0], trials, best)
        return Found(point[None], margins[None], self._regime(chosen)[None])

    def _regime(self, datasets: Mapping[str, xr.Dataset]) -> Array:
        data = Data(datasets)
        return np.array(summary_of(regime_of(data, name) for name in self.space.figures))

    def judged(self, points: Array) -> tuple[Found, list[int]]:
        """Judge points of shape (m, n) by all claims, with every own run.

        Returns:
            The candidates, and of each how many claims are contradicted.
        """
        found, against = [], []
        for start in range(0, len(points), _AT_ONCE):
            part = points[start : start + _AT_ONCE]
            for point, datasets in zip(
                part, datasets_of(self.space, part, self.space.everything), strict=True
            ):
                margins, contradicted = self.judge.judged(datasets)
                found.append(Found(point[None], margins[None], self._regime(datasets)[None]))
                against.append(contradicted)
        return joined(found), against


def _beside(known: Array, population: Array, size: int, rng: Generator) -> Array:
    """A population whose first half is ``known`` and structures beside them; shape as given."""
    half = max(len(known), population.shape[0] // 2)
    near = np.resize(known, (half, known.shape[1]))
    near[len(known) :, :size] += rng.normal(0.0, _BESIDE, (half - len(known), size))
    return np.concatenate([np.clip(near, 0.0, 1.0), population[: len(population) - half]])
