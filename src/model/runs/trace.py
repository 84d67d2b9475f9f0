"""Trace of a run: its track with the mode, the contact forces and the event of every row."""

from typing import Any, NamedTuple

import numpy as np

from model.compile.jit import kernel
from model.compile.views import numbers, reader, writer
from model.engines.lifecycle import begin
from model.engines.record import AT, MADE, constants_of, mode_of, store_result
from model.engines.results import TRACK_VARIABLES, RunResult
from model.engines.scalar.loop import TRACK_COLUMNS, advance, new_scalar_memory, track_run
from model.events.kernels import MOST_EVENTS
from model.events.transitions import CONTINUES
from model.physics.modes import Mode
from model.physics.motion import Motion, motion
from model.physics.notation import State
from model.physics.parameters import Batch, Parameters
from model.runs.engines import Array
from model.runs.settings import Settings

# The contact forces of ``Motion``: loads and friction.
_FORCES: Any = numbers("_FORCES", [n for n in Motion._fields if n.endswith(("load", "friction"))])
_EVENT = TRACK_COLUMNS
_FIRST_MODE = _EVENT + 1
_FIRST_FORCE = _FIRST_MODE + len(Mode._fields)
COLUMNS = (
    "time", *TRACK_VARIABLES, "event",
    *(f"mode_{name}" for name in Mode._fields), *(f"at_{name}" for name in _FORCES._fields),
)  # fmt: skip
"""Columns of a track: time, variables, number from 1 of the event just passed, mode, forces."""

_USUAL_TRACK = 4096  # rows; a longer one is run again with enough rows
_store_mode = writer(Mode, "track, row", lambda n: f"track[row, {_FIRST_MODE + n}]")
_store_forces = writer(_FORCES, "track, row", lambda n: f"track[row, {_FIRST_FORCE + n}]")
_state_at = reader(State, "track, row", lambda n: f"track[row, {n + 1}]")


@kernel
def _note_modes(mode, event, track, first, end, p):
    """Write event, mode and forces of the rows ``first`` to ``end`` of a track."""
    for row in range(first, min(end, track.shape[0])):
        track[row, _EVENT] = event
        _store_mode(mode, track, row)
        _store_forces(motion(track[row, 0], _state_at(track, row), p, mode), track, row)


@kernel
def _mark_events(runs, i):
    """Set ``MADE`` to 2 for the events so far, so that the next event is the only 1."""
    for which in range(MOST_EVENTS):
        if runs[i, MADE + which] != 0.0:
            runs[i, MADE + which] = 2.0


@kernel
def _next_event(runs, i):
    """Return the number of the event since ``_mark_events``, counted from 1."""
    for which in range(MOST_EVENTS):
        if runs[i, MADE + which] == 1.0:
            return which + 1.0
    return 0.0


@kernel
def integrate_trace(row, tolerance, scene, method, control, track, memory):
    """Integrate as ``integrate`` does, with event, mode and forces in the track; see ``COLUMNS``.

    At an event two rows have the same time, before and after it; the second has its number.
    """
    runs, history, work = memory.runs, memory.history, memory.work
    i = runs.shape[0] - 1
    begin(row, tolerance, scene, control, runs, i)
    track_run(scene.events, track, work.scratch, runs, i)
    p = constants_of(runs, i)
    _note_modes(mode_of(runs, i), 0.0, track, 0, 1, p)
    while runs[i, AT.outcome] == CONTINUES:
        first, events, before = int(runs[i, AT.tracked]), runs[i, AT.events], mode_of(runs, i)
        _mark_events(runs, i)
        advance(scene, method, control, track, history, work, runs, i)
        end = int(runs[i, AT.tracked])
        if runs[i, AT.events] != events:
            end -= 1
            _note_modes(mode_of(runs, i), _next_event(runs, i), track, end, end + 1, p)
        _note_modes(before, 0.0, track, first, end, p)


class Trace(NamedTuple):
    """Results of a run by name, and its track, shape (rows, columns); see ``COLUMNS``."""

    results: dict[str, float]
    track: Array


def trace_run(parameters: Parameters, settings: Settings) -> Trace:
    """Run one parameter set once, without an estimate of the error; dimensionless."""
    (row,) = settings.rows(Batch.stack([parameters]))
    scene, method, control = settings.for_kernels
    rows = _USUAL_TRACK
    while True:
        memory, track = new_scalar_memory(method), np.empty((rows, len(COLUMNS)))
        integrate_trace(row, settings.tolerance, scene, method, control, track, memory)
        results = np.empty((1, len(RunResult._fields)))
        store_result(memory.runs, 0, results, 0)
        found = RunResult(*results[0].tolist())
        if found.tracked <= rows:
            return Trace(found._asdict(), track[: int(found.tracked)])
        rows = int(found.tracked)
