"""Fuzz, `make fuzz`: random sets over the whole domain of the parameters, and properties of runs.

The distributions reach far beyond real devices, to find runs that do not end, have an undeclared
outcome, or end differently when they are repeated.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.events.insertion import INSERTION
from model.events.outcomes import Outcome, Reason
from model.physics.parameters import Batch
from model.runs.align import Alignments, align
from model.runs.errors import SENSITIVE, outcomes_differ
from model.runs.settings import Settings

Floats = NDArray[np.float64]

SETTINGS = Settings(horizon=5.0, tolerance=1e-9, max_evaluations=2_500)
IN_SLOT = Settings(scene=INSERTION, horizon=20.0, tolerance=1e-9, max_evaluations=20_000)
_TIGHTER, _PATIENCE = 0.01, 4  # factors on tolerance and limit of evaluations of compared runs
_MOST_RUNS = 7  # of a set: two, three more if these differ, and runs that start flat
_UNBOUNDED = 500_000_000  # evaluations: only the horizon stops a run
_LAST_STEP = 600  # evaluations that a step and its event may take beyond the limit

_LEAVING = (
    Reason.MOVED_AWAY, Reason.OVERSHOT, Reason.CORNER_ON_WALL, Reason.EDGE_ON_OTHER_FACE,
    Reason.BOTH_SIDES, Reason.OVERTURNED, Reason.UNDECLARED_CONTACT,
)  # fmt: skip
_REASONS = {
    Outcome.LEFT_SCENE: _LEAVING,
    Outcome.CLIMBED_OUT: (*_LEAVING, Reason.ON_EDGE),
    Outcome.JAMMED: (Reason.WEDGED, Reason.LACK_OF_FORCE),
}
_FAILING = (
    Reason.IMPOSSIBLE_START, Reason.STEP_TOO_SMALL, Reason.TOO_MANY_EVALUATIONS, Reason.CHATTER,
    Reason.NOT_FINITE, Reason.NO_FRICTION_SOLUTION,
)  # fmt: skip
# Failures of the solver that no property of the set explains: allowed, but only in a small share.
UNEXPLAINED = (Reason.CHATTER, Reason.NOT_FINITE, Reason.STEP_TOO_SMALL,
               Reason.NO_FRICTION_SOLUTION)  # fmt: skip


class Law(NamedTuple):
    """Log-uniform from ``low`` to ``high``; a share ``zero`` is 0, a share ``minus`` negative."""

    low: float
    high: float
    zero: float = 0.0
    minus: float = 0.0


LAWS: Mapping[str, Law] = {
    "half_width": Law(1e-2, 1e2),
    "half_height": Law(1e-2, 1e2),
    "clearance": Law(1e-9, 1e1),
    "initial_tilt": Law(1e-9, 1.5, zero=0.2, minus=0.3),
    "inertia": Law(1e-4, 1e4),
    "lateral_stiffness": Law(1e-4, 1e4, zero=0.1),
    "tilt_stiffness": Law(1e-4, 1e4, zero=0.1),
    "lateral_damping": Law(1e-4, 1e2, zero=0.2),
    "axial_damping": Law(1e-4, 1e2, zero=0.2),
    "tilt_damping": Law(1e-4, 1e2, zero=0.2),
    "contact_stiffness": Law(1e-1, 1e8),
    "contact_damping": Law(1e-3, 1e4, zero=0.2),
    "friction": Law(1e-3, 1e1, zero=0.1),
    "press_force": Law(1e-2, 1e2, zero=0.1, minus=0.1),
    "frequency": Law(1e-3, 1e3, zero=0.1),
    "phase": Law(1e-2, 6.3, zero=0.5, minus=0.5),
    "rest_x": Law(1e-3, 1e1, minus=0.5),
    "rest_y": Law(1e-2, 1e2, minus=0.1),
    "rest_tilt": Law(1e-6, 1.0, zero=0.5, minus=0.5),
}
# For the insertion scene: about half of these devices fall in, while most sets of ``LAWS`` do not.
LAWS_IN_SLOT: Mapping[str, Law] = {
    **LAWS,
    "half_width": Law(0.3, 3.0),
    "half_height": Law(0.3, 5.0),
    "clearance": Law(1e-3, 0.5),
    "initial_tilt": Law(1e-4, 0.3, zero=0.2, minus=0.3),
    "inertia": Law(0.1, 30.0),
    "lateral_stiffness": Law(1e-2, 10.0, zero=0.1),
    "tilt_stiffness": Law(0.1, 100.0),
    "lateral_damping": Law(1e-2, 3.0, zero=0.1),
    "axial_damping": Law(1e-2, 3.0, zero=0.1),
    "tilt_damping": Law(1e-1, 10.0, zero=0.1),
    "contact_stiffness": Law(1e2, 1e5),
    "contact_damping": Law(0.1, 1e2, zero=0.1),
    "friction": Law(1e-2, 2.0, zero=0.1),
    "press_force": Law(0.3, 10.0),
    "frequency": Law(0.1, 10.0, zero=0.1),
    "rest_x": Law(1e-3, 1.0, minus=0.5),
    "rest_tilt": Law(1e-6, 0.3, zero=0.5, minus=0.5),
}
SCENES: Mapping[str, tuple[Settings, Mapping[str, Law]]] = {
    "alignment": (SETTINGS, LAWS),
    "insertion": (IN_SLOT, LAWS_IN_SLOT),
}
UNEXPLAINED_SHARE = 1e-3
_DERIVED = 0.7  # share of the sets whose rest_x and rest_y follow the start


def draw(seed: int, first: int, count: int, laws: Mapping[str, Law] = LAWS) -> Batch:
    """Return sets ``first`` to ``first + count``; a set depends on its number and the seed only."""
    rows = np.array(
        [np.random.default_rng([seed, first + i]).random((3, 1 + len(LAWS))) for i in range(count)]
    )
    values: dict[str, Floats] = {}
    for i, (name, law) in enumerate(laws.items()):
        value = law.low * (law.high / law.low) ** rows[:, 0, i]
        value = np.where(rows[:, 1, i] < law.minus, -value, value)
        value = np.where(rows[:, 2, i] < law.zero, 0.0, value)
        if name.startswith("rest_") and law.zero == 0.0:
            value = np.where(rows[:, 2, i] < _DERIVED, np.nan, value)
        values[name] = value
    values["approach_speed"] = np.full(count, np.nan)
    # On the edge, most often near its ends.
    reach = values["half_width"] * (2.0 + values["clearance"])
    place = rows[:, 0, -1]
    values["misalignment"] = reach * np.where(rows[:, 1, -1] < 0.5, place, 1e-3**place * 0.999)
    return Batch(values)


class Finding(NamedTuple):
    """A broken property: number of the set, name of the property, and results of the run."""

    number: int
    what: str
    found: str


class Report(NamedTuple):
    """Result of a campaign: outcomes of its runs, sensitive sets, and broken properties.

    ``against_neighbour`` and ``against_tighter`` count the sets that were compared, whose two
    runs both have a certain end. ``unexplained`` are the sets that failed by ``UNEXPLAINED``.
    """

    sets: int
    endings: Counter[str]
    sensitive: int
    against_neighbour: int
    against_tighter: int
    evaluations: int
    findings: list[Finding]
    unexplained: list[Finding]


def _same(one: Alignments, other: Alignments) -> NDArray[np.bool_]:
    """Return a mask of the sets whose results are equal to the bit; NaN equals NaN."""
    agree = np.ones(len(one), dtype=np.bool_)
    for field in fields(Alignments):
        a, b = getattr(one, field.name), getattr(other, field.name)
        equal = a == b
        if a.dtype.kind == "f":
            equal |= np.isnan(a) & np.isnan(b)
        agree &= equal
    return agree


def _taken(runs: Alignments, rows: NDArray[np.int64]) -> Alignments:
    return Alignments(
        **{field.name: getattr(runs, field.name)[rows] for field in fields(Alignments)}
    )


def _sets(batch: Batch, rows: NDArray[np.int64], displaced: float = 0.0) -> Batch:
    values = {name: of_all[rows] for name, of_all in batch.values.items()}
    values["misalignment"] = values["misalignment"] + displaced
    return Batch(values)


def broken_properties(runs: Alignments, settings: Settings) -> dict[str, NDArray[np.bool_]]:
    """Return masks of the sets that break a property, shape (n,), by name of the property."""
    inserts = settings.success is Outcome.INSERTED
    ends = (
        (Outcome.INSERTED, Outcome.JAMMED, Outcome.CLIMBED_OUT) if inserts else (Outcome.ALIGNED,)
    )
    aligned, inserted = np.isin(runs.outcome, ends), runs.outcome == Outcome.INSERTED
    failed = runs.outcome == Outcome.FAILED
    spent = _MOST_RUNS * (settings.max_evaluations + _LAST_STEP)
    moving = runs.outcome == Outcome.HORIZON_REACHED
    reasons = runs.reason == Reason.NONE
    for outcome, fitting in _REASONS.items():
        reasons = np.where(runs.outcome == outcome, np.isin(runs.reason, fitting), reasons)
    reasons = np.where(failed, np.isin(runs.reason, _FAILING), reasons)
    reasons |= moving & (runs.reason == Reason.CHAOTIC)
    with np.errstate(invalid="ignore"):
        in_time = (runs.tau_align >= 0.0) & (runs.tau_align <= settings.horizon)
        inside = (runs.sticking_share >= 0.0) & (runs.sticking_share <= 1.0 + 1e-12)
    return {
        "ends within its evaluations": runs.rhs_evaluations > spent,
        "ends in a declared outcome": ~np.isin(runs.outcome, list(Outcome)),
        "has a reason that fits its outcome": ~reasons,
        # In the slot a run may also reach the horizon, or fail.
        "has an alignment time if and only if it aligns": aligned & ~in_time
        | ~aligned & in_time & ~(inserts & (moving | failed)),
        "has a time until inserted if and only if it is inserted": inserted
        != (runs.tau_inserted >= 0.0),
        "has a positive error or says that it is sensitive": aligned
        & ~runs.sensitive
        & ~(np.nan_to_num(runs.tau_error, nan=-1.0) > 0.0),
        "is finite": ~(np.isfinite(runs.tilt_max) & np.isfinite(runs.contact_force_max)),
        "sticks for a share of its time": ~inside,
    }


def try_sets(
    seed: int,
    first: int,
    count: int,
    settings: Settings = SETTINGS,
    laws: Mapping[str, Law] = LAWS,
) -> Report:
    """Draw and run sets, and check the properties of their runs.

    Raises:
        ValueError: ``count`` is below 1.
    """
    if count < 1:
        raise ValueError(f"sets = {count!r}: must be >= 1")
    batch = draw(seed, first, count, laws)
    runs = align(batch, settings, cores=1)
    broken = broken_properties(runs, settings)

    # The same sets again, in reverse order and on other threads.
    order = np.arange(count)[::-1]
    again = _taken(align(_sets(batch, order), settings, cores=3), order)
    broken["is the same to the bit in another order on other cores"] = ~_same(runs, again)

    # Only sets with a certain end are compared.
    rows = np.flatnonzero(_is_certain(runs))
    certain = _taken(runs, rows)

    def compare(what: str, other: Callable[[NDArray[np.int64], Settings], Alignments]) -> int:
        others = other(rows, settings)
        differ = _differ(certain, others)
        early = differ & _one_settles(certain, others)
        if early.any():
            on = replace(settings, may_settle=False, max_evaluations=_UNBOUNDED)
            mine = align(_sets(batch, rows[early]), on, cores=1)
            differ[early] = ~_move_alike(mine, other(rows[early], on))
        of_all = np.zeros(count, dtype=np.bool_)
        of_all[rows] = differ
        broken[f"agrees with {what} unless either is sensitive"] = of_all
        return int(_is_certain(others).sum())

    def near(which: NDArray[np.int64], limits: Settings) -> Alignments:
        return align(_sets(batch, which, 0.5 * limits.tolerance), limits, cores=1)

    def tight(which: NDArray[np.int64], limits: Settings) -> Alignments:
        patient = replace(
            limits,
            tolerance=_TIGHTER * limits.tolerance,
            max_evaluations=_PATIENCE * limits.max_evaluations,
        )
        return align(_sets(batch, which), patient, cores=1)

    # A set that is not sensitive must end alike half a tolerance away, and at a tighter tolerance.
    against_neighbour = compare("its neighbour", near) if rows.size else 0
    against_tighter = compare("a tighter tolerance", tight) if rows.size else 0

    endings = [
        (Outcome(int(outcome)).name.lower(), Reason(int(reason)).name.lower())
        for outcome, reason in zip(runs.outcome, runs.reason, strict=True)
    ]

    def found(properties: Mapping[str, NDArray[np.bool_]]) -> list[Finding]:
        return [
            Finding(
                first + row,
                what,
                f"{endings[row][0]} ({endings[row][1]}), tau_align {runs.tau_align[row]!r} ± "
                f"{runs.tau_error[row]!r}, {int(runs.rhs_evaluations[row])} evaluations",
            )
            for what, which in properties.items()
            for row in np.flatnonzero(which).tolist()
        ]

    return Report(
        count,
        Counter(": ".join(ending) for ending in sorted(endings)),
        int(runs.sensitive.sum()),
        against_neighbour,
        against_tighter,
        int(runs.rhs_evaluations.sum()),
        found(broken),
        found({"failed without a reason of its own": np.isin(runs.reason, UNEXPLAINED)}),
    )


def _is_certain(runs: Alignments) -> NDArray[np.bool_]:
    """Return a mask of the sets with a certain end: not sensitive, not chaotic, below the limit.

    Whether a run reaches its end below the limit of evaluations depends on its steps.
    """
    return ~runs.sensitive & ~np.isin(runs.reason, (Reason.TOO_MANY_EVALUATIONS, Reason.CHAOTIC))


def _differ(runs: Alignments, others: Alignments) -> NDArray[np.bool_]:
    """Return a mask of the sets whose outcomes or times differ, if both ends are certain."""
    with np.errstate(invalid="ignore"):
        apart = np.abs(runs.tau_align - others.tau_align) > SENSITIVE
        apart |= np.abs(runs.tau_inserted - others.tau_inserted) > SENSITIVE
    certain = _is_certain(runs) & _is_certain(others)
    alike = runs.separations == others.separations
    return certain & (outcomes_differ(runs.outcome, others.outcome, alike) | apart)


def _one_settles(runs: Alignments, others: Alignments) -> NDArray[np.bool_]:
    """Return a mask of the sets of which one run settles and the other reaches the horizon.

    Engines sample closest approaches at their own steps, so that one run may pass the test of a
    periodic steady state before the other (decision 6). The motions are still the same if both,
    continued without the test, ``_move_alike``.
    """
    mine = runs.outcome == Outcome.HORIZON_REACHED
    theirs = others.outcome == Outcome.HORIZON_REACHED
    return theirs & (runs.period > 0) | mine & (others.period > 0)


def _move_alike(runs: Alignments, others: Alignments) -> NDArray[np.bool_]:
    """Return a mask of the sets with the same end, lift-offs and share of sticking."""
    alike = _is_certain(runs) & _is_certain(others) & ~_differ(runs, others)
    alike &= (runs.outcome == others.outcome) & (runs.separations == others.separations)
    return alike & (np.abs(runs.sticking_share - others.sticking_share) <= SENSITIVE)
