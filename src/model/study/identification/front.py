"""The front of the searches: claims shown against the regime, and the set chosen from it.

Two things are wanted, and no set has the most of both: that the figures show what the paper says,
and that it is the vibration that aligns the part, at a small tilt. The device is the set whose
worst ratio to the aims is least, of those that align over a share of every curve.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from model.study.claims.regime import Summary
from model.study.config import Aims
from model.study.identification.score import Judge

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
_LEAST_ALIGNED = 0.01  # share below which a figure counts as not aligned


@dataclass(frozen=True)
class Wanted:
    """The aims as ratios.

    Attributes:
        aims: most of each number, and the least share of corners.
        names: figures and own runs that are computed; claims on others are not asked.
        safe: margin from which a claim counts in full; a lesser one may be lost on other grids.
    """

    aims: Aims
    names: Collection[str]
    safe: float = 0.0

    def asked(self, judge: Judge) -> Flags:
        """Return which claims are asked, without those that ask what the other aims ask."""
        computed = [not set(claim.figures).isdisjoint(self.names) for claim in judge.claims]
        beside = np.isin(np.array(judge.ids), self.aims.beside)
        return np.asarray(judge.counted & ~beside & np.array(computed))

    def ratios(self, judge: Judge, margins: Array, regimes: Array) -> Array:
        """Return the ratios of sets to the aims, shape (m, 6); 1 meets an aim.

        Args:
            judge: of the margins.
            margins: shape (m, claims).
            regimes: shape (m, fields of ``Summary``).
        """
        asked = margins[:, self.asked(judge)]
        missing = (asked <= 0.0).sum(axis=-1).astype(np.float64)
        if self.safe:
            missing = np.clip(1.0 - asked / self.safe, 0.0, 1.0).sum(axis=-1)
        aims, each = self.aims, Summary(*regimes.T)
        return np.column_stack(
            [
                missing / aims.missing,
                each.not_resting / aims.not_resting,
                each.not_resting_most / aims.not_resting_most,
                each.tilt / aims.tilt,
                (1.0 - np.asarray(each.corners)) / (1.0 - aims.corners),
                aims.aligned / np.maximum(each.aligned, _LEAST_ALIGNED),
            ]
        )

    def worst(self, judge: Judge, margins: Array, regimes: Array) -> Array:
        """Return the worst ratio of each set, shape (m,); infinite without what is required.

        Required are the claims that the judge requires, and a share of every curve that aligns.
        """
        ratios = self.ratios(judge, margins, regimes).max(axis=-1)
        aligned = np.asarray(Summary(*regimes.T).aligned) >= self.aims.aligned
        return np.where(judge.holds(margins) & aligned, ratios, np.inf)


def on_front(claims: NDArray[np.int64], regimes: Array, aligned: float) -> Flags:
    """Return which sets are on the front, shape (m,).

    Of the sets that align over a share ``aligned`` of every figure no other beats them in claims,
    share not resting, and tilt.
    """
    each = Summary(*regimes.T)
    enough = np.asarray(each.aligned) >= aligned
    costs = np.array([-claims, each.not_resting, each.tilt]).T
    no_worse = (costs[:, None] <= costs[None]).all(axis=-1)
    better = (costs[:, None] < costs[None]).any(axis=-1)
    return np.asarray(enough & ~(no_worse & better & enough[:, None]).any(axis=0))


def promising(ratios: Array) -> NDArray[np.int64]:
    """Return rows of ratios, shape (m, aims), by the worst but one, the least first.

    The one aim that a set misses by most may be missed in a single figure, and mended there.
    """
    return np.argsort(np.sort(ratios, axis=-1)[:, -2], kind="stable")
