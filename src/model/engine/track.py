"""The track of a run: states, modes and forces over time, from the series of its steps."""

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.engine import workspace
from model.engine.event_search import state_at
from model.engine.record import AT, STATE, constants_of, mode_of, state_in
from model.engine.results import TRACK_VARIABLES
from model.physics.modes import Mode
from model.physics.motion import Motion, motion_at

# The contact forces of ``Motion``: loads and friction.
_FORCES = tuple(name for name in Motion._fields if name.endswith(("load", "friction")))
COLUMNS = (
    "time", *TRACK_VARIABLES, "event",
    *(f"mode_{name}" for name in Mode._fields), *(f"at_{name}" for name in _FORCES),
)  # fmt: skip
"""Columns of a track: time, variables, number from 1 of the event just passed, mode, forces."""
_SAMPLES = 12  # rows of a step


@separate_kernel
def track_row(events, track, time, q, event, runs, i):
    """Append a row to the track, in the mode of run ``i``; a full track takes no more rows."""
    row, mode = int(runs[i, AT.tracked]), mode_of(runs, i)
    runs[i, AT.tracked] = row + 1
    if row < track.shape[0]:
        at = motion_at(time, q, constants_of(events, runs, i), mode)
        load = max(at.support_load, 0.0)
        below, right = (0.0, load) if mode.in_slot else (load, 0.0)
        forces = tuple(getattr(at, name) for name in _FORCES)
        variables = (*q, below, max(at.side_load, 0.0), right)
        for column, value in enumerate((time, *variables, event, *mode, *forces)):
            track[row, column] = value


@inlined_kernel
def track_run(events, track, event, runs, i):
    """Append the present state of run ``i``, after an event of this number or after none."""
    if track.shape[0] > 0:
        track_row(events, track, runs[i, AT.time], state_in(runs, STATE, i), event, runs, i)


@kernel
def track_step(events, track, start, until, w, lane, runs, i):
    """Append the step of a lane up to its fraction ``until``, which run ``i`` has reached."""
    length = w[workspace.STEP_LENGTH, lane]
    for n in range(1, _SAMPLES):
        theta = n / _SAMPLES
        if theta < until:
            track_row(events, track, start + theta * length, state_at(theta, w, lane), 0.0, runs, i)
    track_row(events, track, runs[i, AT.time], state_at(until, w, lane), 0.0, runs, i)
