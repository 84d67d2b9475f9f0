"""The record of a run: one row of numbers, so that many runs make an array.

A batch of runs is an array ``runs`` of shape (runs, SIZE): ``runs[i, TIME]`` is the time that run
``i`` has reached. Counts and flags are whole numbers kept as floats.
"""

from math import isnan
from typing import NamedTuple

from model.events.table import SWITCH_COUNT
from model.physics.compiled import inlined_kernel, kernel
from model.physics.notation import STATE_SIZE, State
from model.physics.parameters import Constants
from model.physics.scenes import Mode
from model.physics.views import reader, writer

CONSTANTS = len(Constants._fields)  # the first numbers

_SINGLE_ROWS = (
    TIME,
    NEXT_STEP,  # length that the error estimate proposes
    TOLERANCE,
    DEADLINE,  # when the run ends at the latest
    STOP,  # end of the present excitation period, or the deadline
    PERIODS,  # excitation periods completed
    OUTCOME,
    REASON,
    SETTLED_PERIOD,
    TAU_ALIGN,
    TAU_CORNERS_INSIDE,
    TILT_AT_ALIGNMENT,
    TILT_MAX,
    FORCE_MAX,
    STICKING_TIME,
    SEPARATIONS,
    EVALUATIONS,
    STEPS,
    REJECTED,
    SWITCHES,
    SWITCHES_AT_ONCE,  # without time passing between them
    TRACKED,
    ROW_OF_BATCH,
) = tuple(range(CONSTANTS, CONSTANTS + 23))
STATE = _SINGLE_ROWS[-1] + 1
MODE = STATE + STATE_SIZE
CLOSEST = MODE + len(Mode._fields)  # lowest switching functions in this period
MADE = CLOSEST + SWITCH_COUNT  # whether a switch was made in this period
SIZE = MADE + SWITCH_COUNT


class Ending(NamedTuple):
    """How a run ended and what it met on the way; all dimensionless.

    ``tau_align`` is NaN unless aligned, ``tau_corners_inside`` unless all four corner conditions
    came to hold. ``period`` counts excitation periods where the run settled, else 0.
    """

    outcome: float
    reason: float
    time: float
    tau_align: float
    tau_corners_inside: float
    tilt_at_alignment: float
    tilt_max: float
    separations: float
    contact_force_max: float
    sticking_share: float
    rhs_evaluations: float
    steps: float
    rejected: float
    switches: float
    period: float
    tracked: float


# (runs, i): the ``Constants`` of run ``i``.
constants_of = reader(Constants, "runs, i", "runs[i, {}]".format)
# (runs, row, i): the ``State`` of run ``i`` from column ``row`` on; and (q, runs, row, i) to keep.
state_in = reader(State, "runs, row, i", "runs[i, row + {}]".format)
keep_state_in = writer(State, "runs, row, i", "runs[i, row + {}]".format)
# (runs, i): the ``Mode`` of run ``i``; and (mode, runs, i) to keep.
mode_of = reader(Mode, "runs, i", "runs[i, MODE + {}]".format, MODE=MODE)
keep_mode = writer(Mode, "runs, i", "runs[i, MODE + {}]".format, MODE=MODE)


@inlined_kernel
def constants_in(row):
    """Return the ``Constants`` in ``row``, shape (constants,)."""
    return constants_of(row.reshape((1, CONSTANTS)), 0)


@inlined_kernel
def keep_state(q, runs, i):
    """Make ``q`` the state of run ``i``."""
    keep_state_in(q, runs, STATE, i)


@kernel
def keep_ending(ending, endings, row):
    """Write an ``Ending`` into ``endings[row]``."""
    for field in range(len(ending)):
        endings[row, field] = ending[field]


@kernel
def ending_of(runs, i):
    """The ``Ending`` of run ``i``."""
    tau_align = runs[i, TAU_ALIGN]
    until = runs[i, TIME] if isnan(tau_align) else tau_align
    return Ending(
        runs[i, OUTCOME], runs[i, REASON], runs[i, TIME], tau_align, runs[i, TAU_CORNERS_INSIDE],
        runs[i, TILT_AT_ALIGNMENT], runs[i, TILT_MAX], runs[i, SEPARATIONS], runs[i, FORCE_MAX],
        runs[i, STICKING_TIME] / until if until > 0.0 else 0.0, runs[i, EVALUATIONS],
        runs[i, STEPS], runs[i, REJECTED], runs[i, SWITCHES], runs[i, SETTLED_PERIOD],
        runs[i, TRACKED],
    )  # fmt: skip
