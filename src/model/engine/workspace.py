"""The SIMD workspace: WIDTH runs in the same kind of mode, one in each lane of a vector.

A line of the workspace ``w`` holds one number per lane: line n of lane i is ``w[n, i]``.
Loops over lanes are plain arithmetic, so that the compiler vectorizes them; the series are written
for vectors (series_code.py). scheduling.py copies runs into lanes, step.py fills the other lines,
and event_search.py, peaks.py and carried_error.py read them lane by lane.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.compile.kernels import inlined_kernel
from model.compile.vector_code import WIDTH
from model.engine.series import GIVEN, EventQuantities
from model.engine.series_layout import FURTHER_LINES, LINES, NODES, ORDERS, SINES, TILT
from model.events.table import PLACES_OF_CONTACT
from model.physics.modes import MODE_KINDS, START, Mode
from model.physics.notation import STATE_SIZE, State

# Lines: constants and signs of the slips, the mode, then numbers of the lanes and of their step.
MODE_LINE = GIVEN  # in the order of ``Mode``
(
    TIME,
    HALT,  # time at which the step must end
    TOLERANCE,
    LONGEST,  # step
    STEP_LENGTH,
    APPLICABLE,  # mask of the events that may apply in the mode
    CANDIDATES,  # mask of the events that may happen in the step
    LAST_ORDER,  # of the states' series
    ERROR_ORDER,  # of the error's series that a lane sums
    FILLED_ORDER,  # of the error's series; the first lane counts
) = range(MODE_LINE + len(Mode._fields), MODE_LINE + len(Mode._fields) + 10)
END = FILLED_ORDER + 1
ERROR_AT_END = END + STATE_SIZE  # the error that a run carries, at the end of the step
ERROR = (
    ERROR_AT_END + STATE_SIZE
)  # series of the error that a run carries, in the layout of COEFFICIENTS
# The tilt and the event quantities at each node, and their curvature bounds.
VALUES = ERROR + ORDERS * (LINES + FURTHER_LINES)
COEFFICIENTS = VALUES + (NODES + 1) * SINES
EVENT_LINES = COEFFICIENTS + ORDERS * (LINES + FURTHER_LINES)  # lines of the events follow

LINE = {"tilt": TILT} | {name: STATE_SIZE + n for n, name in enumerate(EventQuantities._fields)}
FACE_LOAD, SIDE_LOAD, CORNER_LOAD, WALL_LOAD = (
    LINE[f"{contact}_load"] for contact in ("face", "side", "corner", "wall")
)
EDGE, CORNER, SIDE, WALL = map(PLACES_OF_CONTACT.index, ("edge", "corner", "side", "wall"))
CONTACTS_AT = FACE_LOAD  # the first line that is neither a state nor a place


@inlined_kernel
def loads_of(mode):
    """Return (line, normal state, index in ``PLACES_OF_CONTACT``) of the load of each contact."""
    return (
        (FACE_LOAD, mode.face, SIDE if mode.in_slot else EDGE),
        (CORNER_LOAD, mode.corner, WALL if mode.in_slot else CORNER),
        (SIDE_LOAD, mode.side, SIDE),
        (WALL_LOAD, mode.wall, WALL),
    )


_CACHE_LINE = 64  # bytes


def new_workspace(lines: int) -> NDArray[np.float64]:
    """Return a workspace, shape (lines, WIDTH), aligned to cache lines."""
    count, more = lines * WIDTH, _CACHE_LINE // 8
    numbers = np.zeros(count + more)
    first = -numbers.ctypes.data % _CACHE_LINE // 8
    return numbers[first : first + count].reshape(lines, WIDTH)


@inlined_kernel
def _given_in(symbol, w, i):
    """Return a constant of lane ``i``, of which ``symbols_of`` tells the line."""
    return symbol if isinstance(symbol, float) else w[symbol.constant[1], i]


@inlined_kernel
def constants_of_lane(lanes, w, i):
    """Return the constants of lane ``i``, of a plane part or a round one."""
    return lanes.events.constants(*(_given_in(symbol, w, i) for symbol in lanes.symbols))


@inlined_kernel
def state_in_lane(w, first, i):
    """Return the ``State`` of lane ``i`` from line ``first`` on."""
    return State(*(w[first + n, i] for n in range(STATE_SIZE)))


@inlined_kernel
def store_state_in_lane(q, w, first, i):
    """Write a ``State`` of lane ``i`` from line ``first`` on."""
    for n, value in enumerate(q):
        w[first + n, i] = value


# Numbers of the fields of ``Mode`` that vary in the alignment scene; others are as in ``START``.
VARIED = tuple(
    n
    for n, name in enumerate(Mode._fields)
    if name not in ("in_slot", "wall", "slip_at_wall", "corners_inside")
)


@inlined_kernel
def mode_of_lane(lanes, w, i):
    """Return the ``Mode`` of lane ``i``; ``lanes.varied`` are the fields that differ."""
    fields: Any = tuple(
        kind(w[MODE_LINE + n, i]) if n in lanes.varied else START[n]
        for n, kind in enumerate(MODE_KINDS)
    )
    return Mode(*fields)


@inlined_kernel
def copy_mode(lanes, runs, i, first, w, lane):
    """Copy the mode of run ``i``, which begins at column ``first``, into a lane."""
    for n in lanes.varied:
        w[MODE_LINE + n, lane] = runs[i, first + n]


@inlined_kernel
def lowest_bit(mask):
    """Return the index of the lowest set bit: the exponent of its value as a float."""
    return (np.float64(mask & -mask).view(np.int64) >> 52) - 1023
