"""Compare figures on several bases: their distance from the stiffest, and their claims' verdicts.

A module apart from ``contact_stiffness``, so that a claim's new threshold computes nothing anew.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.study.claims import Claim, Finding, judge
from model.study.contact_stiffness import RATIO, VARIATION

SAME = 0.05  # smallest visible difference: relative, of a duration; of all runs, as a share


@dataclass(frozen=True)
class OnBase:
    """A figure on one base, compared to the same figure on the stiffest.

    Attributes:
        stiffness: k_a.
        ratio: damping over the critical.
        aligned: share of the runs that align.
        in_contact: share of the aligning runs without lift-off, NaN without any.
        other_end: share of the runs that align on one of the two bases only.
        other_time: share of the runs aligning on both whose duration differs by more than ``SAME``.
        apart: median relative difference of these durations, NaN without any.
    """

    stiffness: float
    ratio: float
    aligned: float
    in_contact: float
    other_end: float
    other_time: float
    apart: float

    @property
    def looks_the_same(self) -> bool:
        """True if at most one run in twenty differs visibly."""
        return self.other_end <= SAME and not self.other_time > SAME


def on_bases(dataset: xr.Dataset) -> list[OnBase]:
    """Compare a figure on each base to the stiffest; points sensitive on either are left out."""
    limit = stiffest(dataset)
    return [_compared(dataset, i, limit) for i in range(dataset.sizes[VARIATION])]


def stiffest(dataset: xr.Dataset) -> int:
    """Return the index of the stiffest base with the device's damping ratio."""
    own = dataset[RATIO].values == dataset[RATIO].values[0]
    return int(np.argmax(np.where(own, dataset["contact_stiffness"].values, 0.0)))


def _compared(dataset: xr.Dataset, place: int, limit: int) -> OnBase:
    def of(name: str) -> tuple[NDArray[Any], NDArray[Any]]:
        values = dataset[name].values
        return values[place].ravel(), values[limit].ravel()

    sensitive = of("sensitive")
    regular = (sensitive[0] == 0) & (sensitive[1] == 0)
    here, there = (each[regular] == 0 for each in of("outcome"))
    separations = of("separations")[0][regular][here]
    both = here & there
    tau, tau_there = (each[regular][both] for each in of("tau_align"))
    apart = np.abs(tau - tau_there) / tau_there
    return OnBase(
        stiffness=float(dataset["contact_stiffness"].values[place]),
        ratio=float(dataset[RATIO].values[place]),
        aligned=_share(here),
        in_contact=_share(separations == 0),
        other_end=_share(here != there),
        other_time=_share(apart > SAME),
        apart=float(np.median(apart)) if apart.size else math.nan,
    )


def _share(flags: NDArray[np.bool_]) -> float:
    return float(flags.mean()) if flags.size else math.nan


class ClaimOnBases(NamedTuple):
    """A claim and its finding on each base, the device's own first."""

    claim: Claim
    findings: tuple[Finding, ...]


def claims_on_bases(datasets: Mapping[str, xr.Dataset]) -> list[ClaimOnBases]:
    """Judge every claim that these figures can decide, on each base."""
    count = min(dataset.sizes[VARIATION] for dataset in datasets.values())
    judged = [
        judge({name: dataset.isel({VARIATION: i}) for name, dataset in datasets.items()})
        for i in range(count)
    ]
    by_claim = zip(*judged, strict=True)
    rows = [ClaimOnBases(row[0][0], tuple(each for _, each in row)) for row in by_claim]
    return [row for row in rows if row.findings[0].verdict != "not checkable"]


def settled_from(rows: Sequence[OnBase]) -> float:
    """Return the least stiffness beyond which no base differs visibly, at the device's damping.

    Infinite if the second stiffest base differs.
    """
    own = sorted((row for row in rows if row.ratio == rows[0].ratio), key=lambda row: row.stiffness)
    settled = math.inf
    for row in reversed(own[:-1]):
        if not row.looks_the_same:
            break
        settled = row.stiffness
    return settled
