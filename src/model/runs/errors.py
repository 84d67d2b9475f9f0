"""Error estimates: from the error that a run carries, or from neighbouring runs.

Carried errors. A run carries its error along (engine/carried_error.py), and with it the errors of
its times. It runs at the tolerance divided by ``FINER``. The few sets
whose error is larger than the tolerance promises (``PROMISED``) are run again at a smaller one. In
the second run errors may cancel by chance: its estimate is at least that of the first run, times
the ratio of the tolerances and divided by 4. Whether such a set is sensitive, a neighbour decides:
a run from a start displaced by the tolerance, which may depart by far more than the run's own
error.

Neighbours. They give the estimate where a run carries an error too large for the linearised motion,
where a part starts nearly flat, or with a gap below the tolerance. A neighbour is run at
``COARSER`` times the tolerance, with x(0) displaced by the tolerance. The set is run again at a
smaller tolerance if the two outcomes differ, or if their times are far apart or differ by more than
the tolerance promises.

Sensitive sets. A set is sensitive if the run with the displaced start, at the smaller tolerance,
still ends with another outcome or at another time: the digits of its alignment time would be
meaningless. A set with a nearly flat start is also sensitive if an initial tilt larger by
``TILTED`` changes its end. No device has so exact a tilt, but it decides whether such a part rests
on its edge or on its corner, or touches the base at all.

Horizons. A run that ends by the horizon is sensitive if the edge is then as near to the corner as
the error of its place, and an aligned or inserted one if the horizon is within the error of its
time.

Chaotic runs. If a run and its neighbour both reach the horizon, but differ in lift-offs, sticking,
or other events and the largest tilt, a run at another tolerance may align by chance. The reason of
such a set is ``CHAOTIC``. It stands for sensitive dependence; chaos is not tested for.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.engine.results import RunResult
from model.events.event_functions import FLAT
from model.events.outcomes import Outcome, Reason
from model.physics.parameters import Constants
from model.runs.engine import Array, Run

FINER = 100.0  # tolerance asked for over the tolerance of runs that carry their error
COARSER = 16.0  # tolerance of a neighbour over that of the run
SENSITIVE = 1e-4  # difference of two alignment times, or shares, above which they are not the same
SHARPER = 1e3  # tolerance asked for over the tolerance of a set that is run again
PROMISED = 100.0  # error over the tolerance above which a set is run again
FINEST = 1e-14  # smallest tolerance
RESOLUTION = 1e-14  # relative rounding of an alignment time
NEARLY_FLAT = 1e-6  # initial tilt below which a part is nearly flat
TILTED = 10.0 * FLAT  # additional tilt of its neighbour

_SAFETY = 4.0
_CARRIED = 3.0  # estimate over the error that a run carries; decision 3


class Estimate(NamedTuple):
    """Results of parameter sets with their errors; arrays of shape (n,), ``results`` (n, fields).

    Attributes:
        results: fields of ``RunResult``, of the run itself, not of a neighbour.
        tau_error: of the alignment time; NaN where the run, or the neighbour that it is compared
            with, does not align.
        insertion_error: of the time until inserted; NaN where either is not inserted.
        sensitive: True for sensitive sets; see the module.
        rhs_evaluations: right-hand-side evaluations of all runs of a set.
        tolerance: tolerance of the run.
    """

    results: Array
    tau_error: Array
    insertion_error: Array
    sensitive: NDArray[np.bool_]
    rhs_evaluations: Array
    tolerance: Array

    def columns(self) -> dict[str, NDArray[Any]]:
        """Return all results by name, each of shape (n,)."""
        own = self._asdict()
        del own["tolerance"]
        return RunResult(*own.pop("results").T)._asdict() | own


def estimate(
    run: Run, carrying: Run, rows: Array, tolerance: float, horizon: float = np.inf
) -> Estimate:
    """Run every row, shape (n, constants), and estimate its error; see the module.

    ``tolerance`` is the tolerance asked for, ``carrying`` the engine with which runs carry their
    errors, and ``horizon`` that of the runs.
    """
    sharper = max(tolerance / FINER, FINEST)
    found, doubtful = _by_carried_errors(carrying, rows, np.full(len(rows), sharper))
    error = np.fmax(found.tau_error, found.insertion_error)
    imprecise = (error > _CARRIED * PROMISED * tolerance) & ~doubtful
    if imprecise.any() and sharper > FINEST:
        reduced = sharper * PROMISED * tolerance / (_SAFETY * error[imprecise])
        reduced = np.maximum(reduced, FINEST)
        finer, doubtful[imprecise] = _by_carried_errors(carrying, rows[imprecise], reduced)
        # Lower bound from the first run, in case errors cancel in the second.
        least = found.tau_error[imprecise] * reduced / sharper / _SAFETY
        np.maximum(finer.tau_error, least, out=finer.tau_error)
        _replace_estimates(found, imprecise, finer)
    if doubtful.any():
        known = Estimate(**{name: column[doubtful] for name, column in found._asdict().items()})
        _replace_estimates(found, doubtful, _by_neighbours(run, rows[doubtful], known, tolerance))
    again = np.flatnonzero(imprecise & ~found.sensitive)
    if again.size:
        displaced = _displaced(rows[again], "misalignment", tolerance)
        neighbour = RunResult(*run(displaced, COARSER * found.tolerance[again]).T)
        own = RunResult(*found.results[again].T)
        found.sensitive[again] = _ends_apart(Constants(*rows[again].T), own, neighbour)
        found.rhs_evaluations[again] += neighbour.rhs_evaluations
    results = RunResult(*found.results.T)
    found.sensitive[:] |= horizon - results.tau_align <= found.tau_error
    inserted = results.tau_inserted  # the horizon begins anew at alignment
    found.sensitive[:] |= horizon - inserted <= found.insertion_error
    return found


def _replace_estimates(found: Estimate, which: NDArray[np.bool_], renewed: Estimate) -> None:
    """Replace the estimates of ``which`` sets by ``renewed`` ones, and add their evaluations."""
    renewed.rhs_evaluations[:] += found.rhs_evaluations[which]
    for kept, new in zip(found, renewed, strict=True):
        kept[which] = new


def _by_carried_errors(
    run: Run, rows: Array, tolerance: Array
) -> tuple[Estimate, NDArray[np.bool_]]:
    """Run each row once; return also a mask of the sets whose carried error is no estimate."""
    p, results = Constants(*rows.T), run(rows, tolerance)
    found = RunResult(*results.T)
    is_small = found.largest_error <= SENSITIVE
    is_flat = np.abs(p.initial_tilt) < NEARLY_FLAT
    inserted = found.tau_align + found.tau_inserted
    place = _CARRIED * found.largest_error * (2.0 + p.half_height)  # error along the bottom face
    place += tolerance * np.maximum(found.end_approach, 0.0)
    made = Estimate(
        results=results,
        tau_error=_time_error(found.tau_align, _CARRIED * found.time_error, tolerance),
        insertion_error=_time_error(inserted, _CARRIED * found.end_error, tolerance),
        sensitive=_nearly_aligned(found, place),
        rhs_evaluations=found.rhs_evaluations.copy(),
        tolerance=tolerance,
    )
    is_unknown = np.isnan(made.tau_error) & ~np.isnan(found.tau_align)
    is_unknown |= np.isnan(made.insertion_error) & ~np.isnan(inserted)
    return made, ~is_small | is_unknown | is_flat | _is_too_narrow(p, tolerance)


def _by_neighbours(run: Run, rows: Array, known: Estimate, asked: float) -> Estimate:
    """Compare ``known`` results with neighbours; where they differ by much, run the sets again.

    ``asked`` is the tolerance asked for.
    """
    tolerance = known.tolerance
    first = _compare(run, rows, tolerance, results=known.results)
    error = np.fmax(first.tau_error, first.insertion_error)
    imprecise = error > PROMISED * asked
    again = (first.sensitive | imprecise) & (tolerance > FINEST)
    if not again.any():
        return first
    reduced, least = np.minimum(tolerance, asked / SHARPER), np.zeros(len(rows))
    few = imprecise & ~first.sensitive
    reduced[few] = tolerance[few] * PROMISED * asked / (_SAFETY * error[few])
    reduced = np.maximum(reduced, FINEST)
    # Lower bound from the first two runs, in case the later ones agree by chance.
    least[few] = first.tau_error[few] * reduced[few] / tolerance[few] / _SAFETY
    second = _compare(run, rows[again], reduced[again], asked)
    np.maximum(second.tau_error, least[again], out=second.tau_error)
    _replace_estimates(first, again, second)
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
    differ: NDArray[np.bool_] = (outcome != other) & ~same
    return differ


def _nearly_aligned(run: RunResult, error: Array) -> NDArray[np.bool_]:
    """Return a mask of the runs that end by the horizon within their error of alignment.

    ``error`` is that of the place of the edge along the bottom face.
    """
    rounding = RESOLUTION * (1.0 + run.time) * np.maximum(run.end_approach, 0.0)
    at_horizon = (run.outcome == Outcome.HORIZON_REACHED) & np.isnan(run.tau_align)
    near: NDArray[np.bool_] = at_horizon & (np.abs(run.end_gap) <= error + rounding)
    return near


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
        per_repetition = np.rint(more / repetitions)
        repeats = np.abs(more - per_repetition * repetitions) <= per_repetition
    alike: NDArray[np.bool_] = (more == 0.0) | ((repetition > 0.0) & repeats)
    return alike


def _end_time(run: RunResult) -> Array:
    """Return the times of alignment, or of insertion, or of leaving the scene; else NaN.

    A jammed part comes to rest at no definite time; its time is when all corners are inside.
    """
    time: Array = run.time
    ends = np.isin(run.outcome, (Outcome.LEFT_SCENE, Outcome.INSERTED))
    jammed = run.outcome == Outcome.JAMMED
    last = np.where(jammed, np.fmax(run.tau_align, run.tau_corners_inside), run.tau_align)
    return np.where(ends, time, last)


def _ends_apart(
    p: Constants, run: RunResult, other: RunResult, motions_alike: bool = False
) -> NDArray[np.bool_]:
    """Return a mask of the runs with another outcome or end time than their neighbours.

    ``motions_alike``: True if motions count as alike however often the part lifts off.
    """
    apart: NDArray[np.bool_] = np.abs(_end_time(run) - _end_time(other)) > SENSITIVE
    apart |= np.abs(run.tau_align - other.tau_align) > SENSITIVE
    alike = _lift_off_alike(p, run, other) | motions_alike
    return apart | outcomes_differ(run.outcome, other.outcome, alike)


def _are_chaotic(run: RunResult, other: RunResult) -> NDArray[np.bool_]:
    """Return a mask of the runs that reach the horizon by another motion than their neighbours."""
    at_horizon = (run.outcome == Outcome.HORIZON_REACHED) & (
        other.outcome == Outcome.HORIZON_REACHED
    )
    differ = np.abs(run.sticking_share - other.sticking_share) > SENSITIVE
    # The same motion may have more events where several happen at once, but no larger tilt.
    tilts_more = np.abs(run.tilt_max - other.tilt_max) > SENSITIVE
    differ |= (run.separations != other.separations) | ((run.events != other.events) & tilts_more)
    chaotic: NDArray[np.bool_] = at_horizon & differ
    return chaotic


def _time_error(time: Array, difference: Array, tolerance: Array) -> Array:
    """Return the estimated error of a time, from its ``difference`` to that of another run."""
    error: Array = np.abs(difference) + tolerance + RESOLUTION * (1.0 + time)
    return error


def _is_too_narrow(p: Constants, tolerance: Array) -> NDArray[np.bool_]:
    """Return a mask of the sets with a gap below the tolerance."""
    narrow: NDArray[np.bool_] = p.slot_half_width - p.half_width < tolerance
    return narrow


def _compare(
    run: Run,
    rows: Array,
    tolerance: Array,
    asked: float | None = None,
    results: Array | None = None,
) -> Estimate:
    """Estimate errors from neighbours, whose starts are displaced by the ``tolerance`` of a row.

    If ``asked``, the tolerance asked for, is given, each row is also run from a start displaced by
    it, for the flag of sensitivity; else the neighbour decides. Rows that start nearly flat have
    another neighbour, tilted more. Rows are not run themselves if their ``results`` are known.
    """
    p = Constants(*rows.T)
    every = np.arange(len(rows))
    flat = np.flatnonzero(np.abs(p.initial_tilt) < NEARLY_FLAT)
    others = [(every, _displaced(rows, "misalignment", tolerance))]
    if asked is not None:
        others.append((every, _displaced(rows, "misalignment", asked)))
    others.append((flat, _displaced(rows[flat], "initial_tilt", TILTED)))
    starts = [displaced for _, displaced in others]
    tolerances = [COARSER * tolerance[which] for which, _ in others]
    if results is None:
        starts, tolerances = [rows, *starts], [tolerance, *tolerances]
    ends = np.cumsum([each.size for each in tolerances])
    ran = np.split(run(np.concatenate(starts), np.concatenate(tolerances)), ends[:-1])
    spent = np.zeros(len(rows))
    if results is None:
        results = ran.pop(0)
        spent += RunResult(*results.T).rhs_evaluations
    fine, coarse = RunResult(*results.T), RunResult(*ran[0].T)
    within = COARSER * (tolerance if asked is None else asked)
    within = within * (1.0 + np.maximum(fine.end_approach, 0.0))
    moved = np.abs(fine.end_gap - coarse.end_gap)
    sensitive = _is_too_narrow(p, tolerance) | _nearly_aligned(fine, moved + within)
    for (which, _), displaced in zip(others, ran, strict=True):
        own, other = RunResult(*results[which].T), RunResult(*displaced.T)
        sensitive[which] |= _ends_apart(Constants(*rows[which].T), own, other, which is flat)
        spent[which] += other.rhs_evaluations
    fine.reason[_are_chaotic(fine, coarse)] = Reason.CHAOTIC  # a view of ``results``
    inserted = fine.tau_align + fine.tau_inserted
    later = inserted - (coarse.tau_align + coarse.tau_inserted)
    return Estimate(
        results=results,
        tau_error=_time_error(fine.tau_align, fine.tau_align - coarse.tau_align, tolerance),
        insertion_error=_time_error(inserted, later, tolerance),
        sensitive=sensitive,
        rhs_evaluations=spent,
        tolerance=tolerance,
    )
