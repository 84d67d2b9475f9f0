"""The start of a run: its first state and mode, by the kind of its start (physics/approach.py).

Input: the constants of a parameter set. Output: its record, as lifecycle.py continues it. A run
whose start is impossible ends at once.
"""

from math import nan

from model.compile.kernels import kernel, separate_kernel
from model.engine.lifecycle import apply_event, end, fail, note_end_of_period
from model.engine.record import (
    AT,
    CLOSEST,
    CONSTANTS,
    DESCENDS,
    FORCES,
    constants_of,
    store_mode,
    store_state,
)
from model.events.event_functions import FLAT, NEVER
from model.events.friction import decide_friction
from model.events.kernels import start_is_impossible
from model.events.outcomes import OUTCOME, REASON
from model.events.table import PLACES_OF_CONTACT
from model.events.transitions import CONTINUES
from model.physics.approach import PRESSED, RUNNING, descent
from model.physics.geometry import bottom_corner, edge_place, resting_height
from model.physics.modes import CLOSED, OPEN, START
from model.physics.notation import RIGHT_EDGE, State
from model.physics.rest import rest_under_press

_FIRST_STEP = 1e-2


@kernel
def start(p, declared):
    """State and mode at τ = 0: at rest, touching the base without load.

    The bottom face rests on the edge A1; a part tilted the other way rests on its corner B1. A
    contact that is not declared starts open: the run leaves the scene if the part presses there.
    """
    x, tilt = p.misalignment, p.initial_tilt
    y = resting_height(p)
    corner_x, corner_y = bottom_corner(RIGHT_EDGE, x, y, tilt, p)
    if tilt < -FLAT and corner_x > p.slot_half_width:
        standing = CLOSED if declared.corner_on_flat else OPEN
        mode = START._replace(face=OPEN, corner=standing)
        return State(x, y - corner_y, tilt, 0.0, 0.0, 0.0), mode
    mode = START._replace(face=CLOSED if declared.edge_on_face else OPEN)
    return State(x, y, tilt, 0.0, 0.0, 0.0), mode


@kernel
def _start_pressed(scene, p, i, runs):
    """State and mode at τ = 0 at rest on A1 under the press; the run ends if there is no rest."""
    rest = rest_under_press(p)
    if not rest.found:
        end(scene, runs, i, OUTCOME.LEFT_SCENE, REASON.NO_REST)
    return State(rest.x, rest.y, rest.tilt, 0.0, 0.0, 0.0), START


@kernel
def _start_descent(q, is_running, p, i, runs):
    """State and mode of a part in steady descent, from that in which it touches the base."""
    at = descent(q.y, is_running, p)
    runs[i, AT.stage], runs[i, AT.ramp_end] = DESCENDS, at.ramp_end
    runs[i, AT.deadline] += at.ramp_end
    if not is_running:
        runs[i, AT.held_frequency], runs[i, AT.held_phase] = p.frequency, p.phase
        runs[i, AT.frequency], runs[i, AT.phase] = 0.0, 0.0
    return q._replace(y=at.y, y_rate=at.y_rate), START._replace(face=OPEN)


@kernel
def _starts_past_the_end(q, p, mode):
    """Return whether A1 is already beyond the corner B1, so that no load occurs."""
    if mode.face != CLOSED:
        return False
    return edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p).along_face > p.half_width


@separate_kernel
def begin(row, tolerance, scene, control, runs, i):
    """Start the parameter set ``row``, shape (constants,), as run ``i``.

    ``tolerance`` is the largest local error of a step, relative to 1 + |state|.
    """
    for k in range(runs.shape[1]):
        runs[i, k] = row[k] if k < CONSTANTS else 0.0
    p = constants_of(scene.events, runs, i)
    runs[i, AT.tolerance], runs[i, AT.deadline] = tolerance, control.horizon
    runs[i, AT.outcome], runs[i, AT.next_step] = CONTINUES, _FIRST_STEP
    known = 0.0 if control.carries_error != 0.0 else nan
    runs[i, AT.time_error], runs[i, AT.end_error], runs[i, AT.largest_error] = known, known, known
    runs[i, AT.tau_align], runs[i, AT.tau_corners_inside] = nan, nan
    runs[i, AT.tilt_at_alignment], runs[i, AT.tau_inserted] = nan, nan
    if control.alignment_only != 0.0:
        runs[i, AT.tilt_max] = nan  # and stays so; see note_step
        for place in range(len(PLACES_OF_CONTACT)):
            runs[i, FORCES + place] = nan
    for which in range(scene.events.count):
        runs[i, CLOSEST + which] = NEVER
    q, mode = start(p, scene.declared)
    if control.start == PRESSED and not _starts_past_the_end(q, p, mode):
        q, mode = _start_pressed(scene, p, i, runs)
    if control.start >= RUNNING:
        q, mode = _start_descent(q, control.start == RUNNING, p, i, runs)
        p = constants_of(scene.events, runs, i)
    runs[i, AT.tilt_max] = max(runs[i, AT.tilt_max], abs(q.tilt))  # 0 before, or NaN
    if runs[i, AT.outcome] == CONTINUES and start_is_impossible(scene.events, q, p, mode):
        fail(scene, runs, i, REASON.IMPOSSIBLE_START)
    if runs[i, AT.outcome] == CONTINUES:
        mode, possible = decide_friction(0.0, q, p, mode, True, True)
        if not possible:
            fail(scene, runs, i, REASON.NO_FRICTION_SOLUTION)
    store_state(q, runs, i)
    store_mode(mode, runs, i)
    note_end_of_period(scene, runs, i)
    if runs[i, AT.outcome] == CONTINUES and _starts_past_the_end(q, p, mode):
        apply_event(scene.events.face_end, 0.0, _FIRST_STEP, scene, control, runs, i)
