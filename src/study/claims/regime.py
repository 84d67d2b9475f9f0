"""The regime of a figure: whether vibration aligns the part, and at what tilt.

Numbers that are also claims are computed by the claims' checks.
"""

from typing import NamedTuple

import numpy as np

from model.events.outcomes import Unvibrated
from study.claims.areas import least_share
from study.claims.claims import CLAIMS
from study.claims.data import Tables
from study.claims.statistics import NAN, median, share

_CHECKS = {claim.id: claim.check for claim in CLAIMS if claim.check}


class Regime(NamedTuple):
    """Numbers of one figure.

    All but ``aligned`` are taken over the points that align, NaN without any.

    Attributes:
        aligned: share of the points that align, for the curve where it is least.
        static: share whose unvibrated control aligns as well.
        not_resting: share whose unvibrated control does not rest on A1 (M4b).
        tilt: median magnitude of the tilt at alignment in radians.
        tilt_largest: largest magnitude of the tilt at alignment in radians.
        corners: share that meets the four corner conditions (C8c).
        lift_offs: share that lifts off before it aligns (N05 to N14).
        first_period: share that aligns within the first period of the vibration (M10).
        creeps: share that aligns later than that, and does not lift off before.
    """

    aligned: float
    static: float
    not_resting: float
    tilt: float
    tilt_largest: float
    corners: float
    lift_offs: float
    first_period: float
    creeps: float


def regime_of(tables: Tables, figure: str) -> Regime:
    """Return the regime of a figure.

    Raises:
        MissingDataError: no dataset, or one without unvibrated controls.
    """

    def number(claim: str) -> float:
        return _CHECKS[claim].numbers(tables, [figure])[""]

    aligned, unvibrated, tilt, hops, in_first = (
        tables.values(figure, text)
        for text in ("aligned", "unvibrated", "tilt_at_alignment", "separations > 0",
                     "tau * frequency < 6.283185")
    )  # fmt: skip
    tilts = np.abs(tilt[aligned])
    return Regime(
        aligned=least_share(aligned, tables.values(figure, "curve")),
        static=share(unvibrated[aligned] == Unvibrated.ALIGNS),
        not_resting=1.0 - number("M4b"),
        tilt=median(tilts),
        tilt_largest=float(tilts.max()) if tilts.size else NAN,
        corners=number("C8c"),
        lift_offs=1.0 - number(f"N{figure[3:]}"),
        first_period=share(in_first[aligned]),
        creeps=share(~(hops | in_first)[aligned]),
    )
