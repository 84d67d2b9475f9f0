"""The SIMD workspace: WIDTH runs in the same kind of mode, one in each lane of a vector.

A row of the workspace ``w`` holds one number per lane: row r of lane i is ``w[r * WIDTH + i]``.
Loops over lanes are plain arithmetic, so that the compiler vectorizes them; the series are written
for vectors (series_code.py). scheduling.py copies runs into lanes, step.py fills the other rows,
and event_search.py, peaks.py and carried_error.py read them lane by lane.

Lanes hold the modes in which the part rests on A1 or flies, alone or with A2 on its left side face;
in the insertion scene also those on A2, and those in the slot (mode_kinds.py lists their kinds).
Other modes, and printed variants of the equations, are left to the reference engine.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from model.compile.jit import inlined_kernel
from model.compile.vector_code import WIDTH
from model.compile.views import reader, writer
from model.engines.batch.series import GIVEN, LANE_CONSTANTS, EventQuantities
from model.engines.batch.series_layout import FURTHER_ROWS, NODES, ORDERS, ROWS, SINES, TILT
from model.engines.scalar.tableaux import Array
from model.physics.modes import START, Mode
from model.physics.notation import STATE_SIZE, State
from model.physics.parameters import Constants

# Rows: constants and signs of the slips, the mode, then numbers of the lanes and of their step.
MODE = GIVEN  # in the order of ``Mode``
(
    TIME,
    DEADLINE,
    TOLERANCE,
    LONGEST,  # step
    LENGTH,
    APPLICABLE,  # mask of the events that may apply in the mode
    CANDIDATES,  # mask of the events that may happen in the step
    STEP_TILT,  # upper bound of |tilt| in the step
    STEP_FORCE,  # upper bound of the normal forces in the step
    LAST_ORDER,  # of the states' series
) = range(MODE + len(Mode._fields), MODE + len(Mode._fields) + 10)
END = LAST_ORDER + 1
ERROR = END + STATE_SIZE  # series of the error that a run carries, in the layout of COEFFICIENTS
# The tilt and the event quantities at each node, and their curvature bounds.
VALUES = ERROR + ORDERS * (ROWS + FURTHER_ROWS)
COEFFICIENTS = VALUES + (NODES + 1) * SINES
EVENT_ROWS = COEFFICIENTS + ORDERS * (ROWS + FURTHER_ROWS)  # rows of the events follow

ROW = {"tilt": TILT} | {name: STATE_SIZE + n for n, name in enumerate(EventQuantities._fields)}
FACE_LOAD, SIDE_LOAD, CORNER_LOAD, WALL_LOAD = (
    ROW[f"{contact}_load"] for contact in ("face", "side", "corner", "wall")
)
CONTACTS_AT = FACE_LOAD  # the first row that is neither a state nor a place


@inlined_kernel
def loads_of(mode):
    """Return for support and side the pairs (row of the load, normal state) of edge and corner."""
    return (
        ((FACE_LOAD, mode.face), (CORNER_LOAD, mode.corner)),
        ((SIDE_LOAD, mode.side), (WALL_LOAD, mode.wall)),
    )


_CACHE_LINE = 64  # bytes


def new_workspace(rows: int) -> Array:
    """Return a workspace of ``rows`` rows, aligned to cache lines."""
    count, line = rows * WIDTH, _CACHE_LINE // 8
    numbers = np.zeros(count + line)
    first = -numbers.ctypes.data % _CACHE_LINE // 8
    return numbers[first : first + count]


# (w, i): ``Constants`` of lane ``i``, consistent variants.
_PLACES = {row: place for place, row in enumerate(LANE_CONSTANTS)}
constants_of_lane = reader(
    Constants,
    "w, i",
    lambda n: f"w[{_PLACES[n]} * WIDTH + i]" if n in _PLACES else "0.0",
    WIDTH=WIDTH,
)
# (w, row, i): the ``State`` of lane ``i`` from ``row`` on; (q, w, row, i) writes it.
state_in_lane = reader(State, "w, row, i", "w[(row + {}) * WIDTH + i]".format, WIDTH=WIDTH)
store_state_in_lane = writer(State, "w, row, i", "w[(row + {}) * WIDTH + i]".format, WIDTH=WIDTH)


# Fields of ``Mode`` that lanes hold in the alignment scene, and those that they hold as well in the
# insertion scene. All others are as in ``START``.
_VARIED = tuple(map(Mode._fields.index, ("face", "support_slip", "side", "side_slip", "dropped")))
_FIXED = Mode._fields.index("corner_offset")
_VARIED_IN_SLOT = tuple(n for n in range(len(Mode._fields)) if n not in (*_VARIED, _FIXED))


def _mode_reader(varied: Sequence[int]) -> Any:
    """Make the kernel (w, i) that reads the ``Mode`` of lane ``i``."""

    def place(n: int) -> str:
        return f"w[{MODE + n} * WIDTH + i]" if n in varied else repr(START[n])

    return reader(Mode, "w, i", place, WIDTH=WIDTH)


mode_of_lane = _mode_reader(_VARIED)
mode_of_lane_in_slot = _mode_reader(_VARIED + _VARIED_IN_SLOT)


@inlined_kernel
def copy_mode(events, runs, i, first, w, lane):
    """Copy the mode of run ``i``, which begins at column ``first``, into a lane."""
    for n in _VARIED:
        w[(MODE + n) * WIDTH + lane] = runs[i, first + n]
    if events.inserts == 1:
        for n in _VARIED_IN_SLOT:
            w[(MODE + n) * WIDTH + lane] = runs[i, first + n]


@inlined_kernel
def lowest_bit(mask):
    """Return the index of the lowest set bit: the exponent of its value as a float."""
    return (np.float64(mask & -mask).view(np.int64) >> 52) - 1023
