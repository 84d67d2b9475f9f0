"""The record of a run: one row of numbers, so that a batch of runs is an array.

A batch is an array ``runs`` of shape (runs, SIZE): ``runs[i, AT.time]`` is the time that run ``i``
has reached. Counts and flags are whole numbers stored as floats. The columns are the fields of
``Constants`` and ``RunResult``, working numbers, the state, the mode and, for every event, its
closest approach (lowest level) in this period and whether it happened.
"""

from math import isnan
from typing import Any

from model.compile.kernels import inlined_kernel, kernel
from model.engine.results import RunResult
from model.events.kernels import MOST_EVENTS
from model.events.table import PLACES_OF_CONTACT
from model.physics.geometry import edge_place
from model.physics.modes import CLOSED, MODE_KINDS, OPEN, Mode
from model.physics.notation import RIGHT_EDGE, STATE_SIZE, State
from model.physics.parameters import Constants
from model.physics.tables import numbers

_WORKING = (
    "next_step",  # length proposed by the error estimate
    "tolerance",
    "deadline",  # latest time at which the run ends
    "stop",  # end of the present excitation period, or the deadline
    "halt",  # time at which a step must end: the end of the ramp, a look for rest, or the deadline
    "stage",  # see ``VIBRATES``
    "held_frequency",  # of the vibration, while it has not set in
    "held_phase",
    "periods",  # excitation periods completed
    "watched_until",  # last period whose closest approaches are noted
    "sticking_time",
    "events_at_once",  # number of events without time passing between them
    "number_in_batch",
    "last_event",  # number of the latest event, from 1
    *(f"error_{name}" for name in State._fields),  # that the run carries
)
_COLUMNS = (*Constants._fields, *RunResult._fields, *_WORKING)

AT: Any = numbers("Columns", _COLUMNS)(*range(len(_COLUMNS)))
"""The columns by name."""

CONSTANTS = len(Constants._fields)  # the first columns
_FIRST_RESULT, _RESULT_COUNT = CONSTANTS, len(RunResult._fields)

VIBRATES, DESCENDS, PRESSES = range(3)
"""Stages of a run: it descends before the first touch; pressed, it waits for the vibration."""

ERROR = AT.error_x  # first of the errors that the run carries
FORCES = AT.edge_force_max  # first of the largest forces, in the order of PLACES_OF_CONTACT
STATE = len(_COLUMNS)
MODE = STATE + STATE_SIZE
CLOSEST = MODE + len(Mode._fields)  # lowest levels of the events in this period
MADE = CLOSEST + MOST_EVENTS  # 1 for events that happened in this period
SIZE = MADE + MOST_EVENTS


@inlined_kernel
def constants_of(events, runs, i):
    """Return the constants of run ``i``: of a plane part or a round one, as ``events`` say."""
    return events.constants(*(runs[i, n] for n in range(CONSTANTS)))


@inlined_kernel
def state_in(runs, first, i):
    """Return the ``State`` of run ``i`` from column ``first`` on."""
    return State(*(runs[i, first + n] for n in range(STATE_SIZE)))


@inlined_kernel
def store_state_in(q, runs, first, i):
    """Write a ``State`` of run ``i`` from column ``first`` on."""
    for n, value in enumerate(q):
        runs[i, first + n] = value


@inlined_kernel
def mode_of(runs, i):
    """Return the ``Mode`` of run ``i``."""
    return Mode(*(kind(runs[i, MODE + n]) for n, kind in enumerate(MODE_KINDS)))


@inlined_kernel
def store_mode(mode, runs, i):
    """Write the ``Mode`` of run ``i``."""
    for n, value in enumerate(mode):
        runs[i, MODE + n] = value


@inlined_kernel
def is_watched(runs, i):
    """Return whether closest approaches in the present period may decide if the run settles."""
    return runs[i, AT.periods] < runs[i, AT.watched_until]


@inlined_kernel
def constants_in(events, row):
    """Return the constants in ``row``, shape (constants,); see ``constants_of``."""
    return events.constants(*(row[n] for n in range(CONSTANTS)))


@inlined_kernel
def store_state(q, runs, i):
    """Write ``q`` as the state of run ``i``."""
    store_state_in(q, runs, STATE, i)


@kernel
def store_result(events, runs, i, results, row):
    """Write the ``RunResult`` of run ``i``, which has ended, into ``results[row]``."""
    largest = runs[i, FORCES]
    for place in range(1, len(PLACES_OF_CONTACT)):
        largest = max(largest, runs[i, FORCES + place])
    runs[i, AT.contact_force_max] = largest
    tau_align = runs[i, AT.tau_align]
    until = runs[i, AT.time] if isnan(tau_align) else tau_align
    runs[i, AT.sticking_share] = runs[i, AT.sticking_time] / until if until > 0.0 else 0.0
    mode = mode_of(runs, i)
    alone = mode.edge == RIGHT_EDGE and mode.corner == OPEN and mode.side == OPEN
    runs[i, AT.end_on_edge] = 1.0 if alone and mode.face == CLOSED else 0.0
    q, p = state_in(runs, STATE, i), constants_of(events, runs, i)
    place = edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    approach = q.tilt_rate * place.along_axis - q.x_rate * place.cos - q.y_rate * place.sin
    runs[i, AT.end_gap], runs[i, AT.end_approach] = p.half_width - place.along_face, approach
    runs[i, AT.end_tilt] = q.tilt
    for field in range(_RESULT_COUNT):
        results[row, field] = runs[i, _FIRST_RESULT + field]
