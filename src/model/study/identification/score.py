"""The score of a candidate: how well its figures show what the paper says.

``Judge`` turns a candidate's datasets into margins, one for each claim, and orders candidates by
them. The search compares candidates by ``Judge.score`` alone, and what it finds is ranked by
``Judge.order``: other objectives belong beside these two.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.study.claims import CLAIMS, Claim
from model.study.claims.ledger import judge_claim
from model.study.claims.reading import Data
from model.study.identification.candidate import Space

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rows = NDArray[np.int64]
_WORST = -1.0  # margin of a claim for which there is nothing to measure
_REQUIRED = 3.0  # weight of a required claim, in claims


@dataclass(frozen=True)
class Judge:
    """The claims that count in a score. Margins have shape (..., claims) everywhere.

    Attributes:
        claims: those that something can be measured by.
        counted: which of them count, shape (claims,).
        goal: margin from which more of it is worth little.
        required: which must hold, as claims of their own that do not count, shape (claims,).
        weights: of the claims in a score, shape (claims,).
    """

    claims: tuple[Claim, ...]
    counted: Flags
    goal: float
    required: Flags
    weights: Array

    @property
    def ids(self) -> tuple[str, ...]:
        """The claims' names."""
        return tuple(claim.id for claim in self.claims)

    def counting(self, counted: Flags) -> "Judge":
        """The same with only some of the claims that count, and none required."""
        none = np.zeros_like(self.required)
        return replace(self, counted=self.counted & counted, required=none)

    def weighing(self, names: Collection[str], weight: float) -> "Judge":
        """The same with another weight of the claims of these names."""
        chosen = np.isin(np.array(self.ids), list(names))
        return replace(self, weights=np.where(chosen, weight, self.weights))

    def halves(self, seed: int, split: int) -> tuple[Flags, Flags]:
        """Split the claims that count into two halves, drawn; each of shape (claims,).

        The claims of a figure are dealt out to both, so that either half asks something of every
        operating point.
        """
        drawn = np.random.default_rng([seed, 2, split]).permutation(np.flatnonzero(self.counted))
        dealt = sorted(drawn.tolist(), key=lambda row: self.claims[row].figures[0])
        first = np.isin(np.arange(self.counted.size), dealt[::2])
        return first, self.counted & ~first

    # --- Of one candidate ------------------------------------------------------------------------

    def margins(self, datasets: Mapping[str, xr.Dataset]) -> Array:
        """Return the margin of each claim, NaN where there is no dataset to measure it by."""
        data = Data(datasets)
        return np.array([judge_claim(claim, data).margin for claim in self.claims])

    def judged(self, datasets: Mapping[str, xr.Dataset]) -> tuple[Array, int]:
        """Return the margins, the worst where unknown, and how many counted are contradicted."""
        data = Data(datasets)
        findings = [judge_claim(claim, data) for claim in self.claims]
        margins = np.array([finding.margin for finding in findings])
        against = np.array([finding.verdict == "contradicted" for finding in findings])
        return np.where(np.isnan(margins), _WORST, margins), int((against & self.counted).sum())

    # --- Of margins ------------------------------------------------------------------------------

    def worth(self, margins: Array) -> Array:
        """Return what each claim adds to the score; 0 where it neither counts nor is required.

        A margin is worth itself over the goal up to 1, and a tenth of the rest beyond it, so that
        one claim shown clearly does not make up for another not shown.
        """
        short = np.minimum(margins, self.goal) / self.goal
        worth = np.where(margins < 0.0, 2.0 * margins, short)
        worth = worth + 0.1 * np.maximum(margins - self.goal, 0.0)
        return np.asarray(worth * self.weights * (self.counted + _REQUIRED * self.required))

    def score(self, margins: Array) -> Array:
        """Return the sum of what the claims are worth; the greater the better."""
        return np.asarray(self.worth(margins).sum(axis=-1))

    def reproduced(self, margins: Array) -> Rows:
        """Return how many of the claims that count are reproduced."""
        return np.asarray((margins[..., self.counted] > 0.0).sum(axis=-1))

    def lacking(self, margins: Array) -> list[str]:
        """Return the claims that count and are not reproduced; margins of shape (claims,)."""
        return np.array(self.ids)[self.counted & ~(margins > 0.0)].tolist()

    def holds(self, margins: Array) -> Flags:
        """Return whether all that is required holds."""
        return np.asarray((margins[..., self.required] > 0.0).all(axis=-1))

    # --- Of several candidates, margins of shape (m, claims) -------------------------------------

    def order(self, margins: Array, contradicted: Sequence[int] | None = None) -> Rows:
        """Return all rows, the best candidate first.

        Best is what shows all that is required, then what reproduces most, then what has the fewest
        claims ``contradicted``, where that is known, then the greatest score.
        """
        keys = [-self.score(margins), -self.reproduced(margins), ~self.holds(margins)]
        if contradicted is not None:
            keys.insert(1, np.asarray(contradicted))
        return np.asarray(np.lexsort(keys))

    def contenders(self, structures: Array, margins: Array, count: int) -> Rows:
        """Return the rows of the ``count`` greatest scores, those that show what is required first.

        Of rows with the same structure the best only; ``structures`` has shape (m, 7).
        """
        order = np.lexsort([-self.score(margins), ~self.holds(margins)])
        _, first = np.unique(structures[order], axis=0, return_index=True)
        return np.asarray(order[np.sort(first)[:count]])

    def highest(self, margins: Array, count: int) -> Rows:
        """Return the rows of the ``count`` greatest scores, the greatest first."""
        return np.argsort(-self.score(margins), kind="stable")[:count]


def judge_of(space: Space) -> Judge:
    """Return the judge of a search: every claim that its figures can measure; not all count.

    A claim required of a figure comes after the others, as a claim on that figure alone.
    """
    computed = set(space.dimensions)
    claims = [each for each in CLAIMS if not computed.isdisjoint(each.figures)]
    counted = [claim.id not in space.law.set_aside for claim in claims]
    required = [
        replace(claim, id=f"{claim.id} (Fig. {int(figure[3:])})", figures=(figure,))
        for figure, names in space.law.required.items()
        for claim in claims
        if claim.id in names
    ]
    return Judge(
        claims=(*claims, *required),
        counted=np.array(counted + [False] * len(required)),
        goal=space.law.goal,
        required=np.array([False] * len(claims) + [True] * len(required)),
        weights=np.ones(len(claims) + len(required)),
    )


def reproduced_shares(margins: Array) -> Array:
    """Return the share of candidates that reproduce each claim, shape (claims,), of those known.

    Args:
        margins: shape (..., claims), NaN where unknown; the share is NaN where all are.
    """
    rows = margins.reshape(-1, margins.shape[-1])
    known = np.isfinite(rows).sum(axis=0)
    held = (np.nan_to_num(rows, nan=_WORST) > 0.0).sum(axis=0)
    return np.divide(held, known, out=np.full(known.size, math.nan), where=known > 0)
