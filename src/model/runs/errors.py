"""Every parameter set is run twice, and the difference is its error.

The result is that of the run at the tolerance asked for. A second run, at ``COARSER`` times that
tolerance and from a start displaced in x(0) by the tolerance, tells how far the alignment time may
still move. Where the two end differently, or far apart, the point is sensitive: digits of its
alignment time would be false. Where they agree but less closely than the tolerance promises, both
are run again at a tolerance smaller in proportion.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Constants
from model.solver.record import Ending

COARSER = 16.0
SENSITIVE = 1e-4  # difference of the two alignment times above which a point is sensitive
PROMISED = 100.0  # largest error, over the tolerance, that is not run again
FINEST = 1e-14  # smallest tolerance
RESOLUTION = 1e-14  # relative rounding of an alignment time

Array = NDArray[np.float64]
Run = Callable[[Array, Array], Array]
"""(rows, tolerances) to endings; shapes (n, constants), (n,) and (n, len(Ending._fields))."""

_MISALIGNMENT = Constants._fields.index("misalignment")
_SAFETY = 4.0


class Estimate(NamedTuple):
    """What two runs of each parameter set tell; arrays of shape (n,), and ``endings`` of the finer.

    ``tau_error`` is NaN where either run does not align; ``tolerance`` is that of the finer run.
    """

    endings: Array
    tau_error: Array
    sensitive: NDArray[np.bool_]
    rhs_evaluations: Array
    tolerance: Array

    def column(self, name: str) -> Array:
        """A field of ``Ending``, shape (n,)."""
        return self.endings[:, Ending._fields.index(name)]


def estimate(run: Run, rows: Array, tolerance: float) -> Estimate:
    """Run every row, shape (n, constants), twice or, where that is not enough, four times."""
    first = _compare(run, rows, np.full(len(rows), tolerance))
    again = ~first.sensitive & (first.tau_error > PROMISED * tolerance)
    if not again.any() or tolerance <= FINEST:
        return first
    reduced = tolerance * PROMISED * tolerance / (_SAFETY * first.tau_error[again])
    second = _compare(run, rows[again], np.maximum(reduced, FINEST))
    evaluations = first.rhs_evaluations[again] + second.rhs_evaluations
    for kept, renewed in zip(first, second, strict=True):
        kept[again] = renewed
    first.rhs_evaluations[again] = evaluations
    return first


def _compare(run: Run, rows: Array, tolerance: Array) -> Estimate:
    displaced = rows.copy()
    displaced[:, _MISALIGNMENT] += tolerance
    both = run(np.concatenate([rows, displaced]), np.concatenate([tolerance, COARSER * tolerance]))
    fine, coarse = np.split(both, 2)
    evaluations = Ending._fields.index("rhs_evaluations")
    tau, coarse_tau = (each[:, Ending._fields.index("tau_align")] for each in (fine, coarse))
    difference = np.abs(tau - coarse_tau)
    outcome = Ending._fields.index("outcome")
    return Estimate(
        endings=fine,
        tau_error=difference + tolerance + RESOLUTION * (1.0 + tau),
        sensitive=(fine[:, outcome] != coarse[:, outcome]) | (difference > SENSITIVE),
        rhs_evaluations=fine[:, evaluations] + coarse[:, evaluations],
        tolerance=tolerance,
    )
