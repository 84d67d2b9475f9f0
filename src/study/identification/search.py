"""The search for what the paper leaves unstated, by the list that judges the device.

Given the structure, each figure has an operating point of its own. So every figure is computed at
several, and those are chosen together that show most; most entries read one figure only. Structures
are drawn from the priors; the best are moved and mixed on a coarse grid, and refined on a fine one.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import yaml
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.stats import qmc

from model.sweeps.sweep import Sweep
from study.claims.claims import CLAIMS, Claim
from study.claims.data import Figure, Figures
from study.claims.ledger import judge_claim
from study.claims.regime import Regime, regime_of
from study.config.identification import Effort, Grid, Limits
from study.identification.batch import figures_of
from study.identification.space import Array, Space, configuration

Picked = Mapping[str, int]  # number of the operating point of each figure

_PARTLY = 0.5  # of an entry, for how near its numbers come to their limits
_LIMIT = 3.0  # entries that a limit missed by its whole size counts as
_MOST = 2.0  # sizes; what misses a limit by more counts as much
_POINTS = {"rough": 3, "coarse": 5, "fine": 5}  # operating points of each figure, by grid
_OF_ONE_RUN = 1024  # operating points at last of figures of one run, which cost next to nothing
_STEPS = (0.02, 0.06, 0.2)  # by which operating points are changed, in widths of their priors
_MOVES = (0.01, 0.04, 0.12)  # by which structures are
_BEST = 8  # sets from which others are made
_FIRST = 3  # of these are judged on the fine grid
_RESERVE = 1.02  # of the limits there: less may be kept on another grid


@dataclass(frozen=True)
class Found:
    """A set that was judged.

    Attributes:
        point: coordinates of all unknowns, shape (n,).
        score: entries shown, and parts of others, less what limits it misses (``Objective``).
        shown: the entries shown, held out or not.
        figures: by name, as computed on the grid where it was judged.
    """

    point: Array
    score: float
    shown: tuple[str, ...]
    figures: Figures

    @property
    def regimes(self) -> dict[str, Regime]:
        """Regimes of the figures, by name."""
        return {name: regime_of(figure) for name, figure in self.figures.items()}


@dataclass(frozen=True)
class Objective:
    """Score of a set: the entries that it shows, less the limits that it misses.

    Attributes:
        limits: of the regime, None to search without.
        entries: that judge, None for all.
        conclusion: entries that one of a conclusion counts as.
        limit: entries that a limit missed by its whole size counts as.
        reserve: factor of values that have a limit.
    """

    limits: Limits | None
    entries: Collection[str] | None = None
    conclusion: float = 1.0
    limit: float = _LIMIT
    reserve: float = 1.0

    def missed(self, figure: str, regime: Regime) -> float:
        """Return what the limits cost that a figure misses."""
        return (
            self.limit * missed(self.limits, figure, regime, self.reserve) if self.limits else 0.0
        )

    def resting(self, not_resting: Sequence[float]) -> float:
        """Return what it costs that too large a share does not rest, in the mean of the figures."""
        mean = self.reserve * float(np.mean([_known(share, 1.0) for share in not_resting]))
        return self.limit * _beyond(mean, self.limits.not_resting) if self.limits else 0.0


class Choice:
    """A structure with several operating points of each figure, of which the best are chosen.

    It is judged by those entries that read its figures only, and by the regime of these. ``first``
    has the figures at the first operating points, if they were computed before.
    """

    def __init__(
        self,
        space: Space,
        objective: Objective,
        structure: Array,
        points: Mapping[str, Array],
        grid: Grid,
        first: Figures | None = None,
    ) -> None:
        self.space, self.structure, self.points = space, structure, points
        self.objective, known = objective, first or {}
        made = iter(figures_of([[sweep] for sweep in self._sweeps(grid, known)]))
        self.figures: Mapping[str, list[Figure]] = {
            name: [known[name] if row == 0 and name in known else next(made)[name]
                   for row in range(len(tried))]
            for name, tried in points.items()
        }  # fmt: skip
        self.regimes = {n: [regime_of(each) for each in made] for n, made in self.figures.items()}
        self._worths: dict[tuple[str, tuple[int, ...]], float] = {}
        self.claims = [claim for claim in CLAIMS if {*claim.figures} <= {*points}]
        judges = objective.entries
        self.judges = [each for each in self.claims if judges is None or each.id in judges]

    def _sweeps(self, grid: Grid, known: Figures) -> Iterator[Sweep]:
        for name, tried in self.points.items():
            for point in tried[name in known :]:
                yield self.space.sweep(self.space.values(self._whole({name: point})), name, grid)

    def _whole(self, points: Mapping[str, Array]) -> Array:
        whole = np.full(len(self.space.names), 0.5)
        for name, point in {"structure": self.structure, **points}.items():
            whole[self.space.places[name]] = point
        return whole

    def _worth(self, claim: Claim, picked: Picked) -> float:
        """Return 1 for an entry that is shown, else below a half, the more the nearer it comes."""
        key = claim.id, tuple(picked[name] for name in claim.figures)
        if key not in self._worths:
            figures = {name: self.figures[name][picked[name]] for name in claim.figures}
            found = judge_claim(claim, figures)
            near = [1.0 + min(number.margin, 0.0) for number in found.numbers]
            partly = _PARTLY * sum(near) / len(near) if near else 0.0
            self._worths[key] = 1.0 if found.verdict == "shown" else partly
        return self._worths[key]

    def _weighed(self, claim: Claim, picked: Picked) -> float:
        weight = self.objective.conclusion if claim.is_conclusion else 1.0
        return weight * self._worth(claim, picked)

    @cached_property
    def _alone(self) -> Mapping[str, NDArray[np.float64]]:
        """Worth of each operating point of a figure by itself, shape (points,)."""
        return {
            name: np.array([
                sum(self._weighed(c, {name: row}) for c in self.judges if c.figures == (name,))
                - self.objective.missed(name, regime)
                for row, regime in enumerate(regimes)
            ])
            for name, regimes in self.regimes.items()
        }  # fmt: skip

    def score(self, picked: Picked) -> float:
        """Return what operating points are worth together."""
        alone = sum(float(self._alone[name][row]) for name, row in picked.items())
        together = sum(self._weighed(c, picked) for c in self.judges if len(c.figures) > 1)
        rests = [self.regimes[name][row].not_resting for name, row in picked.items()]
        return alone + together - self.objective.resting(rests)

    def best(self, random: Generator) -> Found:
        """Return the best choice: from several starts, one figure at a time."""
        alone = {name: int(np.argmax(worth)) for name, worth in self._alone.items()}
        others = [
            {name: int(random.integers(len(tried))) for name, tried in self.points.items()}
            for _ in range(2)
        ]
        picked = max(map(self._improved, [alone, *others]), key=self.score)
        shown = [claim.id for claim in self.claims if self._worth(claim, picked) == 1.0]
        point = self._whole({name: self.points[name][row] for name, row in picked.items()})
        figures = {name: self.figures[name][row] for name, row in picked.items()}
        return Found(point, self.score(picked), tuple(shown), figures)

    def _improved(self, picked: Picked) -> Picked:
        value = -np.inf
        while (now := self.score(picked)) > value + 1e-9:
            value = now
            for name, tried in self.points.items():
                options = [{**picked, name: row} for row in range(len(tried))]
                picked = max(options, key=self.score)
        return picked


def _known(value: float, otherwise: float) -> float:
    return otherwise if np.isnan(value) else value


def _beyond(value: float, most: float) -> float:
    """Return by how much a value is above its limit, in sizes of the limit."""
    return min(max(value / most - 1.0, 0.0), _MOST)


def missed(limits: Limits, figure: str, of: Regime, reserve: float = 1.0) -> float:
    """Return by how much a figure misses the limits of the regime, in their sizes, in all.

    A figure that never aligns misses them as far as can be; the mean share not resting is left to
    ``Objective.resting``. Values count ``reserve`` times.
    """
    ratios = (
        (_known(of.not_resting, 1.0), limits.not_resting_most),
        (_known(of.tilt, 1.0), limits.tilt),
        (1.0 - _known(of.corners, 0.0), 1.0 - limits.corners),
        (limits.aligned_least, max(of.aligned_least, 0.01)),
        (limits.aligned.get(figure, 0.0), max(of.aligned_shown, 0.01)),
        (_known(of.lift_offs, 1.0), limits.hops.get(figure, np.inf)),
    )
    return sum(_beyond(reserve * value, most) for value, most in ratios)


# --- The search -----------------------------------------------------------------------------------


def search(space: Space, effort: Effort) -> Found:
    """Return the set at which a search from nothing ends, judged on the fine grid.

    It is the same for the same seed.

    Raises:
        ValueError: it is to judge by an entry that there is not.
    """
    if absent := {*(effort.entries or ())} - {claim.id for claim in CLAIMS}:
        raise ValueError(f"entries: the ledger has no {', '.join(sorted(absent))}; see claims.yaml")
    stages = _Stages(space, effort)
    return stages.refined(stages.moved(stages.drawn()))


class _Stages:
    """The stages of a search, which share its random numbers."""

    def __init__(self, space: Space, effort: Effort) -> None:
        self.space, self.effort, self.where = space, effort, space.places["structure"]
        self.random = np.random.default_rng(effort.seed)
        self.ends = space.half_widths(effort.half_width)
        self.rule = Objective(space.problem.limits if effort.limited else None, effort.entries)
        self.fine = space.problem.grids["fine"]
        self.at_last = replace(
            self.rule, conclusion=effort.conclusion, limit=effort.dearer * _LIMIT, reserve=_RESERVE
        )

    def drawn(self) -> list[Found]:
        """Draw structures from the priors; return the best on the rough grid."""
        low, high = self.ends
        drawn = qmc.LatinHypercube(self.where.stop, rng=self.random).random(self.effort.drawn)
        drawn[:, 0] = low + (high - low) * drawn[:, 0]
        return self._best([self._judged(structure, [], "rough") for structure in drawn])

    def moved(self, found: list[Found]) -> list[Found]:
        """Move structures and mix them; return the best on the coarse grid."""
        found = [self._judged(each.point[self.where], [each], "coarse") for each in found]
        for _ in range(self.effort.moved):
            structure, parents = _moved(self._best(found), self.where, self.random)
            found.append(self._judged(structure, parents, "coarse"))
        return self._best(found)

    def refined(self, found: list[Found]) -> Found:
        """Take steps from the best set on the fine grid; every third moves the structure."""
        # Draws of its own, so that its steps do not depend on the number of draws before.
        self.random = np.random.default_rng([self.effort.seed, 1])
        tried = [
            self._judged(each.point[self.where], [each, *found], "fine") for each in found[:_FIRST]
        ]
        for number in range(self.effort.refined):
            best = self._best(tried)[0]
            if number % 3:
                tried.append(self._changed(best, _POINTS["fine"], self.fine.counts))
            else:
                step = self.random.choice(_MOVES) * self.random.normal(size=self.where.stop)
                structure = best.point[self.where] + step
                tried.append(self._judged(structure, [best, *found], "fine"))
        # Figures of one run cost next to nothing.
        single = [name for name, count in self.fine.counts.items() if count == 1]
        return self._changed(self._best(tried)[0], _OF_ONE_RUN, single)

    def _judged(self, structure: Array, parents: Sequence[Found], grid: str) -> Found:
        structure = np.clip(structure, 0.0, 1.0)
        structure[0] = np.clip(structure[0], *self.ends)
        known = np.array([each.point for each in parents]).reshape(-1, len(self.space.names))
        on, places = self.space.problem.grids[grid], self.space.places
        points = {n: _drawn(known[:, places[n]], _POINTS[grid], self.random) for n in on.counts}
        rule = self.at_last if grid == "fine" else self.rule
        return Choice(self.space, rule, structure, points, on).best(self.random)

    def _changed(self, best: Found, count: int, names: Collection[str]) -> Found:
        """Return the best set with other operating points of some figures."""
        points = {name: best.point[self.space.places[name]][None] for name in self.fine.counts}
        points |= {name: _changed(points[name][0], count, self.random) for name in names}
        structure = best.point[self.where]
        choice = Choice(self.space, self.at_last, structure, points, self.fine, best.figures)
        return choice.best(self.random)

    def _best(self, found: Sequence[Found]) -> list[Found]:
        """Return the best sets, the first first; of one structure only the best."""
        kept: dict[bytes, Found] = {}
        for each in sorted(found, key=lambda each: -each.score):
            kept.setdefault(each.point[self.where].tobytes(), each)
        return [*kept.values()][:_BEST]


def _drawn(parents: Array, count: int, random: Generator) -> Array:
    """Return operating points of a figure, shape (count, unknowns), from those of ``parents``.

    The first and another parent's, changes of them, and a new one; all new ones without parents.
    """
    size = parents.shape[1]
    if not len(parents):
        return qmc.LatinHypercube(size, rng=random).random(count)
    kept = parents[[0, int(random.integers(len(parents)))]]
    of = parents[np.minimum(random.geometric(0.5, size=count - 3) - 1, len(parents) - 1)]
    step = random.choice(_STEPS, size=(len(of), 1))
    changed = np.clip(of + step * random.normal(size=of.shape), 0.0, 1.0)
    return np.concatenate([kept, changed, random.random((1, size))])


def _changed(point: Array, count: int, random: Generator) -> Array:
    """Return an operating point of a figure, changes of it and new ones, (count, unknowns).

    A quarter of them are new ones, rounded down, and one at least.
    """
    new = max(1, count // 4)
    step = random.choice(_STEPS, size=(count - 1 - new, 1))
    changed = np.clip(point + step * random.normal(size=(len(step), point.size)), 0.0, 1.0)
    return np.concatenate([point[None], changed, random.random((new, point.size))])


def _moved(best: Sequence[Found], where: slice, random: Generator) -> tuple[Array, list[Found]]:
    """Return a structure made of the best sets, and the sets whose operating points it tries.

    It is the parent's moved by a little, mixed with two others, or the parent's own.
    """
    parent = best[min(int(random.geometric(0.4)) - 1, len(best) - 1)]
    structure, kind = parent.point[where].copy(), random.random()
    if kind < 0.45:
        structure += random.choice(_MOVES) * random.normal(size=structure.size)
    elif kind < 0.8:
        one, other = (best[int(k)].point[where] for k in random.choice(len(best), 2))
        mixed = structure + 0.7 * (one - other) + 0.02 * random.normal(size=structure.size)
        structure = np.where(random.random(structure.size) < 0.7, mixed, structure)
    return structure, [parent, *best]


def result_text(space: Space, found: Found) -> str:
    """Return a set as YAML: as it stands in the configuration, what it shows, and its regime."""
    values = space.values(found.point)
    stated = {
        "score": round(found.score, 3),
        "entries": len(found.shown),
        "shown": " ".join(found.shown),
        **configuration(space, values),
        "unknowns": {name: float(f"{value:.4g}") for name, value in values.items()},
        "regime": {
            name: {key: round(number, 3) for key, number in regime._asdict().items()}
            for name, regime in found.regimes.items()
        },
    }
    return str(yaml.safe_dump(stated, sort_keys=False, default_flow_style=None, width=100))
