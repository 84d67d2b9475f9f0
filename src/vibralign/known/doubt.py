"""Doubt of a verdict: what decides it, and what knowing an unknown would be worth.

All is computed from sets of the unknowns and their verdicts, by no further run, and holds for
correlated sets as well. The first-order share of an unknown is Var(E[verdict | unknown]) over the
variance of the verdict (A. Saltelli and others, Global Sensitivity Analysis, 2008, sect. 1.2.8), by
the means in classes of equal size, less what their scatter adds; its error is the scatter between
random halves of the sets. A measurement to ``PRECISION`` of the range takes away the mutual
information between its reading and the verdict.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibralign.device.unknown import Range

PRECISION = 0.1  # of its range, to which an unknown is measured: the width of what is left
CLASSES = 16  # of an unknown, for its first-order share
HALVES = 100  # of the sets, for the error of a share
QUANTILE = 1.645  # of an interval of 90 % confidence
_FEWEST = 0.04  # share of the sets by which a border is stated

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Unknown(NamedTuple):
    """Part of an unknown in the verdict.

    Attributes:
        name: of the quantity.
        share: first-order share of the verdict's variance, NaN without variance.
        low, high: interval of the share, of 90 % confidence.
        worth: share of the doubt that goes if it is measured to ``PRECISION`` of its range.
        borders: "below" or "above" by a value in SI units: (side, value, verdict), where the
            verdict is the same whatever the other unknowns are.
    """

    name: str
    share: float
    low: float
    high: float
    worth: float
    borders: tuple[tuple[str, float, bool], ...] = ()


def entropy(share: ArrayLike) -> Floats:
    """Return the entropy in bits of a verdict that holds with this probability."""
    p = np.clip(np.asarray(share, dtype=float), 1e-12, 1.0 - 1e-12)
    found: Floats = -(p * np.log2(p) + (1.0 - p) * np.log2(1.0 - p))
    return np.where(found < 1e-9, 0.0, found)


def unknowns_of(
    ranges: Mapping[str, Range], sets: Mapping[str, Floats], verdict: Bools
) -> tuple[Unknown, ...]:
    """Return the part of each unknown in the verdicts on sets, the one that decides most first."""
    rng, found = np.random.default_rng(0), []
    half = verdict.size // 2
    rows = [rng.permutation(verdict.size)[:half] for _ in range(HALVES)]
    for name, each in ranges.items():
        x = each.share(sets[name])
        if verdict.all() or not verdict.any():
            found.append(Unknown(name, np.nan, np.nan, np.nan, 0.0))
            continue
        own = max(_first_order(x, verdict), 0.0)
        error = QUANTILE * float(np.nanstd([_first_order(x[some], verdict[some]) for some in rows]))
        own, low, high = np.clip([own, own - error, own + error], 0.0, 1.0).tolist()
        worth = _worth(x, verdict)
        borders = _borders(sets[name], verdict)
        found.append(Unknown(name, own, low, high, worth, borders))
    return tuple(sorted(found, key=lambda each: -np.nan_to_num(each.share)))


def _first_order(x: Floats, verdict: Bools) -> float:
    count = max(2, min(CLASSES, verdict.size // 4))
    classes = np.array_split(verdict[np.argsort(x, kind="stable")].astype(float), count)
    variance = float(verdict.astype(float).var())
    if variance == 0.0:
        return np.nan
    between = float(np.var([each.mean() for each in classes]))
    scatter = np.mean([each.var() / max(each.size - 1, 1) for each in classes])
    return float((between - scatter) / variance)


def _worth(x: Floats, verdict: Bools) -> float:
    """Return the share of the doubt that goes if x is measured to ``PRECISION``."""
    near = (np.abs(x[:, None] - x) <= 0.5 * PRECISION).astype(float)
    return float(1.0 - entropy(near @ verdict / near.sum(axis=1)).mean() / entropy(verdict.mean()))


def _borders(x: Floats, verdict: Bools) -> tuple[tuple[str, float, bool], ...]:
    """Return up to which value from either end all sets have one verdict."""
    found = []
    for side, order in (("below", np.argsort(x)), ("above", np.argsort(-x))):
        ordered = verdict[order]
        alike = int(np.argmax(ordered != ordered[0]))  # of a verdict that differs somewhere
        if alike >= max(_FEWEST * x.size, 8):
            found.append((side, float(x[order[alike]]), bool(ordered[0])))
    return tuple(found)
