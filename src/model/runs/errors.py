"""Estimated errors: every parameter set is run at least twice.

The result is that of the run at the tolerance asked for. A second run, at ``COARSER`` times that
tolerance and from a start displaced in x(0) by the tolerance, shows how far the alignment time may
still move. A set is run again at a smaller tolerance where the two outcomes differ, where the times
are far apart or agree less closely than the tolerance promises, and where the gap between part and
slot is below the tolerance: there the two may agree and both be wrong. The error estimated from the
first two runs, times the ratio of the tolerances, bounds that of the others from below, up to a
factor of 4: the others may agree by chance.

A set is sensitive if the displaced start, run at the smaller tolerance, still ends elsewhere:
digits of its alignment time would be false. A part that starts nearly flat is also sensitive if it
ends elsewhere when tilted by ``TILTED`` more: no device has so exact a tilt, but the tilt decides
whether such a part stands on its edge or on its corner, or touches the base at all.

Where the two runs differ in lift-offs or sticking until both reach the horizon, another tolerance
may align by chance. The reason of such a set is ``CHAOTIC``: a sensitive dependence, for which no
other test is made.
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
SHARPER = 1e3  # tolerance over that at which sets are run again whose two runs part
PROMISED = 100.0  # largest error, over the tolerance, that is not run again
FINEST = 1e-14  # smallest tolerance
RESOLUTION = 1e-14  # relative rounding of an alignment time
NEARLY_FLAT = 1e-6  # a tilt at the start below which a part is nearly flat
TILTED = 10.0 * FLAT  # by how much its neighbour is tilted further

_SAFETY = 4.0


class Estimate(NamedTuple):
    """Results of parameter sets with their errors; arrays of shape (n,), ``results`` (n, fields).

    Attributes:
        results: fields of ``RunResult`` of the finer runs.
        tau_error: NaN where either of the two runs does not align.
        sensitive: see the module.
        rhs_evaluations: of all runs of a set.
        tolerance: of the finer runs.
    """

    results: Array
    tau_error: Array
    sensitive: NDArray[np.bool_]
    rhs_evaluations: Array
    tolerance: Array

    def columns(self) -> dict[str, NDArray[Any]]:
        """Return all results by name, each of shape (n,)."""
        return {
            **RunResult(*self.results.T)._asdict(),
            "tau_error": self.tau_error,
            "sensitive": self.sensitive,
            "rhs_evaluations": self.rhs_evaluations,
        }


def estimate(run: Run, rows: Array, tolerance: float) -> Estimate:
    """Run every row, shape (n, constants), twice; where that is not enough, three times more."""
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


def _displaced(rows: Array, constant: str, by: Array | float) -> Array:
    displaced = rows.copy()
    displaced[:, Constants._fields.index(constant)] += by
    return displaced


def outcomes_differ(
    outcome: NDArray[Any], other: NDArray[Any], alike: NDArray[np.bool_] | bool
) -> NDArray[np.bool_]:
    """Return which runs have another outcome than their neighbours; arrays of shape (n,).

    At a smaller tolerance or another tilt a periodic motion may settle later, or not before the
    horizon: the outcomes count as equal if the motions are ``alike``.
    """
    periodic = (Outcome.SETTLED, Outcome.HORIZON_REACHED)
    same = np.isin(outcome, periodic) & np.isin(other, periodic) & alike
    found: NDArray[np.bool_] = (outcome != other) & ~same
    return found


def _lift_off_alike(p: Constants, run: RunResult, other: RunResult) -> NDArray[np.bool_]:
    """Return which runs and their neighbours lift off equally often, each until its own end.

    A run that lasts longer than another that has settled repeats its motion: it has the same whole
    number of lift-offs more for every repetition.
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
    """Return when runs aligned or left the scene; NaN for runs that end by the horizon."""
    time: Array = run.time
    return np.where(run.outcome == Outcome.LEFT_SCENE, time, run.tau_align)


def _are_chaotic(run: RunResult, other: RunResult) -> NDArray[np.bool_]:
    """Return which runs and their neighbours reach the horizon by different motions."""
    at_horizon = (run.outcome == Outcome.HORIZON_REACHED) & (
        other.outcome == Outcome.HORIZON_REACHED
    )
    differ = np.abs(run.sticking_share - other.sticking_share) > SENSITIVE
    found: NDArray[np.bool_] = at_horizon & ((run.separations != other.separations) | differ)
    return found


def _compare(run: Run, rows: Array, tolerance: Array, neighbour: float | None = None) -> Estimate:
    """Run each row twice, and a third time from a start displaced by ``neighbour`` for the flag.

    Without ``neighbour`` the displacement of the second run decides. Rows that start nearly flat
    are run once more.
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
    fine.reason[_are_chaotic(fine, coarse)] = Reason.CHAOTIC  # a view of ``results``
    difference = np.abs(fine.tau_align - coarse.tau_align)
    return Estimate(
        results=results,
        tau_error=difference + tolerance + RESOLUTION * (1.0 + fine.tau_align),
        sensitive=sensitive,
        rhs_evaluations=spent,
        tolerance=tolerance,
    )
