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


@inlined_kernel
def constants_of(runs, i):
    """``Constants`` of run ``i``."""
    return Constants(
        runs[i, 0], runs[i, 1], runs[i, 2], runs[i, 3], runs[i, 4], runs[i, 5], runs[i, 6],
        runs[i, 7], runs[i, 8], runs[i, 9], runs[i, 10], runs[i, 11], runs[i, 12], runs[i, 13],
        runs[i, 14], runs[i, 15], runs[i, 16], runs[i, 17], runs[i, 18], runs[i, 19], runs[i, 20],
        runs[i, 21], runs[i, 22], runs[i, 23], runs[i, 24], runs[i, 25], runs[i, 26],
    )  # fmt: skip


@inlined_kernel
def constants_in(row):
    """``Constants`` from ``row``, shape (constants,)."""
    return constants_of(row.reshape((1, CONSTANTS)), 0)


@inlined_kernel
def state_in(runs, row, i):
    """The ``State`` of run ``i`` kept from ``row`` on."""
    return State(
        runs[i, row], runs[i, row + 1], runs[i, row + 2],
        runs[i, row + 3], runs[i, row + 4], runs[i, row + 5],
    )  # fmt: skip


@inlined_kernel
def keep_state_in(q, runs, row, i):
    """Write ``q`` from ``row`` on."""
    runs[i, row], runs[i, row + 1], runs[i, row + 2] = q.x, q.y, q.tilt
    runs[i, row + 3], runs[i, row + 4], runs[i, row + 5] = q.x_rate, q.y_rate, q.tilt_rate


@inlined_kernel
def keep_state(q, runs, i):
    """Make ``q`` the state of run ``i``."""
    keep_state_in(q, runs, STATE, i)


@inlined_kernel
def mode_of(runs, i):
    """The ``Mode`` of run ``i``."""
    return Mode(
        runs[i, MODE],
        int(runs[i, MODE + 1]),
        int(runs[i, MODE + 2]),
        runs[i, MODE + 3],
        runs[i, MODE + 4] != 0.0,
        int(runs[i, MODE + 5]),
        int(runs[i, MODE + 6]),
        int(runs[i, MODE + 7]),
        runs[i, MODE + 8] != 0.0,
    )


@inlined_kernel
def keep_mode(mode, runs, i):
    """Make ``mode`` the mode of run ``i``."""
    runs[i, MODE] = mode.edge
    runs[i, MODE + 1] = mode.face
    runs[i, MODE + 2] = mode.corner
    runs[i, MODE + 3] = mode.corner_offset
    runs[i, MODE + 4] = mode.slip_at_corner
    runs[i, MODE + 5] = mode.support_slip
    runs[i, MODE + 6] = mode.side
    runs[i, MODE + 7] = mode.side_slip
    runs[i, MODE + 8] = mode.dropped


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
