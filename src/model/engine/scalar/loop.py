"""The reference engine, one run at a time: step, locate the first event, apply its transition."""

from math import isfinite, sqrt
from typing import NamedTuple

import numpy as np

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.engine.lifecycle import (
    History,
    apply_event,
    begin,
    end_step,
    fail,
    new_history,
    note_step,
    notes_forces,
)
from model.engine.queue import is_stopped, next_in
from model.engine.rates import are_finite, is_too_short, moved
from model.engine.record import (
    AT,
    CLOSEST,
    FORCES,
    SIZE,
    STATE,
    constants_of,
    is_watched,
    mode_of,
    state_in,
    store_result,
    store_state,
)
from model.engine.results import TRACK_VARIABLES
from model.engine.scalar.location import NO_EVENT, NODE_PLACES, NODES, first_event, sample_step
from model.engine.scalar.peaks import largest_force, largest_tilt
from model.engine.scalar.step import (
    CAUTION,
    LEAST_GROWTH,
    LEAST_SHRINKING,
    MOST_GROWTH,
    dense_output,
    error_estimate,
    interpolate,
    right_hand_side,
    state_of,
    store_in,
    take_step,
)
from model.engine.scalar.tableaux import DOP853
from model.events.event_functions import NEVER, ON_AN_EVENT
from model.events.friction import hold_sticking
from model.events.kernels import MOST_SAMPLES, force_on, level, sample_into
from model.events.outcomes import REASON
from model.events.transitions import CONTINUES
from model.physics.motion import contact_rate
from model.physics.notation import STATE_SIZE

TRACK_COLUMNS = 1 + len(TRACK_VARIABLES)  # time and the variables
_MOST_SECANTS = 6
# Where the tolerance times a contact's rate (``contact_rate``) exceeds _LOOSE, a step spans at most
# _MOST_RADIANS of its oscillation: longer ones are stable, but their dense output is not accurate.
_MOST_RADIANS, _LOOSE = 3.0, 1e-6
EVENT_RESOLUTION = 3e-3  # last correction of an event's time over sqrt(tolerance)


class Workspace(NamedTuple):
    """Arrays of one step.

    Shapes: y, y_end, trial (6,), k (m, 6), dense (6, degree), nodes and samples as in
    ``sample_step``, scratch (1, MOST_SAMPLES).
    """

    y: np.ndarray
    y_end: np.ndarray
    trial: np.ndarray
    k: np.ndarray
    dense: np.ndarray
    nodes: np.ndarray
    samples: np.ndarray
    scratch: np.ndarray


def new_workspace() -> Workspace:
    """Return a ``Workspace``."""
    m, degree = DOP853.dense.shape
    shapes = (STATE_SIZE,), (STATE_SIZE,), (STATE_SIZE,), (m, STATE_SIZE), (STATE_SIZE, degree)
    samples = (NODES, STATE_SIZE), (NODES, MOST_SAMPLES), (1, MOST_SAMPLES)
    return Workspace(*(np.zeros(shape) for shape in (*shapes, *samples)))


@inlined_kernel
def _accepted_step(time, h, y, p, mode, tolerance, work):
    """Shrink ``h`` until a step is accepted; return (h, next h, number of rejected steps).

    Both lengths are 0 if the step falls below the resolution of time.
    """
    rejected = 0
    while True:
        take_step(time, h, y, p, mode, work.k, work.y_end)
        error = error_estimate(h, y, work.y_end, work.k, tolerance)
        if error <= 1.0:
            growth = MOST_GROWTH
            if error > 0.0:
                growth = min(growth, CAUTION * error ** (-1.0 / DOP853.order))
            return h, h * max(growth, LEAST_GROWTH), rejected
        rejected += 1
        shrinking = CAUTION * error ** (-1.0 / DOP853.order) if isfinite(error) else 0.0
        h *= max(LEAST_SHRINKING, shrinking)
        if is_too_short(h, time):
            return 0.0, 0.0, rejected


@kernel
def _secant_to_event(events, which, f, by, time, length, h, y, p, mode, resolution, work):
    """Move the step's end by ``by``, then by the secant method while it halves the level.

    It serves levels so flat that the dense output does not show their zeros. Returns and writes the
    same as ``_step_to_event``.
    """
    taken = 0
    for _ in range(_MOST_SECANTS):
        if not 0.0 < length + by <= h:
            break
        take_step(time, length + by, y, p, mode, work.k, work.y_end)
        taken += 1
        g = level(events, which, time + length + by, state_of(work.y_end), p, mode)
        if not abs(g) < 0.5 * abs(f):
            break
        length, by, f = length + by, -g * by / (g - f), g
        if abs(by) <= resolution:
            rates = state_of(work.k[DOP853.stages])
            store_in(moved(state_of(work.y_end), by, rates), work.y_end)
            return length + by, taken
    take_step(time, length, y, p, mode, work.k, work.y_end)
    return length, taken + 1


@kernel
def _step_to_event(events, which, theta, time, h, y, p, mode, resolution, work):
    """Repeat the step up to the event: (length, steps taken), the state in ``work.y_end``.

    Newton's iteration repeats whole steps and takes only the level's slope from the dense output:
    the event is as accurate as a step. A last correction below ``resolution`` moves the state along
    its rates.
    """
    length = theta * h
    if length == 0.0:
        store_in(state_of(y), work.y_end)
        return 0.0, 0
    near = 1e-3
    low, high = max(theta - near, 0.0), min(theta + near, 1.0)
    before, after = interpolate(low, h, y, work.dense), interpolate(high, h, y, work.dense)
    f_low = level(events, which, time + low * h, before, p, mode)
    f_high = level(events, which, time + high * h, after, p, mode)
    slope = (f_high - f_low) / ((high - low) * h)
    taken = 0
    for _ in range(4):
        take_step(time, length, y, p, mode, work.k, work.y_end)
        taken += 1
        f = level(events, which, time + length, state_of(work.y_end), p, mode)
        correction = -f / slope if slope < 0.0 else 0.0
        if abs(correction) > near * h:
            length, more = _secant_to_event(
                events, which, f, correction, time, length, h, y, p, mode, resolution, work
            )
            return length, taken + more
        better = min(max(length + correction, 0.0), h)
        if abs(better - length) <= resolution:
            rates = state_of(work.k[DOP853.stages])
            store_in(moved(state_of(work.y_end), better - length, rates), work.y_end)
            length = better
            break
        if taken < 4:
            length = better
    return length, taken


@kernel
def track_sample(events, track, time, q, sample, runs, i):
    """Append a row to the track; a full track overwrites its oldest row."""
    row, rows = int(runs[i, AT.tracked]), track.shape[0]
    runs[i, AT.tracked] = row + 1
    if rows > 0:
        row = row % rows if row >= rows else row
        track[row, 0] = time
        store_in(q, track[row, 1 : 1 + STATE_SIZE])
        track[row, 7] = max(force_on(events, "support", sample), 0.0)
        track[row, 8] = max(force_on(events, "side", sample), 0.0)
        track[row, 9] = max(force_on(events, "right", sample), 0.0)


@kernel
def track_run(events, track, scratch, runs, i):
    """Write the present state of a run into its track, with the forces of its mode."""
    time, q = runs[i, AT.time], state_in(runs, STATE, i)
    if track.shape[0] > 0:
        sample_into(events, time, q, constants_of(events, runs, i), mode_of(runs, i), scratch)
    track_sample(events, track, time, q, scratch, runs, i)


@inlined_kernel
def note_closest(events, samples, last, runs, i):
    """Lower the run's closest approaches by the samples of a step.

    A level that starts at zero is left out: a mode starts at zeros of its own levels, and to leave
    one is not to approach an event.
    """
    for which in range(events.count):
        if samples[0, which] != NEVER and samples[0, which] > ON_AN_EVENT:
            lowest = runs[i, CLOSEST + which]
            for node in range(1, last + 1):
                lowest = min(lowest, samples[node, which])
            runs[i, CLOSEST + which] = lowest


@separate_kernel
def advance(scene, control, track, history, work, runs, i):
    """Advance run ``i`` by one step, or up to the first event in it."""
    time, p, mode = runs[i, AT.time], constants_of(scene.events, runs, i), mode_of(runs, i)
    y, tolerance, h = work.y, runs[i, AT.tolerance], runs[i, AT.next_step]
    store_in(state_in(runs, STATE, i), y)
    stop = min(runs[i, AT.stop], runs[i, AT.halt])
    is_stop, rate = stop == runs[i, AT.stop], contact_rate(p, mode)
    if tolerance * rate > _LOOSE:
        h = min(h, _MOST_RADIANS / rate)
    h_try = stop - time if time + 1.0001 * h >= stop else h
    right_hand_side(time, y, p, mode, work.k[0])
    h_step, h_next, rejected = _accepted_step(time, h_try, y, p, mode, tolerance, work)
    runs[i, AT.rhs_evaluations] += 1 + (1 + rejected) * DOP853.stages
    runs[i, AT.rejected] += rejected
    if h_step == 0.0:
        reason = REASON.STEP_TOO_SMALL if are_finite(state_of(work.k[0])) else REASON.NOT_FINITE
        fail(scene, runs, i, reason)
        return
    dense_output(time, h_step, y, p, mode, work.k, work.trial, work.dense)
    runs[i, AT.rhs_evaluations] += DOP853.c.size - DOP853.stages - 1
    sample_step(scene.events, time, h_step, 1.0, y, work.dense, p, mode, work.nodes, work.samples)
    which, theta = first_event(scene.events, time, h_step, y, work.dense, p, mode, work.samples)
    found = theta != NO_EVENT
    length, last, part = h_step, NODES - 1, 1.0
    if found:
        while NODE_PLACES[last] > theta:
            last -= 1
        resolution = EVENT_RESOLUTION * sqrt(tolerance)
        length, taken = _step_to_event(
            scene.events, which, theta, time, h_step, y, p, mode, resolution, work
        )
        runs[i, AT.rhs_evaluations] += taken * DOP853.stages
    if is_watched(runs, i):
        note_closest(scene.events, work.samples, last, runs, i)
    for node in range(1, last + (0 if found else 1)):
        at, q = time + NODE_PLACES[node] * h_step, state_of(work.nodes[node])
        track_sample(scene.events, track, at, q, work.samples[node], runs, i)
    if found:
        part = length / h_step
        sample_step(
            scene.events, time, h_step, part, y, work.dense, p, mode, work.nodes, work.samples
        )
    dense = part, time, h_step, y, work.dense, p, mode, work.nodes, work.samples, work.scratch[0]
    tilt = largest_tilt(scene.events, runs[i, AT.tilt_max], *dense)
    note_step(scene, length, max(tilt, abs(work.y_end[2])), runs, i)
    if notes_forces(scene, mode, control, runs, i):
        for number, place in scene.events.loads:
            force = largest_force(scene.events, number, runs[i, FORCES + place], *dense)
            runs[i, FORCES + place] = force

    store_state(state_of(work.y_end), runs, i)
    reached_stop = not found and h_step == h_try and h_try == stop - time
    runs[i, AT.time] = stop if reached_stop else time + length
    # A step shortened by a stop is no reason for a shorter next step.
    runs[i, AT.next_step] = max(h, h_next) if h_step == h_try and h_try != h else h_next
    if found:
        track_run(scene.events, track, work.scratch[0], runs, i)
        apply_event(which, length, h_step, scene, control, runs, i)
        track_run(scene.events, track, work.scratch[0], runs, i)
    else:
        store_state(hold_sticking(state_in(runs, STATE, i), p, mode), runs, i)
    end_step(scene, reached_stop and is_stop, history, control, runs, i)


class ScalarMemory(NamedTuple):
    """Memory for one run at a time: its record, shape (1, SIZE), history and workspace."""

    runs: np.ndarray
    history: History
    work: Workspace


def new_scalar_memory() -> ScalarMemory:
    """Return a ``ScalarMemory``."""
    return ScalarMemory(np.zeros((1, SIZE)), new_history(1), new_workspace())


@kernel
def integrate(row, tolerance, scene, control, track, queue, memory):
    """Run one parameter set to its end.

    ``row``, shape (constants,), holds the fields of ``Constants``; ``tolerance`` is the largest
    local error of a step, relative to 1 + |state|; ``memory``, a ``ScalarMemory``, is overwritten.
    ``track``, shape (rows, 10), is filled with time, state and normal forces of support, left and
    right side. If it is shorter than ``RunResult.tracked``, the number of rows of the whole run, it
    holds the last ones: row n of the run is row n modulo ``rows``.
    """
    runs, history, work = memory.runs, memory.history, memory.work
    i = 0
    begin(row, tolerance, scene, control, runs, i)
    track_run(scene.events, track, work.scratch[0], runs, i)
    while runs[i, AT.outcome] == CONTINUES and not is_stopped(queue):
        advance(scene, control, track, history, work, runs, i)


@kernel
def integrate_each(rows, tolerances, scene, control, track, queue, results, memory):
    """Integrate the rows of ``rows`` taken from ``queue``; shapes as in ``integrate_all``."""
    row = next_in(queue)
    while row < rows.shape[0] and not is_stopped(queue):
        integrate(rows[row], tolerances[row], scene, control, track, queue, memory)
        store_result(scene.events, memory.runs, 0, results, row)
        row = next_in(queue)
