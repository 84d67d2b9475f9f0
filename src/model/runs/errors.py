"""Every parameter set is run twice, and the difference is its error.

The result is that of the run at the tolerance asked for. A second run, at ``COARSER`` times that
tolerance and from a start displaced in x(0) by the tolerance, tells how far the alignment time may
still move. Where the two end differently, or far apart, or agree less closely than the tolerance
promises, the set is run again at a smaller tolerance; so is one whose gap between part and slot is
below the tolerance, where the two may agree and both be wrong. What the first two tell, times the
ratio of the tolerances, is believed to a quarter: the others may agree by chance. A set is
sensitive if the displaced start, then run as accurately as that, still ends elsewhere: digits of
its alignment time would be false. A part that starts nearly flat is sensitive, too, if it ends
elsewhere when it is tilted by ``TILTED`` more: no device has a tilt so exact, but one decides
whether such a part stands on its edge or on its corner, or touches the base at all.

A part that hops or sticks its own way in each of the two runs, until both reach the horizon, may
well align at another tolerance, by chance. Its reason is then ``CHAOTIC``.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.engines.record import Ending
from model.events.outcomes import Outcome, Reason
from model.events.table import FLAT
from model.physics.parameters import Constants

COARSER = 16.0
SENSITIVE = 1e-4  # difference of two alignment times, or shares, above which they are not the same
SHARPER = 1e3  # tolerance over that at which sets are run again whose two runs part
PROMISED = 100.0  # largest error, over the tolerance, that is not run again
FINEST = 1e-14  # smallest tolerance
RESOLUTION = 1e-14  # relative rounding of an alignment time

Array = NDArray[np.float64]
Run = Callable[[Array, Array], Array]
"""(rows, tolerances) to endings; shapes (n, constants), (n,) and (n, len(Ending._fields))."""

NEARLY_FLAT = 1e-6  # a tilt at the start below which a part is nearly flat
TILTED = 10.0 * FLAT  # by how much its neighbour is tilted further

_MISALIGNMENT, _TILT, _SLOT, _PART, _FREQUENCY = (
    Constants._fields.index(name)
    for name in ("misalignment", "initial_tilt", "slot_half_width", "half_width", "frequency")
)
_OUTCOME, _REASON, _TIME, _TAU, _SEPARATIONS, _STICKING, _EVALUATIONS, _PERIOD = (
    Ending._fields.index(name)
    for name in (
        "outcome", "reason", "time", "tau_align", "separations", "sticking_share",
        "rhs_evaluations", "period",
    )
)  # fmt: skip
_SAFETY = 4.0


class Estimate(NamedTuple):
    """What the runs of each parameter set tell; arrays of shape (n,), and ``endings`` of the finer.

    ``tau_error`` is NaN where either of the two does not align; ``tolerance`` is that of the finer.
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
    """Run every row, shape (n, constants), twice or, where that is not enough, three times more."""
    first = _compare(run, rows, np.full(len(rows), tolerance))
    imprecise = first.tau_error > PROMISED * tolerance
    again = first.sensitive | imprecise
    if not again.any() or tolerance <= FINEST:
        return first
    reduced, least = np.full(len(rows), tolerance / SHARPER), np.zeros(len(rows))
    few = imprecise & ~first.sensitive
    reduced[few] = tolerance * PROMISED * tolerance / (_SAFETY * first.tau_error[few])
    reduced = np.maximum(reduced, FINEST)
    # Of these the first two runs tell what to expect, should the others agree by chance.
    least[few] = first.tau_error[few] * reduced[few] / tolerance / _SAFETY
    second = _compare(run, rows[again], reduced[again], tolerance)
    np.maximum(second.tau_error, least[again], out=second.tau_error)
    evaluations = first.rhs_evaluations[again] + second.rhs_evaluations
    for kept, renewed in zip(first, second, strict=True):
        kept[again] = renewed
    first.rhs_evaluations[again] = evaluations
    return first


def _displaced(rows: Array, which: int, by: Array | float) -> Array:
    displaced = rows.copy()
    displaced[:, which] += by
    return displaced


def end_otherwise(
    outcome: NDArray[Any], other: NDArray[Any], alike: NDArray[np.bool_] | bool
) -> NDArray[np.bool_]:
    """Which runs have another outcome than their neighbours; arrays of shape (n,).

    A motion that repeats itself may settle later, or not before the horizon, at a smaller tolerance
    or by a tilt: that is the same ending if the motions are ``alike``.
    """
    go_on = (Outcome.SETTLED, Outcome.HORIZON_REACHED)
    same = np.isin(outcome, go_on) & np.isin(other, go_on) & alike
    found: NDArray[np.bool_] = (outcome != other) & ~same
    return found


def _hop_alike(rows: Array, endings: Array, others: Array) -> NDArray[np.bool_]:
    """Whether a run and its neighbour leave the base as often, each as long as it goes on.

    What goes on longer than a motion that has settled repeats it: it leaves the base so many times
    more for every repetition, a whole number of them.
    """
    more, longer = (others - endings)[:, [_SEPARATIONS, _TIME]].T
    frequency = rows[:, _FREQUENCY]
    excitation = 2.0 * np.pi / np.where(frequency > 0.0, frequency, 1.0)
    repetition = np.maximum(endings[:, _PERIOD], others[:, _PERIOD]) * excitation
    with np.errstate(divide="ignore", invalid="ignore"):
        repetitions = longer / repetition
        each = np.rint(more / repetitions)
        repeats: NDArray[np.bool_] = (repetition > 0.0) & (
            np.abs(more - each * repetitions) <= each
        )
    return (more == 0.0) | repeats


def _end(endings: Array) -> Array:
    """When runs aligned or left the scene; NaN for others, which end when it is not their own."""
    left = endings[:, _OUTCOME] == Outcome.LEFT_SCENE
    return np.where(left, endings[:, _TIME], endings[:, _TAU])


def _are_chaotic(endings: Array, others: Array) -> NDArray[np.bool_]:
    """Which runs reach the horizon, as their neighbours do, on another course."""
    moving = (endings[:, _OUTCOME] == Outcome.HORIZON_REACHED) & (
        others[:, _OUTCOME] == Outcome.HORIZON_REACHED
    )
    hops = endings[:, _SEPARATIONS] != others[:, _SEPARATIONS]
    return moving & (hops | (np.abs(endings[:, _STICKING] - others[:, _STICKING]) > SENSITIVE))


def _compare(run: Run, rows: Array, tolerance: Array, neighbour: float | None = None) -> Estimate:
    """Two runs of each row; a third one, from a start displaced by ``neighbour``, for the flag.

    Without it the second run's own displacement decides. One more of what starts nearly flat.
    """
    every = np.arange(len(rows))
    flat = np.flatnonzero(np.abs(rows[:, _TILT]) < NEARLY_FLAT)
    others = [(every, _displaced(rows, _MISALIGNMENT, tolerance))]
    if neighbour is not None:
        others.append((every, _displaced(rows, _MISALIGNMENT, neighbour)))
    others.append((flat, _displaced(rows[flat], _TILT, TILTED)))
    starts = np.concatenate([rows, *(displaced for _, displaced in others)])
    tolerances = [tolerance, *(COARSER * tolerance[which] for which, _ in others)]
    ends = np.cumsum([each.size for each in tolerances])
    fine, *ran = np.split(run(starts, np.concatenate(tolerances)), ends[:-1])

    spent = fine[:, _EVALUATIONS].copy()
    sensitive = rows[:, _SLOT] - rows[:, _PART] < tolerance
    for (which, _), other in zip(others, ran, strict=True):
        mine = fine[which]
        alike = _hop_alike(rows[which], mine, other) | (which is flat)
        apart = np.abs(_end(mine) - _end(other)) > SENSITIVE
        sensitive[which] |= end_otherwise(mine[:, _OUTCOME], other[:, _OUTCOME], alike) | apart
        spent[which] += other[:, _EVALUATIONS]
    fine[_are_chaotic(fine, ran[0]), _REASON] = Reason.CHAOTIC
    difference = np.abs(fine[:, _TAU] - ran[0][:, _TAU])
    return Estimate(
        endings=fine,
        tau_error=difference + tolerance + RESOLUTION * (1.0 + fine[:, _TAU]),
        sensitive=sensitive,
        rhs_evaluations=spent,
        tolerance=tolerance,
    )
