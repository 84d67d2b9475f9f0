"""The batch engine: as many runs under way as POOL, those in the same kind of mode side by side.

In every round each run makes one step, in lanes with others whose equations of motion are the same.
A step that shows no switch stands. Where one may be in it, the series tell where: it is located on
them to their full order, and the run is put there, without another step. What else a run does, at
switches and at the ends of periods, is the reference engine's own code, and so are the modes that
lanes do not hold.
"""

from math import isnan
from typing import NamedTuple

import numpy as np

from model.physics.compiled import borrowed, inlined_kernel, kernel
from model.physics.notation import State
from model.physics.scenes import CLOSED, OPEN, STICKING
from model.solver import lanes
from model.solver.course import (
    History,
    begin,
    borrowed_history,
    end_step,
    fail,
    make_switch,
    new_history,
    note_step,
)
from model.solver.lanes import (
    COEFFICIENTS,
    CONTACTS_AT,
    OUTLINE_AT,
    TOO_FLAT_TO_TELL,
    WATCHED_SWITCHES,
    constants_of_lane,
    is_corner,
    lanes_hold,
    mode_of_lane,
    new_lanes,
    one_stays_above,
    quantities_at,
    single_functions,
    stays_above,
    step_all,
)
from model.solver.locate import NO_SWITCH, first_switch, sample_step
from model.solver.loop import Workspace, advance, borrowed_workspace, new_workspace
from model.solver.outcomes import Reason
from model.solver.record import (
    CLOSEST,
    EVALUATIONS,
    FORCE_MAX,
    MODE,
    NEXT_STEP,
    OUTCOME,
    ROW_OF_BATCH,
    ROWS,
    STATE,
    STATE_SIZE,
    STOP,
    SWITCHES_AT_ONCE,
    TILT_MAX,
    TIME,
    TOLERANCE,
    constants_of,
    ending_of,
    keep_ending,
    keep_state,
    mode_of,
    state_in,
)
from model.solver.series import CONSISTENT, FREE, SIDE_SIGN, SLIDES, STICKS, SUPPORT_SIGN, Contacts
from model.solver.series_code import FRACTIONS, KINDS, NODES, ORDER, WIDTH
from model.solver.series_code import ROWS as SERIES_ROWS
from model.solver.step import MOST_GROWTH, are_finite, is_too_short, rates_of
from model.solver.switching import (
    ALIGNED,
    COMBINED_COUNT,
    CORNERS_INSIDE,
    FACE_END,
    FACE_FAR_END,
    FACE_GAP,
    FACE_LOAD,
    FACE_RELOAD,
    LARGEST_TILT,
    LEFT_CORNER_LANDS,
    LEFT_EDGE_ENTERS,
    LEFT_WALL,
    NEVER,
    NOTHING,
    ON_A_SWITCH,
    OVERTURNED,
    RIGHT_CORNER_LANDS,
    RIGHT_EDGE_ENTERS,
    RIGHT_WALL,
    SIDE_END,
    SIDE_GAP,
    SIDE_SLIP,
    SUPPORT_SLIP,
    SWITCH_COUNT,
    Outline,
    is_wall,
    largest,
    quantities,
)
from model.solver.tableaux import DOP853
from model.solver.transitions import CONTINUES, REST_SLIP

POOL = 64  # runs under way
_STEP_TOO_SMALL = int(Reason.STEP_TOO_SMALL)
_NOT_FINITE = int(Reason.NOT_FINITE)
_TOO_MANY_EVALUATIONS = int(Reason.TOO_MANY_EVALUATIONS)
_KINDS = len(KINDS) ** 2
_TILT = 2  # its place in a state
_FIRST_LONGEST = 1.0  # bound of a run's first step
_QUARTER = FRACTIONS[0]
_FINEST = 2.0**-24  # part of a step that is not divided
_MOST_PARTS = 64
_LEAVING = 2.0**-4  # part in which a function that begins on its switch is taken to go one way
_ROOT_ITERATIONS = 60
_NEARLY_LARGEST = 1.1  # what a step's samples may miss of a peak
_PARTS_OF_A_PEAK = 16


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
    (lanes.STOP, STOP),
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
        w[place * WIDTH + lane] = runs[row, i]
    for place, row in _BOARDED:
        w[place * WIDTH + lane] = runs[row, i]
    for n in range(STATE_SIZE):
        w[(COEFFICIENTS + n) * WIDTH + lane] = runs[STATE + n, i]


@inlined_kernel
def _at(row, theta, w, lane):
    """One of the states, or of what is watched, at the fraction ``theta`` of the step.

    Even and odd orders by themselves: twice as many operations at a time.
    """
    time = theta * w[lanes.LENGTH * WIDTH + lane]
    square, odd = time * time, 0.0
    even = w[(COEFFICIENTS + ORDER * SERIES_ROWS + row) * WIDTH + lane]
    for order in range(ORDER - 2, -2, -2):
        even = even * square + w[(COEFFICIENTS + order * SERIES_ROWS + row) * WIDTH + lane]
        odd = odd * square + w[(COEFFICIENTS + (order + 1) * SERIES_ROWS + row) * WIDTH + lane]
    return even + time * odd


@kernel
def _state_at(theta, w, lane):
    return State(
        _at(0, theta, w, lane), _at(1, theta, w, lane), _at(2, theta, w, lane),
        _at(3, theta, w, lane), _at(4, theta, w, lane), _at(5, theta, w, lane),
    )  # fmt: skip


@kernel
def _combined(which, theta, w, lane):
    """The four quantities whose largest is function ``which``, from those of what is watched."""
    right = which == RIGHT_EDGE_ENTERS
    left = which == LEFT_EDGE_ENTERS
    falls = which == ALIGNED or which == CORNERS_INSIDE
    right_corner = which == RIGHT_CORNER_LANDS or which == RIGHT_WALL or which == CORNERS_INSIDE
    left_corner = which == LEFT_CORNER_LANDS or which == LEFT_WALL or falls
    at = Outline(
        _at(OUTLINE_AT, theta, w, lane) if right or which == ALIGNED else 0.0,
        _at(OUTLINE_AT + 1, theta, w, lane) if right else 0.0,
        _at(OUTLINE_AT + 2, theta, w, lane) if left else 0.0,
        _at(OUTLINE_AT + 3, theta, w, lane) if left else 0.0,
        _at(OUTLINE_AT + 4, theta, w, lane) if left else 0.0,
        _at(OUTLINE_AT + 5, theta, w, lane) if right_corner else 0.0,
        _at(OUTLINE_AT + 6, theta, w, lane) if right_corner else 0.0,
        _at(OUTLINE_AT + 7, theta, w, lane) if left_corner else 0.0,
        _at(OUTLINE_AT + 8, theta, w, lane) if left_corner else 0.0,
    )
    return quantities_at(which, at, _at(_TILT, theta, w, lane), constants_of_lane(w, lane))


@kernel
def _single(which, theta, w, lane):
    """Function ``which`` that is one quantity, from those of what is watched that it needs."""
    p, mode = constants_of_lane(w, lane), mode_of_lane(w, lane)
    place, load, rubs = 0.0, 0.0, 0.0
    if which == OVERTURNED:
        return LARGEST_TILT - abs(_at(_TILT, theta, w, lane))
    if which == FACE_GAP or which == FACE_END or which == FACE_FAR_END:
        place = _at(OUTLINE_AT + (1 if which == FACE_GAP else 0), theta, w, lane)
    elif which == SIDE_GAP or which == SIDE_END:
        place = _at(OUTLINE_AT + (4 if which == SIDE_GAP else 3), theta, w, lane)
    elif which == SUPPORT_SLIP or which == FACE_LOAD or which == FACE_RELOAD:
        if which != SUPPORT_SLIP or mode.support_slip == STICKING:
            load = _at(CONTACTS_AT, theta, w, lane)
        if which == SUPPORT_SLIP:
            rubs = _at(CONTACTS_AT + 1, theta, w, lane)
    else:
        if which != SIDE_SLIP or mode.side_slip == STICKING:
            load = _at(CONTACTS_AT + 2, theta, w, lane)
        if which == SIDE_SLIP:
            rubs = _at(CONTACTS_AT + 3, theta, w, lane)
    at = Outline(place, place, place, place, place, 0.0, 0.0, 0.0, 0.0)
    functions = single_functions(at, Contacts(load, rubs, load, rubs), p, mode)
    if which == SUPPORT_SLIP or which == SIDE_SLIP:
        return functions[9 if which == SUPPORT_SLIP else 10]
    return functions[which - FACE_LOAD]


@kernel
def _quantities(which, theta, w, lane):
    """Four quantities whose largest is function ``which``, at a place of the step."""
    if which < COMBINED_COUNT:
        return _combined(which, theta, w, lane)
    return _single(which, theta, w, lane), NOTHING, NOTHING, NOTHING


@inlined_kernel
def _value(which, theta, w, lane):
    if which < COMBINED_COUNT:
        return largest(_combined(which, theta, w, lane))[0]
    return _single(which, theta, w, lane)


@kernel
def _root(which, low, f_low, high, f_high, w, lane):
    """The root in [low, high] of a function that is positive at ``low`` and negative at ``high``.

    Chandrupatla's method (Advances in Engineering Software 28 (1997) 145-149): inverse quadratic
    interpolation where three points allow it, else bisection.
    """
    # x1 is the last point, x2 the other end of the bracket, x3 the last point given up.
    x1, f1, x2, f2 = high, f_high, low, f_low
    t = f1 / (f1 - f2)
    for _ in range(_ROOT_ITERATIONS):
        x = x1 + t * (x2 - x1)
        f = _value(which, x, w, lane)
        if (f < 0.0) == (f1 < 0.0):
            x3, f3 = x1, f1
        else:
            x3, f3, x2, f2 = x2, f2, x1, f1
        x1, f1 = x, f
        width = abs(x2 - x1)
        least = 1e-15 * max(x1, x2)
        if f == 0.0 or width <= least:
            break
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
        t = 0.5
        if phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi:
            t = f1 / (f2 - f1) * f3 / (f2 - f3)
            t += (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        edge = 0.5 * least / width
        t = min(max(t, edge), 1.0 - edge)
    return x1 if f1 <= 0.0 else x2


@inlined_kernel
def _goes_one_way(left, right, bend):
    """Whether a quantity stays below zero between two places, or falls all the way."""
    return left - right > 4.0 * bend or stays_above(-left, -right, bend)


@inlined_kernel
def _clear(which, before, after, bend):
    """Whether function ``which`` stays above zero between two places."""
    if which >= COMBINED_COUNT:
        return stays_above(before[0], after[0], bend)
    return one_stays_above(before, after, bend)


@inlined_kernel
def _is_one_way(which, before, after, bend):
    """Whether all quantities of function ``which`` go one way between two places."""
    if which >= COMBINED_COUNT:
        return _goes_one_way(before[0], after[0], bend)
    return (
        _goes_one_way(before[0], after[0], bend)
        and _goes_one_way(before[1], after[1], bend)
        and _goes_one_way(before[2], after[2], bend)
        and _goes_one_way(before[3], after[3], bend)
    )


@inlined_kernel
def _at_node(which, node, w, lane):
    """``_quantities`` at a node of the step, sampled already where it is one."""
    if which >= COMBINED_COUNT:
        sample = w[(lanes.SAMPLES + node * SWITCH_COUNT + which) * WIDTH + lane]
        return sample, NOTHING, NOTHING, NOTHING
    return _combined(which, node * _QUARTER, w, lane)


@kernel
def _first_fall(which, until, w, lane):
    """Where before ``until`` function ``which`` first falls through zero, or ``NO_SWITCH``.

    The step is divided until in each part the function stays above zero by its bend, or goes one
    way.
    """
    bend = w[lanes.bend_row(which) * WIDTH + lane] / _QUARTER**2
    until = min(until, 1.0)
    node, left, right = 0, 0.0, min(_QUARTER, until)
    before, parts = _at_node(which, 0, w, lane), 0
    while left < until:
        parts += 1
        if right == (node + 1) * _QUARTER:
            after = _at_node(which, node + 1, w, lane)
        else:
            after = _quantities(which, right, w, lane)
        width = right - left
        most = bend * width * width
        if not _clear(which, before, after, most):
            f, g = largest(before)[0], largest(after)[0]
            # Of a function that is zero to rounding all along, no part is fine enough.
            finest = _FINEST if parts < _MOST_PARTS else _LEAVING
            if g < 0.0 and (width <= finest or _is_one_way(which, before, after, most)):
                return _root(which, left, f, right, g, w, lane) if f > 0.0 else left
            on_switch = ON_A_SWITCH if left == 0.0 and not is_corner(which) else REST_SLIP
            begins = abs(f) <= on_switch and g > -REST_SLIP
            if width > (_LEAVING if begins else finest):
                right = left + 0.5 * width
                continue
        left, before = right, after
        node += 1 if left == (node + 1) * _QUARTER else 0
        right = min((node + 1) * _QUARTER, until)
    return NO_SWITCH


@kernel
def _searched(w, lane, runs, work, i):
    """(which, θ) of the first switch, by the reference engine's search on the dense output."""
    time, h = runs[TIME, i], w[lanes.LENGTH * WIDTH + lane]
    p, mode = constants_of(runs, i), mode_of(runs, i)
    for n in range(STATE_SIZE):
        work.y[n] = runs[STATE + n, i]
        power = 1.0
        for order in range(1, ORDER + 1):
            coefficient = w[(COEFFICIENTS + order * SERIES_ROWS + n) * WIDTH + lane]
            work.dense[n, order - 1] = power * coefficient
            power *= h
    sample_step(time, h, work.y, work.dense, p, mode, work.nodes, work.samples)
    return first_switch(time, h, work.y, work.dense, p, mode, work.samples)


@inlined_kernel
def _is_flat(which, w, lane):
    """Whether a corner's function comes so low that its tilt may be that of a flat part."""
    lowest = w[(lanes.SAMPLES + which) * WIDTH + lane]
    for node in range(1, NODES):
        lowest = min(lowest, w[(lanes.SAMPLES + node * SWITCH_COUNT + which) * WIDTH + lane])
    return lowest < TOO_FLAT_TO_TELL


@kernel
def _moves_down(which, theta, w, lane):
    """Whether a corner that stands below the plane presses, as it moves down."""
    _, _, _, rising = quantities(which, _state_at(theta, w, lane), constants_of_lane(w, lane))
    return rising < 0.0


@kernel
def _first_switch(w, lane, runs, work, i):
    """(which, θ) of the first switch in the step; θ is ``NO_SWITCH`` if there is none."""
    first, which_first, search = NO_SWITCH, -1, False
    for which in WATCHED_SWITCHES:
        if w[(lanes.MAY_SWITCH + which) * WIDTH + lane] == 0.0:
            continue
        theta = _first_fall(which, first, w, lane)
        if is_corner(which) and (theta == NO_SWITCH or not _moves_down(which, theta, w, lane)):
            search = search or theta != NO_SWITCH or _is_flat(which, w, lane)
        elif is_wall(which):
            search = search or theta != NO_SWITCH
        elif theta < first:
            first, which_first = theta, which
    if search:
        which, theta = _searched(w, lane, runs, work, i)
        if theta < first and (is_wall(which) or which < COMBINED_COUNT):
            first, which_first = theta, which
    return which_first, first


@inlined_kernel
def _lower_closest(which, value, runs, i):
    runs[CLOSEST + which, i] = min(runs[CLOSEST + which, i], value)


@kernel
def _highest(row, sign, until, w, lane):
    """Highest value of a row, times ``sign``, in a part of the step."""
    part = until / _PARTS_OF_A_PEAK
    before, here = sign * _at(row, 0.0, w, lane), sign * _at(row, part, w, lane)
    highest = max(before, here)
    for n in range(2, _PARTS_OF_A_PEAK + 1):
        after = sign * _at(row, n * part, w, lane)
        highest = max(highest, max(after, lanes.peak(before, here, after)))
        before, here = here, after
    return highest


@kernel
def _largest_until(until, w, lane, runs, i):
    """Largest |tilt| and normal force in a part of the step, if they may be the run's largest."""
    tilt, force, mode = 0.0, 0.0, mode_of(runs, i)
    if _NEARLY_LARGEST * w[lanes.STEP_TILT * WIDTH + lane] >= runs[TILT_MAX, i]:
        tilt = max(_highest(_TILT, 1.0, until, w, lane), _highest(_TILT, -1.0, until, w, lane))
    if _NEARLY_LARGEST * w[lanes.STEP_FORCE * WIDTH + lane] >= runs[FORCE_MAX, i]:
        if mode.face == CLOSED:
            force = _highest(CONTACTS_AT, 1.0, until, w, lane)
        if mode.side == CLOSED:
            force = max(force, _highest(CONTACTS_AT + 2, 1.0, until, w, lane))
    return tilt, force


@inlined_kernel
def _stand(history, control, w, lane, runs, i):
    """Complete a step without a switch."""
    length, time, stop = w[lanes.LENGTH * WIDTH + lane], runs[TIME, i], runs[STOP, i]
    tilt, force = _largest_until(1.0, w, lane, runs, i)
    note_step(length, tilt, force, runs, i)
    for which in WATCHED_SWITCHES:
        _lower_closest(which, w[(lanes.LOWEST + which) * WIDTH + lane], runs, i)
    for n in range(STATE_SIZE):
        runs[STATE + n, i] = w[(lanes.END + n) * WIDTH + lane]
    at_stop = length == stop - time
    runs[TIME, i] = stop if at_stop else time + length
    longest = MOST_GROWTH * length
    # A step cut short by a stop says nothing against the length it was cut from.
    runs[NEXT_STEP, i] = max(longest, runs[NEXT_STEP, i]) if at_stop else longest
    end_step(at_stop, history, control, runs, i)


@kernel
def _note_part(theta, w, lane, runs, i):
    """Enter the part of a step up to a switch."""
    tilt, force = _largest_until(theta, w, lane, runs, i)
    note_step(theta * w[lanes.LENGTH * WIDTH + lane], tilt, force, runs, i)
    for which in WATCHED_SWITCHES if theta >= _QUARTER else WATCHED_SWITCHES[:0]:
        sample = lanes.SAMPLES + which
        if w[sample * WIDTH + lane] != NEVER and w[sample * WIDTH + lane] > ON_A_SWITCH:
            for node in range(1, NODES):
                if node * _QUARTER <= theta:
                    _lower_closest(which, w[(sample + node * SWITCH_COUNT) * WIDTH + lane], runs, i)


@kernel
def _look_into(declared, history, control, work, w, lane, runs, i):
    """Go up to the first switch in the step, if there is one, or to its end."""
    which, theta = _first_switch(w, lane, runs, work, i)
    if theta == NO_SWITCH:
        _stand(history, control, w, lane, runs, i)
        return
    _note_part(theta, w, lane, runs, i)
    step = w[lanes.LENGTH * WIDTH + lane]
    keep_state(_state_at(theta, w, lane), runs, i)
    runs[TIME, i] += theta * step
    make_switch(which, theta * step, step, declared, runs, i)
    if runs[SWITCHES_AT_ONCE, i] == 0.0:
        runs[NEXT_STEP, i] *= MOST_GROWTH
    end_step(False, history, control, runs, i)


@kernel
def _go_on(declared, history, control, work, w, lane, runs, i):
    """What run ``i`` does after the step of its lane."""
    runs[EVALUATIONS, i] += ORDER
    length = w[lanes.LENGTH * WIDTH + lane]
    if isnan(length) or is_too_short(length, runs[TIME, i]):
        q = state_in(runs, STATE, i)
        rates = rates_of(runs[TIME, i], q, constants_of(runs, i), mode_of(runs, i))
        fail(runs, i, _STEP_TOO_SMALL if are_finite(rates) else _NOT_FINITE)
    elif w[lanes.SHOWN * WIDTH + lane] == 0.0:
        _stand(history, control, w, lane, runs, i)
    else:
        _look_into(declared, history, control, work, w, lane, runs, i)
    if runs[EVALUATIONS, i] > control.max_evaluations and runs[OUTCOME, i] == CONTINUES:
        fail(runs, i, _TOO_MANY_EVALUATIONS)


@kernel
def _run_elsewhere(declared, method, control, runs, history, work, i):
    """Advance a run by the reference engine until lanes can hold it, or it ends."""
    while runs[OUTCOME, i] == CONTINUES and not lanes_hold(mode_of(runs, i)):
        advance(declared, method, control, work.nodes[:0], history, work, runs, i)


class Many(NamedTuple):
    """Memory for as many runs as are under way, shape of runs (ROWS, POOL)."""

    w: np.ndarray
    runs: np.ndarray
    history: History
    work: Workspace
    series: Workspace


def new_many() -> Many:
    """A ``Many`` without runs."""
    work = new_workspace(DOP853.method)
    series = work._replace(dense=np.zeros((STATE_SIZE, ORDER)))
    return Many(new_lanes(), np.zeros((ROWS, POOL)), new_history(POOL), work, series)


@kernel
def _step_together(kind, members, count, declared, control, history, work, w, runs):
    """Make a step of up to WIDTH runs in the same kind of mode."""
    beside, flies = False, kind < len(KINDS)
    for lane in range(WIDTH):  # lanes without a run repeat the last one
        i = members[min(lane, count - 1)]
        _board(runs, i, w, lane)
        beside = beside or runs[MODE + 6, i] != OPEN
        flies = flies or runs[MODE + 1, i] == OPEN
    step_all(kind, flies, beside, w)
    for lane in range(count):
        _go_on(declared, history, control, work, w, lane, runs, members[lane])


@kernel
def _fill_pool(rows, tolerances, queue, under_way, declared, method, control, endings, many):
    """Begin runs from the queue on, until as many as possible are under way: (queue, number)."""
    runs, history, work = many.runs, many.history, many.work
    for i in range(POOL):
        while runs[OUTCOME, i] != CONTINUES and queue < rows.shape[0]:
            begin(rows[queue], tolerances[queue], declared, control, runs, i)
            runs[ROW_OF_BATCH, i], runs[NEXT_STEP, i] = queue, _FIRST_LONGEST
            _run_elsewhere(declared, method, control, runs, history, work, i)
            under_way += 1
            if runs[OUTCOME, i] != CONTINUES:
                keep_ending(ending_of(runs, i), endings, queue)
                under_way -= 1
            queue += 1
    return queue, under_way


@kernel
def _sort_by_kind(runs, kinds, order):
    """Enter the kind of each run's mode, _KINDS if it has ended, and the runs in its order."""
    places = np.zeros(_KINDS + 2, np.int64)
    for i in range(POOL):
        kinds[i] = _kind(mode_of(runs, i)) if runs[OUTCOME, i] == CONTINUES else _KINDS
        places[kinds[i] + 1] += 1
    for kind in range(_KINDS):
        places[kind + 1] += places[kind]
    for i in range(POOL):
        order[places[kinds[i]]] = i
        places[kinds[i]] += 1


@kernel
def integrate_all(rows, tolerances, declared, method, control, endings, many):
    """Run every parameter set to its end, side by side.

    Args:
        rows: shape (n, constants), the fields of ``Constants``, consistent readings only.
        tolerances: shape (n,), of each run.
        declared: ``Declared`` contacts of the scene.
        method: that of DOP853.
        control: ``Control``.
        endings: shape (n, len(Ending._fields)), filled.
        many: ``Many``, overwritten.
    """
    many = Many(
        borrowed(many.w), borrowed(many.runs), borrowed_history(many.history),
        borrowed_workspace(many.work), borrowed_workspace(many.series),
    )  # fmt: skip
    rows, endings = borrowed(rows), borrowed(endings)
    runs, history = many.runs, many.history
    runs[OUTCOME] = CONTINUES + 1.0
    kinds, order = np.empty(POOL, np.int64), np.empty(POOL, np.int64)
    queue, under_way = 0, 0
    while queue < rows.shape[0] or under_way > 0:
        queue, under_way = _fill_pool(
            rows, tolerances, queue, under_way, declared, method, control, endings, many
        )
        _sort_by_kind(runs, kinds, order)
        first = 0
        while first < POOL and kinds[order[first]] < _KINDS:
            kind, count = kinds[order[first]], 1
            while count < WIDTH and first + count < POOL and kinds[order[first + count]] == kind:
                count += 1
            _step_together(
                kind, order[first:], count, declared, control, history, many.series, many.w, runs
            )
            first += count
        for i in range(POOL):
            if kinds[i] < _KINDS:
                if runs[OUTCOME, i] == CONTINUES and not lanes_hold(mode_of(runs, i)):
                    _run_elsewhere(declared, method, control, runs, history, many.work, i)
                if runs[OUTCOME, i] != CONTINUES:
                    keep_ending(ending_of(runs, i), endings, int(runs[ROW_OF_BATCH, i]))
                    under_way -= 1
