"""One entry for every run: each parameter set is run twice, and the difference is its error.

The result is that of the run at the tolerance asked for. A second run at ``COARSER`` times that
tolerance tells how far the alignment time may still move; where the two end differently, or far
apart, the point is sensitive: digits of its alignment time would be false.
"""

from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple as _to_fixed_tuple

from model.physics.compiled import kernel
from model.physics.parameters import Constants
from model.solver.loop import TRACK_COLUMNS, Control, integrate

COARSER = 16.0
SENSITIVE = 1e-4  # difference of the two alignment times above which a point is sensitive
RESOLUTION = 1e-14  # relative rounding of an alignment time

_CONSTANTS = len(Constants._fields)
to_fixed_tuple: Any = _to_fixed_tuple  # an intrinsic: its first argument is numba's own


class Record(NamedTuple):
    """A run as a row of numbers; the names are those of ``Ending`` and ``Alignments``."""

    outcome: float
    reason: float
    time: float
    tau_align: float
    tau_error: float
    tau_corners_inside: float
    sensitive: float
    tilt_at_alignment: float
    tilt_max: float
    separations: float
    contact_force_max: float
    sticking_share: float
    rhs_evaluations: float
    steps: float
    switches: float
    period: float
    tracked: float


COLUMNS = Record._fields
NO_TRACK = np.empty((0, TRACK_COLUMNS))


@kernel
def _run(row, declared, method, control, track):
    return integrate(Constants(*to_fixed_tuple(row, _CONSTANTS)), declared, method, control, track)


@kernel
def run_rows(rows, declared, method, control, track, no_track, out):
    """Run every row of ``rows``, shape (n, constants), into ``out``, shape (n, len(COLUMNS)).

    ``track`` receives the trajectory of the (last) row; ``no_track`` has no rows.
    """
    coarse_control = Control(
        COARSER * control.tolerance, control.horizon, control.max_evaluations, control.may_settle
    )
    for i in range(rows.shape[0]):
        coarse = _run(rows[i], declared, method, coarse_control, no_track)
        fine = _run(rows[i], declared, method, control, track)
        difference = abs(fine.tau_align - coarse.tau_align)
        error = nan
        if not isnan(fine.tau_align) and not isnan(coarse.tau_align):
            error = difference + control.tolerance + RESOLUTION * (1.0 + fine.tau_align)
        sensitive = fine.outcome != coarse.outcome or difference > SENSITIVE
        evaluations = fine.evaluations + coarse.evaluations
        out[i] = Record(
            float(fine.outcome),
            float(fine.reason),
            fine.time,
            fine.tau_align,
            error,
            fine.tau_corners_inside,
            1.0 if sensitive else 0.0,
            fine.tilt_at_alignment,
            fine.tilt_max,
            float(fine.separations),
            fine.contact_force_max,
            fine.sticking_share,
            float(evaluations),
            float(fine.steps),
            float(fine.switches),
            float(fine.period),
            float(fine.tracked),
        )
