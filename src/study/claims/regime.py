"""The regime of a figure: whether vibration aligns the part, at what tilt, and if it hops."""

from typing import NamedTuple

import numpy as np

from model.events.outcomes import Unvibrated
from study.claims.data import Figure
from study.claims.measures import NAN, median, share


class Regime(NamedTuple):
    """Numbers of one figure.

    All but the first three are taken over the points that align, NaN without any.

    Attributes:
        aligned: share of the points that align.
        aligned_least: the same share, for the curve where it is least; of a map over all.
        aligned_shown: the same share of the points up to f0 = 10, where the paper's text ends.
        static: share whose unvibrated control aligns as well.
        not_resting: share whose unvibrated control does not rest on A1, more tilted than it starts.
        tilt: median magnitude of the tilt at alignment in radians.
        tilt_largest: largest magnitude of the tilt at alignment in radians.
        corners: share that meets the four corner conditions.
        lift_offs: share that lifts off before it aligns.
        first_period: share that aligns within the first period of the vibration.
        creeps: share that aligns later than that, and does not lift off before.
        creeps_static: share of those that creep whose unvibrated control aligns as well.
    """

    aligned: float
    aligned_least: float
    aligned_shown: float
    static: float
    not_resting: float
    tilt: float
    tilt_largest: float
    corners: float
    lift_offs: float
    first_period: float
    creeps: float
    creeps_static: float


def regime_of(figure: Figure) -> Regime:
    """Return the regime of a figure.

    Raises:
        MissingDataError: the dataset lacks unvibrated controls.
    """
    runs = figure.whole
    aligned = runs.aligned
    of = {name: runs.result(name)[aligned] for name in ("tilt_at_alignment", "separations",
          "unvibrated", "unvibrated_tilt", "tau_corners_inside", "tau_align")}  # fmt: skip
    tilts, hops = np.abs(of["tilt_at_alignment"]), of["separations"] > 0
    rests = (of["unvibrated"] == Unvibrated.RESTS) & (
        of["unvibrated_tilt"] > figure.held["initial_tilt"]
    )
    in_first = of["tau_align"] * runs.result("frequency")[aligned] < 2.0 * np.pi
    creeps, static = ~(hops | in_first), of["unvibrated"] == Unvibrated.ALIGNS
    least = share(aligned) if figure.is_map else min(share(each.aligned) for each in figure.curves)
    return Regime(
        aligned=share(aligned),
        aligned_least=least,
        aligned_shown=share(aligned[runs.result("press_force") <= 10.0]),
        static=share(static),
        not_resting=share(~rests),
        tilt=median(tilts),
        tilt_largest=float(tilts.max()) if tilts.size else NAN,
        corners=share(np.isfinite(of["tau_corners_inside"])),
        lift_offs=share(hops),
        first_period=share(in_first),
        creeps=share(creeps),
        creeps_static=share(static[creeps]),
    )
