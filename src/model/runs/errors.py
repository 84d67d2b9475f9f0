"""Error estimates: every parameter set is run at least twice.

The result is taken from the run at the requested tolerance. A second run, at ``COARSER`` times that
tolerance and with x(0) displaced by the tolerance, estimates the error of the alignment time. A set
is run again at a smaller tolerance if the two outcomes differ, if the times are far apart or differ
by more than the tolerance promises, or if the gap between part and slot is below the tolerance, so
that both runs may be wrong in the same way. The error estimate of the first two runs, times the
ratio of the tolerances and divided by 4, is a lower bound of the final estimate: the later runs may
agree by chance.

A set is sensitive if the run with the displaced start, at the smaller tolerance, still ends with
another outcome or at another time: the digits of its alignment time would be meaningless. A set
with a nearly flat start is also sensitive if an initial tilt larger by ``TILTED`` changes its end:
no device has so exact a tilt, but the tilt decides whether such a part rests on its edge or on its
corner, or touches the base at all.

If the two runs differ in lift-offs or sticking and both reach the horizon, a run at another
tolerance may align by chance. The reason of such a set is ``CHAOTIC``: a sensitive dependence;
chaos is not tested for.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.engines.results import RunResult
from model.events.levels import FLAT
from model.events.outcomes import Outcome, Reason
from model.physics.parameters import Constants
from model.runs.engines import Array, Run

COARSER = 16.0
SENSITIVE = 1e-4  # difference of two alignment times, or shares, above which they are not the same
SHARPER = 1e3  # tolerance over that of the second runs of a set
PROMISED = 100.0  # largest error over the tolerance for which a set is not run again
FINEST = 1e-14  # smallest tolerance
RESOLUTION = 1e-14  # relative rounding of an alignment time
NEARLY_FLAT = 1e-6  # initial tilt below which a part is nearly flat
TILTED = 10.0 * FLAT  # additional tilt of its neighbour

_SAFETY = 4.0
_TANGENTIAL = 2.0  # error of such a limit over the square root of the tolerance


class Estimate(NamedTuple):
    """Results of parameter sets with their errors; arrays of shape (n,), ``results`` (n, fields).

    Attributes:
        results: fields of ``RunResult`` of the finer runs.
        tau_error: NaN where either of the two runs does not align.
        insertion_error: of the time until inserted; NaN where either of the two is not inserted.
        sensitive: True for sensitive sets; see the module.
        rhs_evaluations: right-hand-side evaluations of all runs of a set.
        tolerance: tolerance of the finer runs.
    """

    results: Array
    tau_error: Array
    insertion_error: Array
    sensitive: NDArray[np.bool_]
    rhs_evaluations: Array
    tolerance: Array

    def columns(self) -> dict[str, NDArray[Any]]:
        """Return all results by name, each of shape (n,)."""
        return {
            **RunResult(*self.results.T)._asdict(),
            "tau_error": self.tau_error,
            "insertion_error": self.insertion_error,
            "sensitive": self.sensitive,
            "rhs_evaluations": self.rhs_evaluations,
        }


def estimate(run: Run, rows: Array, tolerance: float) -> Estimate:
    """Run every row, shape (n, constants), twice, and rows with large errors three times more."""
    first = _compare(run, rows, np.full(len(rows), tolerance))
    error = np.fmax(first.tau_error, first.insertion_error)
    imprecise = error > PROMISED * tolerance
    again = first.sensitive | imprecise
    if not again.any() or tolerance <= FINEST:
        return first
    reduced, least = np.full(len(rows), tolerance / SHARPER), np.zeros(len(rows))
    few = imprecise & ~first.sensitive
    reduced[few] = tolerance * PROMISED * tolerance / (_SAFETY * error[few])
    reduced = np.maximum(reduced, FINEST)
    # Lower bound from the first two runs, in case the later ones agree by chance.
    least[few] = first.tau_error[few] * reduced[few] / tolerance / _SAFETY
    second = _compare(run, rows[again], reduced[again], tolerance)
    np.maximum(second.tau_error, least[again], out=second.tau_error)
    evaluations = first.rhs_evaluations[again] + second.rhs_evaluations
    for kept, renewed in zip(first, second, strict=True):
        kept[again] = renewed
    first.rhs_evaluations[again] = evaluations
    return first


def _displaced(rows: Array, constant: str, by: Array | float) -> Array:
    displaced = rows.copy()
    displaced[:, Constants._fields.index(constant)] += by
    return displaced


def outcomes_differ(
    outcome: NDArray[Any], other: NDArray[Any], alike: NDArray[np.bool_] | bool
) -> NDArray[np.bool_]:
    """Return a mask of the runs with another outcome than their neighbours; shapes (n,).

    At a smaller tolerance or another tilt a periodic motion may settle later, or not before the
    horizon: these outcomes count as equal if the motions are ``alike``.
    """
    periodic = (Outcome.SETTLED, Outcome.HORIZON_REACHED)
    same = np.isin(outcome, periodic) & np.isin(other, periodic) & alike
    found: NDArray[np.bool_] = (outcome != other) & ~same
    return found


def _lift_off_alike(p: Constants, run: RunResult, other: RunResult) -> NDArray[np.bool_]:
    """Return a mask of the runs that lift off as often as their neighbours, until their own ends.

    A run that lasts longer than a neighbour that has settled repeats its motion: every repetition
    adds the same whole number of lift-offs.
    """
    more, longer = other.separations - run.separations, other.time - run.time
    excitation = 2.0 * np.pi / np.where(p.frequency > 0.0, p.frequency, 1.0)
    repetition = np.maximum(run.period, other.period) * excitation
    with np.errstate(divide="ignore", invalid="ignore"):
        repetitions = longer / repetition
        each = np.rint(more / repetitions)
        repeats: NDArray[np.bool_] = (repetition > 0.0) & (
            np.abs(more - each * repetitions) <= each
        )
    found: NDArray[np.bool_] = (more == 0.0) | repeats
    return found


def _end(run: RunResult) -> Array:
    """Return the times of alignment, or of insertion, or of leaving the scene; else NaN."""
    time: Array = run.time
    ends = np.isin(run.outcome, (Outcome.LEFT_SCENE, Outcome.INSERTED))
    return np.where(ends, time, run.tau_align)


def _are_chaotic(run: RunResult, other: RunResult, tolerance: Array) -> NDArray[np.bool_]:
    """Return a mask of the runs that reach the horizon by another motion than their neighbours.

    ``tolerance`` is that of the finer runs. A friction limit that is met tangentially is met to the
    square root of the neighbour's tolerance only.
    """
    at_horizon = (run.outcome == Outcome.HORIZON_REACHED) & (
        other.outcome == Outcome.HORIZON_REACHED
    )
    resolved = np.fmax(SENSITIVE, _TANGENTIAL * np.sqrt(COARSER * tolerance))
    differ = np.abs(run.sticking_share - other.sticking_share) > resolved
    found: NDArray[np.bool_] = at_horizon & ((run.separations != other.separations) | differ)
    return found


def _difference(time: Array, other: Array, tolerance: Array) -> Array:
    """Return the error of a time by its difference from another run."""
    found: Array = np.abs(time - other) + tolerance + RESOLUTION * (1.0 + time)
    return found


def _compare(run: Run, rows: Array, tolerance: Array, neighbour: float | None = None) -> Estimate:
    """Run each row twice, and a third time, for the flag, from a start displaced by ``neighbour``.

    Without ``neighbour`` the second run decides the flag. Rows that start nearly flat are run once
    more.
    """
    p = Constants(*rows.T)
    every = np.arange(len(rows))
    flat = np.flatnonzero(np.abs(p.initial_tilt) < NEARLY_FLAT)
    others = [(every, _displaced(rows, "misalignment", tolerance))]
    if neighbour is not None:
        others.append((every, _displaced(rows, "misalignment", neighbour)))
    others.append((flat, _displaced(rows[flat], "initial_tilt", TILTED)))
    starts = np.concatenate([rows, *(displaced for _, displaced in others)])
    tolerances = [tolerance, *(COARSER * tolerance[which] for which, _ in others)]
    ends = np.cumsum([each.size for each in tolerances])
    results, *ran = np.split(run(starts, np.concatenate(tolerances)), ends[:-1])

    fine, coarse = RunResult(*results.T), RunResult(*ran[0].T)
    spent = fine.rhs_evaluations.copy()
    sensitive = p.slot_half_width - p.half_width < tolerance
    for (which, _), displaced in zip(others, ran, strict=True):
        mine, other = RunResult(*results[which].T), RunResult(*displaced.T)
        alike = _lift_off_alike(Constants(*rows[which].T), mine, other) | (which is flat)
        apart = np.abs(_end(mine) - _end(other)) > SENSITIVE
        sensitive[which] |= outcomes_differ(mine.outcome, other.outcome, alike) | apart
        spent[which] += other.rhs_evaluations
    fine.reason[_are_chaotic(fine, coarse, tolerance)] = Reason.CHAOTIC  # a view of ``results``
    inserted = fine.tau_align + fine.tau_inserted, coarse.tau_align + coarse.tau_inserted
    return Estimate(
        results=results,
        tau_error=_difference(fine.tau_align, coarse.tau_align, tolerance),
        insertion_error=_difference(*inserted, tolerance),
        sensitive=sensitive,
        rhs_evaluations=spent,
        tolerance=tolerance,
    )
