"""Results of a run: the one table of their names, types, meanings, quantities and tolerances.

The fields of ``Results`` are the table, with ``UNVIBRATED_CONTROL`` for the unvibrated control of a
run. The following are derived from it: the columns in which engines write results (record.py) and
``RunResult``, which reads them; ``Alignments`` and ``Trajectory``; the variables of datasets with
their attributes; the lines that the command line prints; the tolerances of comparisons with the
reference. To add a result, add a field here, and compute it in a kernel or with the error estimates
(runs/errors.py).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, Generic, NamedTuple, TypeVar, dataclass_transform

import numpy as np

from model.engine.tolerances import (
    Tolerance,
    by_error,
    equal,
    equal_if_aligned,
    of_rest,
    of_sampled_force,
    of_sampled_tilt,
    of_share,
)
from model.events.outcomes import InsertionOutcome, Outcome, Reason, Unvibrated
from model.physics.notation import State
from model.physics.quantities import ANGLE, FORCE, LENGTH, PLAIN, SPEED, TILT_RATE, TIME, Quantity
from model.physics.tables import Value, entries, field_of, numbers


class Sensitivity(IntEnum):
    """Sensitivity of a run; the values are the flags stored in datasets."""

    REGULAR = 0
    SENSITIVE = 1


@dataclass(frozen=True)
class Result:
    """One result of a run.

    Attributes:
        explanation: meaning and, after a semicolon, special values.
        quantity: SI unit and powers of the model's units; the values are dimensionless.
        symbol: symbol in the paper, if it has one.
        tolerance: largest difference from the reference; None if it is not compared.
        flags: enumeration of its values, if they are flags.
        line: formats a value as printed; None if it is not printed.
        estimated: True if runs/errors.py computes it, False if the engine does.
        stored: True if datasets hold it.
        wide: True for a count that datasets store in eight bytes.
    """

    explanation: str
    quantity: Quantity = PLAIN
    symbol: str | None = None
    tolerance: Tolerance | None = None
    flags: type[IntEnum] | None = None
    line: Callable[[Any], str] | None = "{:.7g}".format
    estimated: bool = False
    stored: bool = True
    wide: bool = False

    @property
    def meaning(self) -> str:
        """Meaning in a few words."""
        return self.explanation.partition(";")[0]

    def printed(self, value: Any) -> str:
        """Return ``value`` as printed; empty if it is NaN or not printed."""
        if self.line is None or math.isnan(value):
            return ""
        return self.line(value) + (" rad" if self.quantity is ANGLE else "")


OutcomeT = TypeVar("OutcomeT")
ReasonT = TypeVar("ReasonT")
Real = TypeVar("Real")
Count = TypeVar("Count")
Flag = TypeVar("Flag")
Table = TypeVar("Table")


class ValueTypes(NamedTuple):
    """Types of a result's values: of one run, in arrays of runs, and in stored arrays of runs."""

    scalar: Callable[[Any], Any]
    array: type[np.generic]
    stored: type[np.generic]


_VALUE_TYPES: Mapping[Any, ValueTypes] = {
    OutcomeT: ValueTypes(Outcome, np.int8, np.int8),
    ReasonT: ValueTypes(Reason, np.int8, np.int8),
    Real: ValueTypes(float, np.float64, np.float64),
    Count: ValueTypes(int, np.int64, np.int32),
    Flag: ValueTypes(bool, np.bool_, np.int8),
}


def entry(
    explanation: str, quantity: Quantity = PLAIN, symbol: str | None = None, **rest: Any
) -> Any:
    """Return a field of ``Results``; the arguments are those of ``Result``."""
    return field_of(Result(explanation, quantity, symbol, **rest))


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(entry,))
def results_table(table: type[Table]) -> type[Table]:
    """Make a table of results a frozen dataclass with keyword arguments."""
    return dataclass(frozen=True, kw_only=True, eq=False, repr=False)(table)


@results_table
class Results(Value, Generic[OutcomeT, ReasonT, Real, Count, Flag]):
    """The table of results, for one run or for arrays of runs; see ``Result``."""

    tau_align: Real = entry(
        "alignment duration; NaN where not aligned", TIME, "τ", tolerance=by_error, line=None
    )
    tau_error: Real = entry(
        "estimated error of the alignment duration; NaN where unknown", TIME, estimated=True
    )
    tau_corners_inside: Real = entry(
        "time at which all four corner conditions hold; else NaN", TIME, tolerance=by_error
    )
    outcome: OutcomeT = entry("how the run ended", flags=Outcome, line=None)
    reason: ReasonT = entry(
        "why it left the scene or failed, or that it is chaotic", flags=Reason, line=None
    )
    sensitive: Flag = entry(
        "whether another tolerance ends differently or at another time; see runs/errors.py",
        flags=Sensitivity, line=None, estimated=True,
    )  # fmt: skip
    tilt_at_alignment: Real = entry(
        "tilt at alignment; NaN where not aligned", ANGLE, "φ", tolerance=by_error
    )
    tilt_max: Real = entry(
        "largest tilt, absolute; until alignment or the end", ANGLE, tolerance=of_sampled_tilt
    )
    separations: Count = entry(
        "lift-offs of the part from the base before alignment",
        tolerance=equal_if_aligned, line=str,
    )  # fmt: skip
    contact_force_max: Real = entry(
        "largest normal force at one place; until alignment, or the end of an insertion",
        FORCE, "n", tolerance=of_sampled_force,
    )  # fmt: skip
    sticking_share: Real = entry(
        "share of the time in which the support sticks",
        tolerance=of_share, line=lambda share: f"{100.0 * share:.3g} %",
    )  # fmt: skip
    rhs_evaluations: Count = entry(
        "evaluations of the equations of motion; of all runs of a parameter set",
        line=str, wide=True,
    )  # fmt: skip
    period: Count = entry(
        "period of a settled motion, in excitation periods; else 0",
        line=lambda period: str(period) if period else "",
    )
    tau_inserted: Real = entry(
        "time from falling in to inserted; NaN where not inserted", TIME,
        tolerance=by_error, stored=False,
    )  # fmt: skip
    insertion_error: Real = entry(
        "estimated error of the time until inserted; NaN where unknown",
        TIME, estimated=True, stored=False,
    )  # fmt: skip
    edge_force_max: Real = entry(
        "largest normal force of the bottom face at an edge, or at both tips of a round part",
        FORCE, tolerance=of_sampled_force, stored=False,
    )  # fmt: skip
    corner_force_max: Real = entry(
        "largest normal force of a bottom corner on the flat base",
        FORCE, tolerance=of_sampled_force, stored=False,
    )  # fmt: skip
    side_force_max: Real = entry(
        "largest normal force of a side face at an edge",
        FORCE, tolerance=of_sampled_force, stored=False,
    )  # fmt: skip
    wall_force_max: Real = entry(
        "largest normal force of a bottom corner on the wall",
        FORCE, tolerance=of_sampled_force, stored=False,
    )  # fmt: skip
    steps: Count = entry("steps of the run", line=str, stored=False)
    events: Count = entry("events located in the run", line=str, stored=False)


RESULTS: Mapping[str, Result] = entries(Results)
VALUE_TYPES: dict[str, ValueTypes] = {
    f.name: _VALUE_TYPES[f.type]._replace(stored=np.int64)
    if RESULTS[f.name].wide
    else _VALUE_TYPES[f.type]
    for f in fields(Results)
}

# Results of the unvibrated control of a run (runs/unvibrated.py), in the datasets of the study.
UNVIBRATED_CONTROL: Mapping[str, Result] = {
    "unvibrated": Result(
        "how the same run ends without vibration", tolerance=equal, flags=Unvibrated, line=None
    ),
    "unvibrated_tilt": Result(
        "tilt at which it rests without vibration; NaN where it does not", ANGLE, tolerance=of_rest
    ),
    "slow_tilt": Result(
        "tilt at which it rests if it is pressed slowly; NaN where it does not",
        ANGLE,
        tolerance=of_rest,
    ),
}
# The end in the slot of an aligned run (runs/insertion_outcome.py), in the datasets of figures. Not
# compared: a run that is regular up to alignment may be sensitive after it.
IN_SLOT: Mapping[str, Result] = {
    "insertion": Result(
        "how an aligned run ends in the insertion scene", flags=InsertionOutcome, line=None
    )
}
VALUE_TYPES |= {
    name: _VALUE_TYPES[OutcomeT if each.flags else Real]
    for name, each in {**UNVIBRATED_CONTROL, **IN_SLOT}.items()
}

# Numbers of a run that its engine writes besides ``Results``; see ``RunResult``.
_ENGINE_ONLY = (
    "time",
    "end_tilt",
    "end_on_edge",
    "end_gap",
    "end_approach",
    "time_error",
    "end_error",
    "largest_error",
    "rejected",
    "tracked",
)


class RunResult(
    numbers(  # type: ignore[misc]
        "RunResult", [*(name for name in RESULTS if not RESULTS[name].estimated), *_ENGINE_ONLY]
    )
):
    """Results of one run as its engine writes them, each a float or an array of runs.

    The fields are those of ``Results`` that are not ``estimated``, ``time`` of the end,
    ``end_tilt`` there, ``end_on_edge`` (1 if the edge A1 on the bottom face is then the only
    contact, else 0), ``end_gap`` by which the edge A1 then lacks to the corner B1 along the face,
    and the rate ``end_approach`` at which it closes, ``rejected`` steps, the errors that it carries
    (``time_error`` of the alignment time, ``end_error`` of the time of the event that ends the run,
    ``largest_error`` of the state; NaN if it carries none) and ``tracked``, the number of rows of a
    full track.
    """

    __slots__ = ()


# Variables of a trajectory besides the time: the columns of a track.
TRACK_VARIABLES: Mapping[str, Result] = {
    "x": Result("abscissa of the mass centre", LENGTH, "x"),
    "y": Result("ordinate of the mass centre", LENGTH, "y"),
    "tilt": Result("tilt", ANGLE, "φ"),
    "x_rate": Result("velocity along x", SPEED),
    "y_rate": Result("velocity along y", SPEED),
    "tilt_rate": Result("tilt velocity", TILT_RATE),
    "contact_force": Result("normal force under the part", FORCE, "n"),
    "side_force": Result("normal force of A2 on the side face", FORCE),
    "right_force": Result("normal force on the right side of the slot", FORCE, stored=False),
}
assert tuple(TRACK_VARIABLES)[: len(State._fields)] == State._fields  # noqa: S101 - of this table
