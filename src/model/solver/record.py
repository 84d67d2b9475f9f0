"""The record of a run: one column of numbers, so that many runs stand side by side.

A batch of runs is an array ``runs`` of shape (ROWS, lanes): ``runs[TIME, i]`` is the time that run
``i`` has reached. Counts and flags are whole numbers kept as floats.
"""

from math import isnan
from typing import NamedTuple

from model.physics.compiled import inlined_kernel, kernel
from model.physics.notation import State
from model.physics.parameters import Constants
from model.physics.scenes import Mode
from model.solver.switching import SWITCH_COUNT

STATE_SIZE = len(State._fields)
CONSTANTS = len(Constants._fields)  # the first rows

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
ROWS = MADE + SWITCH_COUNT


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
        runs[0, i], runs[1, i], runs[2, i], runs[3, i], runs[4, i], runs[5, i], runs[6, i],
        runs[7, i], runs[8, i], runs[9, i], runs[10, i], runs[11, i], runs[12, i], runs[13, i],
        runs[14, i], runs[15, i], runs[16, i], runs[17, i], runs[18, i], runs[19, i], runs[20, i],
        runs[21, i], runs[22, i], runs[23, i], runs[24, i], runs[25, i], runs[26, i],
    )  # fmt: skip


@inlined_kernel
def constants_in(row):
    """``Constants`` from ``row``, shape (constants,)."""
    return constants_of(row.reshape((CONSTANTS, 1)), 0)


@inlined_kernel
def state_in(runs, row, i):
    """The ``State`` of run ``i`` kept from ``row`` on."""
    return State(
        runs[row, i], runs[row + 1, i], runs[row + 2, i],
        runs[row + 3, i], runs[row + 4, i], runs[row + 5, i],
    )  # fmt: skip


@inlined_kernel
def keep_state_in(q, runs, row, i):
    """Write ``q`` from ``row`` on."""
    runs[row, i], runs[row + 1, i], runs[row + 2, i] = q.x, q.y, q.tilt
    runs[row + 3, i], runs[row + 4, i], runs[row + 5, i] = q.x_rate, q.y_rate, q.tilt_rate


@inlined_kernel
def keep_state(q, runs, i):
    """Make ``q`` the state of run ``i``."""
    keep_state_in(q, runs, STATE, i)


@inlined_kernel
def mode_of(runs, i):
    """The ``Mode`` of run ``i``."""
    return Mode(
        runs[MODE, i],
        int(runs[MODE + 1, i]),
        int(runs[MODE + 2, i]),
        runs[MODE + 3, i],
        runs[MODE + 4, i] != 0.0,
        int(runs[MODE + 5, i]),
        int(runs[MODE + 6, i]),
        int(runs[MODE + 7, i]),
        runs[MODE + 8, i] != 0.0,
    )


@inlined_kernel
def keep_mode(mode, runs, i):
    """Make ``mode`` the mode of run ``i``."""
    runs[MODE, i] = mode.edge
    runs[MODE + 1, i] = mode.face
    runs[MODE + 2, i] = mode.corner
    runs[MODE + 3, i] = mode.corner_offset
    runs[MODE + 4, i] = mode.slip_at_corner
    runs[MODE + 5, i] = mode.support_slip
    runs[MODE + 6, i] = mode.side
    runs[MODE + 7, i] = mode.side_slip
    runs[MODE + 8, i] = mode.dropped


@kernel
def keep_ending(ending, endings, row):
    """Write an ``Ending`` into ``endings[row]``."""
    for field in range(len(ending)):
        endings[row, field] = ending[field]


@kernel
def ending_of(runs, i):
    """The ``Ending`` of run ``i``."""
    tau_align = runs[TAU_ALIGN, i]
    until = runs[TIME, i] if isnan(tau_align) else tau_align
    return Ending(
        runs[OUTCOME, i], runs[REASON, i], runs[TIME, i], tau_align, runs[TAU_CORNERS_INSIDE, i],
        runs[TILT_AT_ALIGNMENT, i], runs[TILT_MAX, i], runs[SEPARATIONS, i], runs[FORCE_MAX, i],
        runs[STICKING_TIME, i] / until if until > 0.0 else 0.0, runs[EVALUATIONS, i],
        runs[STEPS, i], runs[REJECTED, i], runs[SWITCHES, i], runs[SETTLED_PERIOD, i],
        runs[TRACKED, i],
    )  # fmt: skip
