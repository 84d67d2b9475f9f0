"""Many runs at once; runs in the same kind of mode share SIMD vectors.

The engine ends here. Input: parameter sets, of which threads take the next from a queue. Output:
their results. Runs wait in queues, one for each kind of mode; the runs of the fullest queue make a
step together (step.py). A step without an event is accepted. Otherwise the run advances to the
first event, located on its series to their full order (event_search.py), without another step.
lifecycle.py has transitions and ends of periods.
"""

from math import isnan
from typing import NamedTuple

import numpy as np

from model.compile.kernels import inlined_kernel, kernel
from model.compile.vector_code import WIDTH
from model.engine import workspace
from model.engine.carried_error import apply_saltation, carry_error, error_of_time
from model.engine.event_search import NO_EVENT, first_event, rates_in_step, state_at
from model.engine.lane_events import (
    QUANTITIES,
    TERMS,
    LaneEvents,
    applicable_in,
    kind_of_mode,
    sample_line,
)
from model.engine.lifecycle import (
    History,
    apply_event,
    carries_error,
    end_period,
    end_step,
    fail,
    new_history,
    note_step,
    notes_forces,
)
from model.engine.peaks import largest_force, largest_tilt
from model.engine.queue import fair_share, is_stopped, next_in
from model.engine.rates import is_too_short
from model.engine.record import (
    AT,
    CLOSEST,
    ERROR,
    FORCES,
    MODE,
    SIZE,
    STATE,
    constants_of,
    is_watched,
    mode_of,
    store_result,
    store_state,
)
from model.engine.series import CORNER_OFFSET, LANE_CONSTANTS, SIDE_SIGN, SUPPORT_SIGN
from model.engine.series_kernels import missing_series
from model.engine.series_layout import NODES, ORDER
from model.engine.short_steps import step_without_series
from model.engine.start import begin
from model.engine.step import step_all
from model.engine.track import COLUMNS, track_run, track_step
from model.engine.workspace import (
    COEFFICIENTS,
    constants_of_lane,
    copy_mode,
    loads_of,
    lowest_bit,
    mode_of_lane,
)
from model.events.event_functions import NEVER, ON_AN_EVENT
from model.events.friction import hold_sticking
from model.events.outcomes import REASON
from model.events.transitions import CONTINUES
from model.physics.modes import CLOSED, Mode
from model.physics.notation import STATE_SIZE

MOST_RUNS = 128  # largest number of runs that a thread has at once
_FIRST_LONGEST = 1.0  # bound of a run's first step
_MOST_GROWTH = 5.0  # of a step, from the one before


# Numbers of a run copied to its lane besides constants, mode and state: (line of the workspace,
# column of the record).
_GATHERED = (
    (SUPPORT_SIGN, MODE + Mode._fields.index("support_slip")),
    (SIDE_SIGN, MODE + Mode._fields.index("side_slip")),
    (CORNER_OFFSET, MODE + Mode._fields.index("corner_offset")),
    (workspace.TIME, AT.time),
    (workspace.HALT, AT.halt),
    (workspace.TOLERANCE, AT.tolerance),
    (workspace.LONGEST, AT.next_step),
)


@kernel
def _gather(lanes, runs, i, w, lane):
    """Copy run ``i`` into a lane."""
    for n in range(LANE_CONSTANTS):
        w[n, lane] = runs[i, n]
    for line, column in _GATHERED:
        w[line, lane] = runs[i, column]
    copy_mode(lanes, runs, i, MODE, w, lane)
    for n in range(STATE_SIZE):
        w[COEFFICIENTS + n, lane] = runs[i, STATE + n]
        w[workspace.ERROR + n, lane] = runs[i, ERROR + n]


@kernel
def _note_closest(lanes, until, w, lane, runs, i):
    """Lower closest approaches by the samples of a step before ``until``.

    A level that starts at zero is left out: a mode starts at zeros of its own levels, and to leave
    one is not to approach an event.
    """
    last, applicable = int(until * (NODES - 1)), int(w[workspace.APPLICABLE, lane])
    while applicable != 0:
        which = lowest_bit(applicable)
        applicable &= applicable - 1
        first = w[sample_line(lanes, which, 0), lane]
        if first > ON_AN_EVENT and first != NEVER:
            lowest = runs[i, CLOSEST + which]
            for node in range(1, last + 1):
                lowest = min(lowest, w[sample_line(lanes, which, node), lane])
            runs[i, CLOSEST + which] = lowest


@inlined_kernel
def _record_periods(scene, lanes, until, history, control, w, lane, runs, i):
    """Record the excitation periods that end in a step, before ``until``.

    The run may end with one of them. Closest approaches of a step that lies in two periods count in
    both.
    """
    start, length = runs[i, AT.time], w[workspace.STEP_LENGTH, lane]
    p, mode = constants_of_lane(lanes, w, lane), mode_of_lane(lanes, w, lane)
    while (
        runs[i, AT.outcome] == CONTINUES
        and runs[i, AT.stop] <= start + until * length
        and runs[i, AT.stop] < runs[i, AT.deadline]
    ):
        q = state_at((runs[i, AT.stop] - start) / length, w, lane)
        store_state(hold_sticking(q, p, mode), runs, i)
        runs[i, AT.time] = runs[i, AT.stop]
        end_period(scene, history, control.settling_noise, runs, i)
        if is_watched(runs, i):
            _note_closest(lanes, until, w, lane, runs, i)


@inlined_kernel
def _advance(scene, lanes, until, history, control, track, w, lane, runs, i):
    """Advance by a step, or its fraction ``until`` an event; return whether the run continues."""
    length, start = w[workspace.STEP_LENGTH, lane], runs[i, AT.time]
    if is_watched(runs, i):
        _note_closest(lanes, until, w, lane, runs, i)
    _record_periods(scene, lanes, until, history, control, w, lane, runs, i)
    continues = runs[i, AT.outcome] == CONTINUES
    if not continues:
        until = (runs[i, AT.time] - start) / length
    mode, tilt = mode_of_lane(lanes, w, lane), 0.0
    halts = until == 1.0 and length == runs[i, AT.halt] - start
    if continues:
        runs[i, AT.time] = runs[i, AT.halt] if halts else start + until * length
    if track.shape[0] > 0:
        track_step(scene.events, track, start, until, w, lane, runs, i)
    if control.alignment_only == 0.0:
        tilt = largest_tilt(runs[i, AT.tilt_max], until, w, lane)
    note_step(scene, until * length, tilt, runs, i)
    if notes_forces(scene, mode, control, runs, i):
        for line, state, place in loads_of(mode):
            if state == CLOSED:
                known = runs[i, FORCES + place]
                runs[i, FORCES + place] = largest_force(line, known, until, w, lane)
    if not continues:
        return False
    if carries_error(scene, control, runs, i):
        carry_error(until, w, lane, runs, i)
    runs[i, AT.next_step] = _MOST_GROWTH * length
    return True


@inlined_kernel
def _accept_step(scene, lanes, history, control, track, w, lane, runs, i):
    """Complete a step without an event."""
    if _advance(scene, lanes, 1.0, history, control, track, w, lane, runs, i):
        for n in range(STATE_SIZE):
            runs[i, STATE + n] = w[workspace.END + n, lane]
        end_step(scene, False, history, control, runs, i)


@inlined_kernel
def _advance_to_event(which, theta, scene, lanes, history, control, track, w, lane, runs, i):
    """Advance to an event in the step, and continue in the mode that follows."""
    if _advance(scene, lanes, theta, history, control, track, w, lane, runs, i):
        q, before = state_at(theta, w, lane), mode_of(runs, i)
        carries = carries_error(scene, control, runs, i)
        had_aligned = not isnan(runs[i, AT.tau_align])
        store_state(q, runs, i)
        step = w[workspace.STEP_LENGTH, lane]
        apply_event(which, theta * step, step, scene, control, runs, i)
        track_run(scene.events, track, runs[i, AT.last_event], runs, i)
        if carries:
            aligns = not (had_aligned or isnan(runs[i, AT.tau_align]))
            if aligns or runs[i, AT.outcome] != CONTINUES:
                error = error_of_time(scene.events, which, q, before, runs, i)
                runs[i, AT.time_error if aligns else AT.end_error] = error
            rates = rates_in_step(q, theta, w, lane)
            apply_saltation(scene.events, which, q, rates, before, runs, i)
        if runs[i, AT.events_at_once] == 0.0:
            runs[i, AT.next_step] *= _MOST_GROWTH
        end_step(scene, False, history, control, runs, i)


@inlined_kernel
def pass_step(scene, lanes, control, memory, lane, i):
    """Pass the step of a lane, or its part up to the first event, with run ``i``."""
    w, runs, history, track = memory.w, memory.runs, memory.history, memory.track
    runs[i, AT.rhs_evaluations] += ORDER
    length = w[workspace.STEP_LENGTH, lane]
    if isnan(length):
        step_without_series(scene, control, history, runs, i)
        track_run(scene.events, track, 0.0, runs, i)
    elif is_too_short(length, runs[i, AT.time]):
        fail(scene, runs, i, REASON.STEP_TOO_SMALL)
    else:
        which, theta = -1, NO_EVENT
        if w[workspace.CANDIDATES, lane] != 0.0:
            which, theta = first_event(lanes, w, lane, memory.search)
        if theta == NO_EVENT:
            _accept_step(scene, lanes, history, control, track, w, lane, runs, i)
        else:
            _advance_to_event(which, theta, scene, lanes, history, control, track, w, lane, runs, i)


class Waiting(NamedTuple):
    """Queues of the runs that wait for a step, one for each kind of mode, first in, first out.

    Attributes:
        runs: ring buffers, one after the other, shape (kinds * runs,); code is for any number.
        firsts: index of the first run of each queue, shape (kinds,).
        counts: lengths of the queues, shape (kinds,).
        used: one more than the last kind of which a run has waited, shape (1,).
    """

    runs: np.ndarray
    firsts: np.ndarray
    counts: np.ndarray
    used: np.ndarray


class Memory(NamedTuple):
    """Memory of a thread; ``runs``, the runs that it has at once, has shape (runs, SIZE)."""

    w: np.ndarray
    runs: np.ndarray
    history: History
    search: np.ndarray  # see ``first_event``
    waiting: Waiting
    together: np.ndarray  # shape (WIDTH,), the runs of the step
    track: np.ndarray  # of the only run, shape (rows, COLUMNS); of none, shape (0, COLUMNS)
    addresses: np.ndarray  # see ``Series``


def new_memory(
    lanes: LaneEvents, may_settle: bool = True, runs: int = MOST_RUNS, rows: int = 0
) -> Memory:
    """Return the memory of a thread for so many ``runs``, or ``MOST_RUNS``, without any.

    It has histories only if runs ``may_settle``, and a track of ``rows`` for a single run.
    """
    kinds, runs = len(lanes.series.fill), min(runs, MOST_RUNS)
    return Memory(
        workspace.new_workspace(lanes.lines),
        np.zeros((runs, SIZE)),
        new_history(runs if may_settle else 1),
        np.zeros(QUANTITIES * TERMS),
        Waiting(*(np.zeros(n, np.int64) for n in (kinds * runs, kinds, kinds, 1))),
        np.zeros(WIDTH, np.int64),
        np.zeros((rows, len(COLUMNS))),
        lanes.series.addresses,
    )


@inlined_kernel
def _index_in(waiting, kind, number):
    """Return the index in a ring buffer ``number`` after that of its first run."""
    index, size = waiting.firsts[kind] + number, _size(waiting)
    return index - size if index >= size else index


@inlined_kernel
def _size(waiting):
    """Return the length of one ring buffer."""
    return waiting.runs.shape[0] // waiting.counts.shape[0]


@inlined_kernel
def _enqueue(scene, lanes, memory, results, i):
    """Put run ``i`` into the queue of its kind of mode, or write its result if it has ended.

    It fails in a mode that a page does not hold. Returns True if the run waits.
    """
    runs, waiting = memory.runs, memory.waiting
    kind = kind_of_mode(lanes, mode_of(runs, i))
    if kind < 0 and runs[i, AT.outcome] == CONTINUES:
        fail(scene, runs, i, REASON.UNDECLARED_CONTACT)
    if runs[i, AT.outcome] != CONTINUES:
        store_result(scene.events, runs, i, results, int(runs[i, AT.number_in_batch]))
        return False
    waiting.used[0] = max(waiting.used[0], kind + 1)
    index = _index_in(waiting, kind, waiting.counts[kind])
    waiting.runs[kind * _size(waiting) + index] = i
    waiting.counts[kind] += 1
    return True


@kernel
def _begin_next(sets, tolerances, queue, scene, lanes, control, memory, results, i):
    """Start the next parameter set of the queue, if there is one, as run ``i``."""
    waits = False
    while not waits:
        number = next_in(queue)
        if number >= sets.shape[0]:
            return
        begin(sets[number], tolerances[number], scene, control, memory.runs, i)
        track_run(scene.events, memory.track, 0.0, memory.runs, i)
        memory.runs[i, AT.number_in_batch], memory.runs[i, AT.next_step] = number, _FIRST_LONGEST
        waits = _enqueue(scene, lanes, memory, results, i)


@inlined_kernel
def _fullest(waiting):
    """Return the kind of mode with the longest queue."""
    counts = waiting.counts
    fullest, most = 0, counts[0]
    for kind in range(1, waiting.used[0]):
        count = counts[kind]
        fullest, most = (kind, count) if count > most else (fullest, most)
    return fullest


@inlined_kernel
def _dequeue(kind, waiting, together):
    """Move up to WIDTH runs from a queue to ``together``; return their number."""
    count = min(WIDTH, waiting.counts[kind])
    for lane in range(count):
        together[lane] = waiting.runs[kind * _size(waiting) + _index_in(waiting, kind, lane)]
    waiting.firsts[kind] = _index_in(waiting, kind, count)
    waiting.counts[kind] -= count
    return count


@kernel
def step_together(lanes, kind, count, control, memory):
    """Make a step of ``count`` runs in the same kind of mode."""
    w, runs = memory.w, memory.runs
    applicable = 0
    for lane in range(WIDTH):  # lanes without a run repeat the last one
        i = memory.together[min(lane, count - 1)]
        _gather(lanes, runs, i, w, lane)
        p, mode = constants_of(lanes.events, runs, i), mode_of(runs, i)
        may_apply = applicable_in(lanes, kind, p, mode)
        w[workspace.APPLICABLE, lane] = float(may_apply)
        applicable |= may_apply
    step_all(lanes, kind, applicable, control, memory.addresses, w)


@kernel
def begin_all(sets, tolerances, scene, lanes, control, queue, results, memory):
    """Start the first parameter sets of a queue; see ``integrate_all``."""
    memory.waiting.counts[:], memory.waiting.used[0] = 0, 0
    for i in range(min(memory.runs.shape[0], fair_share(queue))):
        _begin_next(sets, tolerances, queue, scene, lanes, control, memory, results, i)


@kernel
def integrate_all(sets, tolerances, scene, lanes, control, queue, results, memory):
    """Run the parameter sets of a queue to their ends, many at a time, after ``begin_all``.

    Shapes: sets (n, constants), the fields of ``Constants``, of the variant of ``lanes``;
    tolerances (n,); results (n, len(RunResult._fields)), filled for the sets taken. ``queue`` is
    made by ``new_queue``: threads that share it share the sets. ``memory`` is overwritten.

    Returns -1 at the end, or the number of a function that ``Series`` has to load before the runs
    continue, in a further call.
    """
    counts, with_errors = memory.waiting.counts, control.carries_error != 0.0
    kind = _fullest(memory.waiting)
    while counts[kind] > 0 and not is_stopped(queue):
        missing = missing_series(lanes, kind, with_errors, memory.addresses)
        if missing >= 0:
            return missing
        count = _dequeue(kind, memory.waiting, memory.together)
        step_together(lanes, kind, count, control, memory)
        for lane in range(count):
            i = memory.together[lane]
            pass_step(scene, lanes, control, memory, lane, i)
            if not _enqueue(scene, lanes, memory, results, i):
                _begin_next(sets, tolerances, queue, scene, lanes, control, memory, results, i)
        kind = _fullest(memory.waiting)
    return -1
