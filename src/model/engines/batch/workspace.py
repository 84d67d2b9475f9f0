"""The SIMD workspace: WIDTH runs in the same kind of mode, one in each lane of a vector.

A row of the workspace ``w`` holds one number per lane: row r of lane i is ``w[r * WIDTH + i]``.
Loops over lanes are plain arithmetic, so that the compiler vectorizes them; the series are written
for vectors (series_code.py).

Lanes hold the modes in which the part rests on A1 or flies, alone or with A2 on its left side face;
in the slot also those with an edge on one side, or with A1 and B1 on the right and A2 on the left
(``PAIRS``). Other modes, and readings of the printed equations, are left to the reference engine.
"""

import numpy as np

from model.engines.batch.series import (
    BETWEEN_EDGES,
    CONSISTENT,
    FLUSH,
    GIVEN,
    ON_EDGE,
    ON_WALL,
    UNDER_EDGE,
    Watched,
)
from model.engines.batch.series_plan import (
    ERROR_ORDER,
    FURTHER_ROWS,
    NODES,
    ORDERS,
    ROWS,
    SINES,
    TILT,
    WIDTH,
)
from model.engines.scalar.tableaux import Array
from model.physics.compiled import inlined_kernel
from model.physics.notation import RIGHT_EDGE, STATE_SIZE, State
from model.physics.parameters import Constants
from model.physics.scenes import CLOSED, OPEN, Mode
from model.physics.views import reader

# Rows: the constants and signs of the slips, then numbers of the lanes, and of their step.
(
    TIME,
    DEADLINE,
    TOLERANCE,
    LONGEST,  # step
    FACE,
    SUPPORT_SLIP_STATE,
    SIDE,
    SIDE_SLIP_STATE,
    DROPPED,
    CORNER,
    IN_SLOT,
    WALL,
    CORNERS_INSIDE,
    LENGTH,
    CANDIDATES,  # mask of the events that may happen in the step
    STEP_TILT,  # upper bound of |tilt| in the step
    STEP_FORCE,  # upper bound of the normal forces in the step
    LAST_ORDER,  # of the states' series
) = range(GIVEN, GIVEN + 18)
END = LAST_ORDER + 1
ERROR = END + STATE_SIZE  # series of the error that a run carries
# The tilt and the watched rows at each node, and their curvature bounds.
VALUES = ERROR + (ERROR_ORDER + 1) * STATE_SIZE
COEFFICIENTS = VALUES + (NODES + 1) * SINES
EVENT_ROWS = COEFFICIENTS + ORDERS * (ROWS + FURTHER_ROWS)  # rows of the events follow

CONTACTS_AT = STATE_SIZE + Watched._fields.index("face_load")
ROW = {"tilt": TILT} | {name: STATE_SIZE + n for n, name in enumerate(Watched._fields)}
_CACHE_LINE = 64  # bytes


def new_workspace(rows: int) -> Array:
    """Return a workspace of ``rows`` rows, aligned to cache lines."""
    count, line = rows * WIDTH, _CACHE_LINE // 8
    numbers = np.zeros(count + line)
    first = -numbers.ctypes.data % _CACHE_LINE // 8
    return numbers[first : first + count]


# (w, i): ``Constants`` of lane ``i``, consistent readings.
_PLACES = {row: place for place, row in enumerate(CONSISTENT)}
constants_of_lane = reader(
    Constants,
    "w, i",
    lambda n: f"w[{_PLACES[n]} * WIDTH + i]" if n in _PLACES else "0.0",
    WIDTH=WIDTH,
)
# (w, row, i): the ``State`` of lane ``i`` from ``row`` on.
state_in_lane = reader(State, "w, row, i", "w[(row + {}) * WIDTH + i]".format, WIDTH=WIDTH)


@inlined_kernel
def mode_of_lane(w, i):
    """Return the ``Mode`` of lane ``i``."""
    return Mode(
        RIGHT_EDGE,
        int(w[FACE * WIDTH + i]),
        OPEN,
        0.0,
        False,
        int(w[SUPPORT_SLIP_STATE * WIDTH + i]),
        int(w[SIDE * WIDTH + i]),
        int(w[SIDE_SLIP_STATE * WIDTH + i]),
        w[DROPPED * WIDTH + i] != 0.0,
        False,
        OPEN,
        False,
        False,
    )


@inlined_kernel
def mode_of_lane_in_slot(w, i):
    """Return the ``Mode`` of lane ``i`` in the insertion scene."""
    corner, wall = int(w[CORNER * WIDTH + i]), int(w[WALL * WIDTH + i])
    return Mode(
        RIGHT_EDGE,
        int(w[FACE * WIDTH + i]),
        corner,
        0.0,
        corner == CLOSED,
        int(w[SUPPORT_SLIP_STATE * WIDTH + i]),
        int(w[SIDE * WIDTH + i]),
        int(w[SIDE_SLIP_STATE * WIDTH + i]),
        w[DROPPED * WIDTH + i] != 0.0,
        w[IN_SLOT * WIDTH + i] != 0.0,
        wall,
        wall == CLOSED,
        w[CORNERS_INSIDE * WIDTH + i] != 0.0,
    )


@inlined_kernel
def pair_of(mode):
    """Return the pair of contacts in which lanes hold this mode; -1 if they cannot."""
    face, corner, side = mode.face != OPEN, mode.corner != OPEN, mode.side != OPEN
    wall = mode.wall != OPEN
    if mode.edge != RIGHT_EDGE:
        return -1
    if (corner and not mode.in_slot) or (wall and (side or corner)):
        return -1
    if face and not mode.in_slot:
        return -1 if wall else ON_EDGE
    if wall:
        return UNDER_EDGE
    if corner and face:
        presses = mode.corner == CLOSED and mode.face == CLOSED and mode.slip_at_corner
        return FLUSH if presses else -1
    if corner:
        return ON_WALL
    return BETWEEN_EDGES if face else ON_EDGE
