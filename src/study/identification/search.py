"""The search: structures drawn from the priors, moved by differential evolution, scored, polished.

Each part is a function of the parts before it and its own seed, so that a search can be interrupted
and goes on. Within a structure the figures' operating points are chosen from those of near
structures, changes of them, and new draws.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from study.claims.data import Tables
from study.config.identification import Round, Stage
from study.identification.candidates import (
    Choice,
    Numbers,
    Scores,
    chosen,
    costs_alone,
    picked_tables,
    scores_of,
    shortfall_at_last,
)
from study.identification.space import Array, Space

_STEPS = (0.01, 0.05, 0.2)  # by which operating points are changed, in widths of their priors
_SMALL_STEPS = (0.003, 0.01, 0.03)  # of structures at last, in widths of their priors
_NEW = 0.25  # share of operating points that are drawn from the priors
_DIFFERENT = 0.02  # distance from which two structures count as different
_FINAL, _POLISH = 1_000_000, 1_000_001  # numbers in seeds, beside those of the rounds
_GIVE_UP = 1.3  # times the least shortfall above which a structure is not scored to its end
# Figures in the order in which they rule out most structures for the least time.
_ORDER = ("fig05", "fig10", "fig11", "fig09", "fig07", "fig08", "fig14", "fig13", "fig06", "fig12")


@dataclass(frozen=True)
class Found:
    """Sets with their shortfalls.

    Attributes:
        points: coordinates of all unknowns, shape (m, n).
        shortfalls: in claims, shape (m,).
    """

    points: Array
    shortfalls: Array

    @classmethod
    def of(cls, choices: Iterable[Choice]) -> "Found":
        """Return the sets of choices, the best first."""
        ordered = sorted(choices, key=lambda choice: choice.shortfall)
        return cls(
            np.array([each.point for each in ordered]),
            np.array([each.shortfall for each in ordered]),
        )

    def best(self, count: int, apart: float, places: slice) -> Array:
        """Return the best sets whose structures differ by ``apart``, shape (<= count, n)."""
        kept: list[Array] = []
        for row in np.argsort(self.shortfalls, kind="stable"):
            point = self.points[row]
            if all(np.abs(point - each)[places].max() >= apart for each in kept):
                kept.append(point)
            if len(kept) == count:
                break
        return np.array(kept)


def pool(space: Space, structures: int, stages: Sequence[Stage], part: int) -> Found:
    """Return structures drawn from the priors by a Latin hypercube, with their best figures.

    The structures of a part are of one third of the half-widths; see ``bounds_of``.
    """
    random, unknowns = random_of(space, 0, part), space.places["structure"].stop
    low, high = bounds_of(part, unknowns).T
    drawn = qmc.LatinHypercube(unknowns, rng=random).random(structures)
    choices: list[Choice] = []
    for structure in low + (high - low) * drawn:
        parents = np.empty((0, len(space.names)))
        made = scored(space, structure, parents, stages, random, _worst(choices, 20))
        choices += [made[0]] if made else []
    return Found.of(choices)


def evolve(space: Space, spec: Round, number: int, start: int, before: Found) -> Found:
    """Return the sets of a round of a search by differential evolution.

    Args:
        space: of the search.
        spec: effort of the round.
        number: number of the round, from 0.
        start: number of the search, from 0; it keeps to a third of the half-widths.
        before: sets of the pool for the first round, else of the round before.
    """
    random, where = random_of(space, 1 + number, start), space.places["structure"]
    bounds = bounds_of(start, where.stop)
    near = before.best(30, _DIFFERENT, where)
    choices: list[Choice] = []

    def cost(structure: Array) -> float:
        worst = _worst(choices, 4)
        known = np.concatenate([*(each.point[None] for each in choices), near])
        parents = _nearest(structure, known, where)
        made = scored(space, structure, parents, spec.stages, random, worst)
        if not made:
            return _GIVE_UP * worst
        choices.append(made[0])
        return made[0].shortfall

    differential_evolution(
        cost,
        bounds,
        init=_population(before, spec.population, bounds, random),
        maxiter=spec.generations - 1,
        tol=0.0,
        polish=False,
        rng=random,
    )
    return Found.of(choices)


def bounds_of(number: int, unknowns: int) -> Array:
    """Return the bounds of a part of the pool or a search, shape (unknowns, 2).

    Each keeps to a third of the half-widths, every third one to the same: slender and plump parts
    rest, tilt and lift off differently, and all would end among those that meet the aims easily.
    """
    bounds = np.array([[0.0, 1.0]] * unknowns)
    bounds[0] = (number % 3) / 3.0, (number % 3 + 1) / 3.0
    return bounds


def _population(found: Found, count: int, bounds: Array, random: Generator) -> Array:
    """Return the best structures within bounds, and draws if there are too few, (count, 7)."""
    low, high = bounds.T
    structures = found.best(len(found.points), _DIFFERENT, slice(0, len(bounds)))[:, : len(bounds)]
    inside = structures[((low <= structures) & (structures <= high)).all(axis=-1)][:count]
    draws = qmc.LatinHypercube(len(bounds), rng=random).random(count - len(inside))
    return np.concatenate([inside, low + (high - low) * draws])


def _nearest(structure: Array, known: Array, where: slice) -> Array:
    """Return ``known`` sets, those with the nearest structures first."""
    return known[np.argsort(np.abs(known[:, where] - structure).max(axis=-1), kind="stable")]


def _worst(choices: Sequence[Choice], best: int) -> float:
    """Return the shortfall of the last of the ``best`` choices; infinite with fewer."""
    ordered = sorted(choice.shortfall for choice in choices)
    return ordered[best - 1] if len(ordered) >= best else math.inf


def random_of(space: Space, number: int, part: int) -> Generator:
    """Return the random numbers of a part of the search, from the seed of the study."""
    return np.random.default_rng([space.problem.seed, number, part])


def scored(
    space: Space,
    structure: Array,
    parents: Array,
    stages: Sequence[Stage],
    random: Generator,
    limit: float = math.inf,
) -> tuple[Choice, Mapping[str, Scores]] | None:
    """Return the choice of a structure's operating points on the last grid, and its figures.

    The first stage tries operating points of ``parents`` (the first counts most), changes of them
    and new draws; each later one the best of the stage before, on its own grid.

    Args:
        space: of the search.
        structure: coordinates, shape (7,).
        parents: sets whose operating points are tried, shape (k, n).
        stages: grids and numbers of operating points.
        random: for changes and draws.
        limit: a structure that must fall shorter, by a margin, is given up; None is returned.
    """
    points = {
        name: _drawn(parents[:, space.places[name]], stages[0].points, random)
        for name in space.figures
    }
    for stage in stages:
        grid, figures, certain = space.grid(stage.grid), dict[str, Scores](), 0.0
        for name in filter(space.figures.__contains__, _ORDER):
            figures[name] = scores_of(space, structure, name, points[name][: stage.points], grid)
            certain += float(costs_alone(space, name, figures[name], shared=0.0).min())
            if certain > _GIVE_UP * limit:
                return None
        choice = chosen(space, structure, figures)
        points = {name: _best_first(space, figures, choice, name) for name in space.figures}
    return choice, figures


def _drawn(parents: Array, count: int, random: Generator) -> Array:
    """Return operating points of a figure, shape (count, unknowns), from those of ``parents``."""
    size = parents.shape[1]
    if not len(parents):
        return qmc.LatinHypercube(size, rng=random).random(count)
    near = parents[: max(1, count // 4)]
    new = random.random((math.ceil(_NEW * count), size))
    changed = count - len(near) - len(new)
    of = parents[np.minimum(random.geometric(0.4, size=max(changed, 0)) - 1, len(parents) - 1)]
    step = random.choice(_STEPS, size=(len(of), 1))
    return np.concatenate([near, new, np.clip(of + step * random.normal(size=of.shape), 0.0, 1.0)])[
        :count
    ]


def _best_first(space: Space, figures: Mapping[str, Scores], choice: Choice, name: str) -> Array:
    """Return the operating points of a figure: the chosen one, then the best by several weights."""
    made = figures[name]
    ranks = [np.argsort(costs_alone(space, name, made, weight)) for weight in (2.0, 8.0, 20.0)]
    order = [choice.picked[name], *np.array(ranks).T.ravel().tolist()]
    return made.points[list(dict.fromkeys(order))]


def final(
    space: Space, stages: Sequence[Stage], number: int, found: Found
) -> tuple[Choice, Tables]:
    """Return the set with the ``number``-th best structure, and its tables on the study's grids.

    Its operating points are chosen anew on these grids.
    """
    where, point = space.places["structure"], _numbered(space, found, number)
    parents = _nearest(point[where], found.points, where)[:60]
    made = scored(space, point[where], parents, stages, random_of(space, _FINAL, number))
    assert made is not None  # noqa: S101  (without a limit none is given up)
    return made[0], picked_tables(made[1], made[0].picked)


def polish(
    space: Space, stages: Sequence[Stage], trials: int, number: int, found: Found
) -> tuple[Choice, Tables]:
    """Return the ``number``-th best set after small steps, and its tables on the last grid.

    A step to another structure and other operating points is kept if it falls shorter by less; a
    set that misses a limit counts as a claim more.

    Args:
        space: of the search.
        stages: grids and numbers of operating points of each step.
        trials: number of steps.
        number: of the set, from 0.
        found: scored sets.
    """
    where, random = space.places["structure"], random_of(space, _POLISH, number)
    point = _numbered(space, found, number)
    unmoved = [stage.model_copy(update={"points": 1}) for stage in stages]
    best = scored(space, point[where], point[None], unmoved, random)
    assert best is not None  # noqa: S101  (without a limit none is given up)
    least = _cost_at_last(space, *best)
    for _ in range(trials):
        point = best[0].point
        step = random.choice(_SMALL_STEPS) * random.normal(size=where.stop)
        structure = np.clip(point[where] + step, 0.0, 1.0)
        made = scored(space, structure, point[None], stages, random, least / _GIVE_UP)
        if made and (cost := _cost_at_last(space, *made)) < least:
            best, least = made, cost
    return best[0], picked_tables(best[1], best[0].picked)


def _numbered(space: Space, found: Found, number: int) -> Array:
    """Return the ``number``-th best of the sets whose structures differ, from 0."""
    best = found.best(number + 1, _DIFFERENT, space.places["structure"])
    if len(best) <= number:
        raise LookupError(
            f"only {len(best)} structures differ: lower final.sets and polish.sets, or search "
            "longer"
        )
    return np.asarray(best[number])


def _cost_at_last(space: Space, choice: Choice, figures: Mapping[str, Scores]) -> float:
    """Return the ``shortfall_at_last`` of the chosen operating points."""
    numbers = {
        name: Numbers(*figures[name].numbers[row].tolist()) for name, row in choice.picked.items()
    }
    return shortfall_at_last(space.problem, choice.shortfall, numbers)
