"""The ensemble's bands: quantiles of the admissible sets' durations along each curve.

A set has a structure and operating points of its own, so that a band says how well the paper's
claims fix a curve. Fig. 10 is swept over the inertia in units of the bare part's, since every set
has a bare part of its own.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from model.study.identification.band_table import Band
from model.study.identification.candidate import Space, bare_inertia
from model.study.identification.evaluate import datasets_of

LEAST_SHARE = 0.5  # of the sets must align, else a band has no durations
_AT_ONCE = 20  # sets computed together
_QUANTILES = (0.05, 0.5, 0.95)

Array = NDArray[np.float64]


def bands_of(space: Space, points: Array) -> dict[str, tuple[Band, ...]]:
    """Return the bands of the figures of a space, which have curves, on the search's grids.

    Args:
        space: of the points.
        points: of the ensemble, shape (m, n).
    """
    taus: dict[str, list[Array]] = {name: [] for name in space.figures}
    for start in range(0, len(points), _AT_ONCE):
        for made in datasets_of(space, points[start : start + _AT_ONCE], space.figures):
            for name in space.figures:
                taus[name].append(made[name]["tau_align"].values)
    found = {}
    for name in space.figures:
        family, swept = space.sweep(points[0], name).dimensions
        x = np.array(swept.values)
        if swept.parameter == "inertia":
            x = x / bare_inertia(space.structure(points[0]))
        found[name] = of_durations(family.values, x, np.array(taus[name]))
    return found


def of_durations(values: Sequence[float], x: Array, taus: Array) -> tuple[Band, ...]:
    """Return the bands of one figure.

    Args:
        values: of the family's parameter.
        x: of the swept one, shape (n,).
        taus: durations, shape (sets, curves, n), NaN where a part does not align.
    """
    aligned = np.isfinite(taus).mean(axis=0)
    return tuple(
        Band(at, x, aligned[i], *_quantiles(taus[:, i], aligned[i])) for i, at in enumerate(values)
    )


def _quantiles(taus: Array, aligned: Array) -> Array:
    """Quantiles over the sets, shape (3, n), of durations, shape (sets, n)."""
    found = np.full((len(_QUANTILES), taus.shape[1]), np.nan)
    for column in np.flatnonzero(aligned >= LEAST_SHARE):
        known = taus[np.isfinite(taus[:, column]), column]
        found[:, column] = np.quantile(known, _QUANTILES)
    return found
