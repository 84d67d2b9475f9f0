"""Trace of a run: its track with the mode, the contact forces and the event of every row."""

from functools import partial
from typing import NamedTuple

import numpy as np

from model.compile.entries import compiled
from model.compile.kernels import inlined_kernel, kernel
from model.engine.lifecycle import begin
from model.engine.queue import is_stopped
from model.engine.record import AT, constants_of, mode_of, store_result
from model.engine.results import TRACK_VARIABLES, RunResult
from model.engine.scalar.loop import TRACK_COLUMNS, advance, new_scalar_memory, track_run
from model.engine.scalar.step import state_of
from model.events.transitions import CONTINUES
from model.physics.modes import Mode
from model.physics.motion import Motion, motion
from model.physics.parameters import Batch, Parameters
from model.runs.engines import Array, in_threads
from model.runs.settings import Settings

# The contact forces of ``Motion``: loads and friction.
_FORCES = tuple(name for name in Motion._fields if name.endswith(("load", "friction")))
_EVENT = TRACK_COLUMNS
_FIRST_MODE = _EVENT + 1
_FIRST_FORCE = _FIRST_MODE + len(Mode._fields)
COLUMNS = (
    "time", *TRACK_VARIABLES, "event",
    *(f"mode_{name}" for name in Mode._fields), *(f"at_{name}" for name in _FORCES),
)  # fmt: skip
"""Columns of a track: time, variables, number from 1 of the event just passed, mode, forces."""

_USUAL_TRACK = 4096  # rows; a longer one is run again with enough rows


@inlined_kernel
def _note_mode(mode, event, p, row):
    """Write event, mode and forces into a row of a track."""
    row[_EVENT] = event
    for n, value in enumerate(mode):
        row[_FIRST_MODE + n] = value
    forces = motion(row[0], state_of(row[1:]), p, mode)
    for n, name in enumerate(_FORCES):
        row[_FIRST_FORCE + n] = getattr(forces, name)


@kernel
def _note_modes(mode, event, track, first, end, p):
    """Write event, mode and forces of the rows ``first`` to ``end`` of a track."""
    for n in range(first, min(end, track.shape[0])):
        _note_mode(mode, event, p, track[n])


@kernel
def integrate_trace(constants, tolerance, scene, control, track, results, memory, queue):
    """Integrate as ``integrate`` does, with event, mode and forces in the track; see ``COLUMNS``.

    At an event two rows have the same time, before and after it; the second has its number.
    """
    runs, history, work = memory.runs, memory.history, memory.work
    i = 0
    begin(constants, tolerance, scene, control, runs, i)
    track_run(scene.events, track, work.scratch[0], runs, i)
    p = constants_of(scene.events, runs, i)
    _note_modes(mode_of(runs, i), 0.0, track, 0, 1, p)
    while runs[i, AT.outcome] == CONTINUES and not is_stopped(queue):
        first, events, before = int(runs[i, AT.tracked]), runs[i, AT.events], mode_of(runs, i)
        advance(scene, control, track, history, work, runs, i)
        end = int(runs[i, AT.tracked])
        if runs[i, AT.events] != events:
            end -= 1
            _note_modes(mode_of(runs, i), runs[i, AT.last_event], track, end, end + 1, p)
        _note_modes(before, 0.0, track, first, end, p)
    store_result(scene.events, runs, i, results, 0)


_integrate_trace = compiled(integrate_trace)


class Trace(NamedTuple):
    """Results of a run by name, and its track, shape (rows, columns); see ``COLUMNS``."""

    results: dict[str, float]
    track: Array


def trace_run(parameters: Parameters, settings: Settings) -> Trace:
    """Run one parameter set once, without an estimate of the error; dimensionless."""
    (constants,) = settings.rows(Batch.stack([parameters]))
    scene, control = settings.for_kernels
    rows = _USUAL_TRACK
    while True:
        memory, track = new_scalar_memory(), np.empty((rows, len(COLUMNS)))
        results = np.empty((1, len(RunResult._fields)))
        arguments = constants, settings.tolerance, scene, control, track, results, memory
        in_threads(partial(_integrate_trace, *arguments))
        found = RunResult(*results[0].tolist())
        if found.tracked <= rows:
            return Trace(found._asdict(), track[: int(found.tracked)])
        rows = int(found.tracked)
