"""The batch engine: many runs under way, those in the same kind of mode side by side.

Runs wait with others whose equations of motion are the same; those of which most wait make a step.
A step that shows no switch stands. Where one may be in it, the series tell where: it is located on
them to their full order, and the run is put there, without another step. What else a run does, at
switches and at the ends of periods, is the reference engine's own code, and so are the modes that
lanes do not hold.
"""

from math import isnan
from typing import NamedTuple

import numpy as np

from model.engines.batch import lanes
from model.engines.batch.event_search import (
    QUANTITIES,
    TERMS,
    first_switch,
    largest_until,
    state_at,
)
from model.engines.batch.lanes import (
    COEFFICIENTS,
    WATCHED_SWITCHES,
    constants_of_lane,
    lanes_hold,
    mode_of_lane,
    new_lanes,
    step_all,
)
from model.engines.batch.series import CONSISTENT, FREE, SIDE_SIGN, SLIDES, STICKS, SUPPORT_SIGN
from model.engines.batch.series_code import KINDS, NODES, ORDER, WIDTH
from model.engines.course import (
    History,
    begin,
    end_period,
    end_step,
    fail,
    is_counted,
    make_switch,
    new_history,
    note_step,
)
from model.engines.queue import fair_share, next_in
from model.engines.record import (
    CLOSEST,
    DEADLINE,
    EVALUATIONS,
    MODE,
    NEXT_STEP,
    OUTCOME,
    ROW_OF_BATCH,
    SIZE,
    STATE,
    STOP,
    SWITCHES_AT_ONCE,
    TIME,
    TOLERANCE,
    constants_of,
    keep_result,
    keep_state,
    mode_of,
    state_in,
)
from model.engines.scalar.location import NO_SWITCH
from model.engines.scalar.loop import Workspace, advance, new_workspace
from model.engines.scalar.step import MOST_GROWTH, are_finite, is_too_short, rates_of
from model.engines.scalar.tableaux import DOP853
from model.events.outcomes import Reason
from model.events.table import SWITCH_COUNT
from model.events.transitions import CONTINUES, hold_sticking
from model.physics.compiled import inlined_kernel, kernel
from model.physics.notation import STATE_SIZE
from model.physics.scenes import CLOSED, OPEN, STICKING

POOL = 128  # runs that a thread has under way at most
_STEP_TOO_SMALL = int(Reason.STEP_TOO_SMALL)
_NOT_FINITE = int(Reason.NOT_FINITE)
_FIRST_LONGEST = 1.0  # bound of a run's first step


@inlined_kernel
def _kind(mode):
    """Which series hold in ``mode``."""
    support = STICKS if mode.support_slip == STICKING else SLIDES
    side = STICKS if mode.side_slip == STICKING else SLIDES
    return (support if mode.face == CLOSED else FREE) * len(KINDS) + (
        side if mode.side == CLOSED else FREE
    )


# What a lane takes of a run beside its constants and its state: where it stands in each of the two.
_BOARDED = (
    (SUPPORT_SIGN, MODE + 5),
    (SIDE_SIGN, MODE + 7),
    (lanes.TIME, TIME),
    (lanes.DEADLINE, DEADLINE),
    (lanes.TOLERANCE, TOLERANCE),
    (lanes.LONGEST, NEXT_STEP),
    (lanes.FACE, MODE + 1),
    (lanes.SUPPORT_SLIP_STATE, MODE + 5),
    (lanes.SIDE, MODE + 6),
    (lanes.SIDE_SLIP_STATE, MODE + 7),
    (lanes.DROPPED, MODE + 8),
)


@kernel
def _board(runs, i, w, lane):
    """Put run ``i`` into a lane."""
    for place, row in enumerate(CONSISTENT):
        w[place * WIDTH + lane] = runs[i, row]
    for place, row in _BOARDED:
        w[place * WIDTH + lane] = runs[i, row]
    for n in range(STATE_SIZE):
        w[(COEFFICIENTS + n) * WIDTH + lane] = runs[i, STATE + n]


@inlined_kernel
def _note_lowest(until, w, lane, runs, i):
    """Enter how low switching functions come in a step, or in its quarters before a switch."""
    quarters = int(until * (NODES - 1))
    if quarters > 0 and w[lanes.DROPPED * WIDTH + lane] == 0.0:
        first = lanes.LOWEST + (quarters - 1) * SWITCH_COUNT
        for which in WATCHED_SWITCHES:
            lowest = w[(first + which) * WIDTH + lane]
            runs[i, CLOSEST + which] = min(runs[i, CLOSEST + which], lowest)


@inlined_kernel
def _pass_periods(until, history, control, w, lane, runs, i):
    """Enter the excitation periods that end in a step, before ``until``.

    The run may end with one of them. A step in two periods counts as near a switch in both.
    """
    start, length = runs[i, TIME], w[lanes.LENGTH * WIDTH + lane]
    p, mode = constants_of_lane(w, lane), mode_of_lane(w, lane)
    while (
        runs[i, OUTCOME] == CONTINUES
        and runs[i, STOP] <= start + until * length
        and runs[i, STOP] < runs[i, DEADLINE]
    ):
        q = state_at((runs[i, STOP] - start) / length, w, lane)
        keep_state(hold_sticking(q, p, mode), runs, i)
        runs[i, TIME] = runs[i, STOP]
        end_period(history, control.may_settle != 0.0, runs, i)
        if control.may_settle != 0.0:
            _note_lowest(until, w, lane, runs, i)


@inlined_kernel
def _move(until, history, control, w, lane, runs, i):
    """Go on by a step, or by its part up to a switch; whether the run still goes on."""
    length, start = w[lanes.LENGTH * WIDTH + lane], runs[i, TIME]
    if control.may_settle != 0.0:
        _note_lowest(until, w, lane, runs, i)
    _pass_periods(until, history, control, w, lane, runs, i)
    goes_on = runs[i, OUTCOME] == CONTINUES
    if not goes_on:
        until = (runs[i, TIME] - start) / length
    tilt, force = 0.0, 0.0
    counted = is_counted(mode_of_lane(w, lane), constants_of_lane(w, lane))
    if counted and control.alignment_only == 0.0:
        tilt, force = largest_until(until, w, lane, runs, i)
    note_step(until * length, tilt, force, runs, i)
    if not goes_on:
        return False
    at_deadline = until == 1.0 and length == runs[i, DEADLINE] - start
    runs[i, TIME] = runs[i, DEADLINE] if at_deadline else start + until * length
    runs[i, NEXT_STEP] = MOST_GROWTH * length
    return True


@inlined_kernel
def _stand(history, control, w, lane, runs, i):
    """Complete a step without a switch."""
    if _move(1.0, history, control, w, lane, runs, i):
        for n in range(STATE_SIZE):
            runs[i, STATE + n] = w[(lanes.END + n) * WIDTH + lane]
        end_step(False, history, control, runs, i)


@inlined_kernel
def _switch(which, theta, declared, history, control, w, lane, runs, i):
    """Go up to a switch in the step, and on in the mode that follows."""
    if _move(theta, history, control, w, lane, runs, i):
        keep_state(state_at(theta, w, lane), runs, i)
        step = w[lanes.LENGTH * WIDTH + lane]
        make_switch(which, theta * step, step, declared, control, runs, i)
        if runs[i, SWITCHES_AT_ONCE] == 0.0:
            runs[i, NEXT_STEP] *= MOST_GROWTH
        end_step(False, history, control, runs, i)


@inlined_kernel
def _go_on(declared, control, many, lane, i):
    """What run ``i`` does after the step of its lane."""
    w, runs, history = many.w, many.runs, many.history
    runs[i, EVALUATIONS] += ORDER
    length = w[lanes.LENGTH * WIDTH + lane]
    if isnan(length) or is_too_short(length, runs[i, TIME]):
        q = state_in(runs, STATE, i)
        rates = rates_of(runs[i, TIME], q, constants_of(runs, i), mode_of(runs, i))
        fail(runs, i, _STEP_TOO_SMALL if are_finite(rates) else _NOT_FINITE)
    else:
        which, theta = -1, NO_SWITCH
        if w[lanes.SHOWN * WIDTH + lane] != 0.0:
            which, theta = first_switch(w, lane, runs, many.search, many.quantities, i)
        if theta == NO_SWITCH:
            _stand(history, control, w, lane, runs, i)
        else:
            _switch(which, theta, declared, history, control, w, lane, runs, i)


class Waiting(NamedTuple):
    """The runs that wait for a step, by kinds of modes: those that came first go first.

    Attributes:
        runs: shape (kinds, POOL); behind the last place of a kind follows its first.
        firsts: shape (kinds,), place of the run that came first.
        counts: shape (kinds,), how many wait.
    """

    runs: np.ndarray
    firsts: np.ndarray
    counts: np.ndarray


class Many(NamedTuple):
    """Memory for as many runs as are under way, shape of runs (POOL, SIZE)."""

    w: np.ndarray
    runs: np.ndarray
    history: History
    work: Workspace
    search: Workspace  # with the lanes' order
    quantities: np.ndarray  # series of those of one switching function; see inside_step.py
    waiting: Waiting
    together: np.ndarray  # shape (WIDTH,), the runs of the step


def new_many(may_settle: bool = True) -> Many:
    """A ``Many`` without runs, without histories if none of them ``may_settle``."""
    work = new_workspace(DOP853.method)
    search = work._replace(dense=np.zeros((STATE_SIZE, ORDER)))
    runs, quantities = np.zeros((POOL, SIZE)), np.zeros(QUANTITIES * TERMS)
    kinds = len(KINDS) ** 2
    waiting = Waiting(*(np.zeros(shape, np.int64) for shape in ((kinds, POOL), kinds, kinds)))
    together = np.zeros(WIDTH, np.int64)
    return Many(
        new_lanes(), runs, new_history(POOL if may_settle else 1), work, search, quantities,
        waiting, together,
    )  # fmt: skip


@inlined_kernel
def _still_waits(declared, method, control, many, endings, i):
    """Let run ``i`` wait for its next step, or enter its ending; whether it waits.

    The reference engine advances it until lanes can hold it.
    """
    runs, waiting = many.runs, many.waiting
    while runs[i, OUTCOME] == CONTINUES and not lanes_hold(mode_of(runs, i)):
        advance(declared, method, control, many.work.nodes[:0], many.history, many.work, runs, i)
    if runs[i, OUTCOME] != CONTINUES:
        keep_result(runs, i, endings, int(runs[i, ROW_OF_BATCH]))
        return False
    kind = _kind(mode_of(runs, i))
    waiting.runs[kind, (waiting.firsts[kind] + waiting.counts[kind]) % POOL] = i
    waiting.counts[kind] += 1
    return True


@kernel
def _begin_next(rows, tolerances, queue, declared, method, control, many, endings, i):
    """Begin a run from the queue, if there is one, as number ``i``."""
    waits = False
    while not waits:
        row = next_in(queue)
        if row >= rows.shape[0]:
            return
        begin(rows[row], tolerances[row], declared, control, many.runs, i)
        many.runs[i, ROW_OF_BATCH], many.runs[i, NEXT_STEP] = row, _FIRST_LONGEST
        waits = _still_waits(declared, method, control, many, endings, i)


@inlined_kernel
def _fullest(counts):
    """The kind of mode in which most runs wait."""
    fullest = 0
    for kind in range(1, counts.size):
        if counts[kind] > counts[fullest]:
            fullest = kind
    return fullest


@inlined_kernel
def _call(kind, waiting, together):
    """Take up to WIDTH runs that wait; how many."""
    count = min(WIDTH, waiting.counts[kind])
    for lane in range(count):
        together[lane] = waiting.runs[kind, (waiting.firsts[kind] + lane) % POOL]
    waiting.firsts[kind] = (waiting.firsts[kind] + count) % POOL
    waiting.counts[kind] -= count
    return count


@kernel
def _step_together(kind, count, control, many):
    """Make a step of runs in the same kind of mode."""
    w, runs = many.w, many.runs
    beside, flies = False, kind < len(KINDS)
    for lane in range(WIDTH):  # lanes without a run repeat the last one
        i = many.together[min(lane, count - 1)]
        _board(runs, i, w, lane)
        beside = beside or runs[i, MODE + 6] != OPEN
        flies = flies or runs[i, MODE + 1] == OPEN
    step_all(kind, flies, beside, control, w)


@kernel
def integrate_all(rows, tolerances, declared, method, control, queue, endings, many):
    """Run the parameter sets of a queue to their ends, side by side.

    Args:
        rows: shape (n, constants), the fields of ``Constants``, consistent readings only.
        tolerances: shape (n,), of each run.
        declared: ``Declared`` contacts of the scene.
        method: that of DOP853.
        control: ``Control``.
        queue: that of ``new_queue``; threads that share it share the sets.
        endings: shape (n, len(RunResult._fields)), filled for the sets taken.
        many: ``Many``, overwritten.
    """
    counts = many.waiting.counts
    counts[:] = 0
    for i in range(min(POOL, fair_share(queue))):
        _begin_next(rows, tolerances, queue, declared, method, control, many, endings, i)
    kind = _fullest(counts)
    while counts[kind] > 0:
        count = _call(kind, many.waiting, many.together)
        _step_together(kind, count, control, many)
        for lane in range(count):
            i = many.together[lane]
            _go_on(declared, control, many, lane, i)
            if not _still_waits(declared, method, control, many, endings, i):
                _begin_next(rows, tolerances, queue, declared, method, control, many, endings, i)
        kind = _fullest(counts)
