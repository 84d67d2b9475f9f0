"""The search for what the paper leaves unstated, by the list that judges the device.

Given the structure, each figure has an operating point of its own. So every figure is computed at
several, and those are chosen together that show most; most entries read one figure only. Structures
are drawn from the priors; the best are moved and mixed on a coarse grid, and refined on a fine one.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import yaml
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.stats import qmc

from model.sweeps.sweep import Sweep
from study.claims.claims import CLAIMS, Claim
from study.claims.data import Figure
from study.claims.ledger import judge_claim
from study.claims.regime import Regime, regime_of
from study.config.identification import Effort, Grid, Limits
from study.identification.batch import figures_of
from study.identification.space import Array, Space, configuration

Picked = Mapping[str, int]  # number of the operating point of each figure

_PARTLY = 0.5  # of an entry, for how near its numbers come to their limits
_LIMIT, _MOST = 3.0, 2.0  # entries that a limit missed by its whole size counts as, and the most
_POINTS = {"rough": 3, "coarse": 5, "fine": 4}  # operating points of each figure, by grid
_STEPS = (0.02, 0.06, 0.2)  # by which operating points are changed, in widths of their priors
_MOVES = (0.01, 0.04, 0.12)  # by which structures are
_BEST = 8  # sets from which others are made
_FIRST = 3  # of these are judged on the fine grid
_RESERVE = 1.05  # of the limits there: less may be kept on another grid


@dataclass(frozen=True)
class Found:
    """A set that was judged.

    Attributes:
        point: coordinates of all unknowns, shape (n,).
        score: entries shown, and parts of others, less what limits are missed by.
        shown: the entries shown, held out or not.
        regimes: of the figures, by name.
    """

    point: Array
    score: float
    shown: tuple[str, ...]
    regimes: Mapping[str, Regime]


class Choice:
    """A structure with several operating points of each figure, of which the best are chosen.

    It is judged by those of ``entries`` that read its figures only, and by the regime of these.
    """

    def __init__(
        self,
        space: Space,
        limits: Limits | None,
        structure: Array,
        points: Mapping[str, Array],
        grid: Grid,
        reserve: float = 1.0,
        entries: Collection[str] | None = None,
    ) -> None:
        self.space, self.limits, self.structure, self.points = space, limits, structure, points
        self.reserve = reserve  # factor of values that have a limit
        found = iter(figures_of([[sweep] for sweep in self._sweeps(grid)]))
        self.figures: Mapping[str, list[Figure]] = {
            name: [next(found)[name] for _ in tried] for name, tried in points.items()
        }
        self.regimes = {n: [regime_of(each) for each in made] for n, made in self.figures.items()}
        self._worths: dict[tuple[str, tuple[int, ...]], float] = {}
        self.claims = [claim for claim in CLAIMS if {*claim.figures} <= {*points}]
        self.judges = [each for each in self.claims if entries is None or each.id in entries]

    def _sweeps(self, grid: Grid) -> Iterator[Sweep]:
        for name, tried in self.points.items():
            for point in tried:
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

    @cached_property
    def _alone(self) -> Mapping[str, NDArray[np.float64]]:
        """Worth of each operating point of a figure by itself, shape (points,)."""
        return {
            name: np.array([
                sum(self._worth(c, {name: row}) for c in self.judges if c.figures == (name,))
                - missed(self.limits, name, regime, self.reserve)
                for row, regime in enumerate(regimes)
            ])
            for name, regimes in self.regimes.items()
        }  # fmt: skip

    def score(self, picked: Picked) -> float:
        """Return what operating points are worth together."""
        total = sum(float(self._alone[name][row]) for name, row in picked.items())
        if self.limits:
            rests = [_known(self.regimes[n][row].not_resting, 1.0) for n, row in picked.items()]
            mean = self.reserve * float(np.mean(rests))
            total -= _cost(mean, self.limits.not_resting)
        return total + sum(self._worth(c, picked) for c in self.judges if len(c.figures) > 1)

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
        regimes = {name: self.regimes[name][row] for name, row in picked.items()}
        return Found(point, self.score(picked), tuple(shown), regimes)

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


def _cost(value: float, most: float) -> float:
    """Return what it costs, in entries, that a value is above its limit."""
    return _LIMIT * min(max(value / most - 1.0, 0.0), _MOST)


def missed(limits: Limits | None, figure: str, of: Regime, reserve: float = 1.0) -> float:
    """Return by how much a figure misses the limits of the regime, in entries.

    A figure that never aligns misses them as far as can be; the mean share not resting is left to
    ``Choice.score``. Values count ``reserve`` times. Without limits it is 0.
    """
    if limits is None:
        return 0.0
    ratios = (
        (_known(of.not_resting, 1.0), limits.not_resting_most),
        (_known(of.tilt, 1.0), limits.tilt),
        (1.0 - _known(of.corners, 0.0), 1.0 - limits.corners),
        (limits.aligned_least, max(of.aligned_least, 0.01)),
        (limits.aligned.get(figure, 0.0), max(of.aligned_shown, 0.01)),
        (_known(of.lift_offs, 1.0), limits.hops.get(figure, 1.0)),
    )
    return sum(_cost(reserve * value, most) for value, most in ratios)


# --- The search -----------------------------------------------------------------------------------


def search(space: Space, effort: Effort) -> Found:
    """Return the set at which a search from nothing ends, judged on the fine grid.

    It is the same for the same seed.

    Raises:
        ValueError: it is to judge by an entry that there is not.
    """
    if absent := {*(effort.entries or ())} - {claim.id for claim in CLAIMS}:
        raise ValueError(f"entries: the ledger has no {', '.join(sorted(absent))}; see claims.yaml")
    random, where = np.random.default_rng(effort.seed), space.places["structure"]
    limits = space.problem.limits if effort.limited else None
    low, high = space.half_widths(effort.half_width)

    def judged(structure: Array, parents: Sequence[Found], grid: str) -> Found:
        structure = np.clip(structure, 0.0, 1.0)
        structure[0] = np.clip(structure[0], low, high)
        known = np.array([each.point for each in parents]).reshape(-1, len(space.names))
        on = space.problem.grids[grid]
        points = {n: _drawn(known[:, space.places[n]], _POINTS[grid], random) for n in on.counts}
        reserve = _RESERVE if grid == "fine" else 1.0
        choice = Choice(space, limits, structure, points, on, reserve, effort.entries)
        return choice.best(random)

    drawn = qmc.LatinHypercube(where.stop, rng=random).random(effort.drawn)
    drawn[:, 0] = low + (high - low) * drawn[:, 0]
    found = _best([judged(structure, [], "rough") for structure in drawn], where)
    found = [judged(each.point[where], [each], "coarse") for each in found]
    for _ in range(effort.moved):
        structure, parents = _moved(_best(found, where), where, random)
        found.append(judged(structure, parents, "coarse"))
    # Draws of its own, so that its steps do not depend on the number of draws before.
    found, random = _best(found, where), np.random.default_rng([effort.seed, 1])
    tried = [judged(each.point[where], [each, *found], "fine") for each in found[:_FIRST]]
    for number in range(effort.refined):
        best = _best(tried, where)[0]
        step = (number % 2) * random.choice(_MOVES) * random.normal(size=where.stop)
        tried.append(judged(best.point[where] + step, [best, *found], "fine"))
    return _best(tried, where)[0]


def _best(found: Sequence[Found], where: slice) -> list[Found]:
    """Return the best sets, the first first; of one structure only the best."""
    kept: dict[bytes, Found] = {}
    for each in sorted(found, key=lambda each: -each.score):
        kept.setdefault(each.point[where].tobytes(), each)
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
