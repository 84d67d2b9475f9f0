"""The batch engine: a queue of runs through the lanes, each lane with its own course.

All lanes step together (lanes.py). A lane whose step shows nothing goes straight on; the others are
looked after one by one. A step in which a switching function falls through zero is repeated up to
the switch, by Newton's iteration on whole steps as in the reference engine, but each of these is a
step of the lane among those of the others. What the samples of a step leave unclear is decided by
the reference engine's search on the dense output.
"""

from math import sqrt
from typing import NamedTuple

from model.physics.compiled import borrowed, inlined_kernel, kernel
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
    AT_STOP,
    CLEAR,
    COMBINATIONS,
    FULL_STEP,
    GROWTH,
    IDLE,
    LANDING,
    LANDINGS,
    LANE_ROWS,
    LANES,
    LENGTH,
    METHOD,
    NODES,
    PHASE,
    REJECTED_STEP,
    SEARCHED,
    SEARCHING,
    SHOWN,
    STEP_FORCE,
    STEP_TILT,
    STEPPING,
    UNCLEAR,
    WATCHED,
    WHICH,
    Y_END,
    Combinations,
    Lanes,
    borrowed_lanes,
    is_corner,
    lanes_hold,
    new_lanes,
    slopes,
    step_all,
)
from model.solver.locate import NO_SWITCH, first_switch, sample_step
from model.solver.loop import (
    SWITCH_RESOLUTION,
    Workspace,
    advance,
    borrowed_workspace,
    new_workspace,
)
from model.solver.outcomes import Reason
from model.solver.record import (
    CLOSEST,
    EVALUATIONS,
    NEXT_STEP,
    OUTCOME,
    ROW_OF_BATCH,
    STATE,
    STATE_SIZE,
    STOP,
    TIME,
    TOLERANCE,
    constants_of,
    ending_of,
    keep_ending,
    keep_state_in,
    mode_of,
    state_in,
)
from model.solver.step import (
    are_finite,
    dense_coefficients,
    is_too_short,
    moved,
    rates_of,
    short_step,
)
from model.solver.switching import (
    COMBINED_COUNT,
    NEVER,
    SWITCH_COUNT,
    is_wall,
    switching_function,
)
from model.solver.transitions import CONTINUES

_STEP_TOO_SMALL = int(Reason.STEP_TOO_SMALL)
_NOT_FINITE = int(Reason.NOT_FINITE)
_TOO_MANY_EVALUATIONS = int(Reason.TOO_MANY_EVALUATIONS)
_MOST_LANDINGS = 8
_MOST_TRIALS = 3  # landings before the dense output is searched
_MOST_APPROACHES = 8
_NEAR = 1e-3  # distance to a switch, over the step, from which short steps are enough
_TOGETHER = 1e-3  # fraction of a step within which two switches are not told apart by its samples
_ROOT_ITERATIONS = 6


@inlined_kernel
def _quartic_root(place, g0, g1, g2, g3, g4):
    """Root, in quarters of the step, of the quartic through its samples, in [place - 1, place].

    The samples are positive at ``place`` - 1 and negative at ``place``.
    """
    c1 = g1 - g0
    c2 = (g2 - 2.0 * g1 + g0) / 2.0
    c3 = (g3 - 3.0 * g2 + 3.0 * g1 - g0) / 6.0
    c4 = (g4 - 4.0 * g3 + 6.0 * g2 - 4.0 * g1 + g0) / 24.0
    low, high = place - 1.0, float(place)
    t, f_low, f_high = low, 0.0, 0.0
    for i in range(_ROOT_ITERATIONS):
        if i < 2:
            t = low if i == 0 else high
        else:
            t = high - f_high * (high - low) / (f_high - f_low)
        f = g0 + t * (c1 + (t - 1.0) * (c2 + (t - 2.0) * (c3 + (t - 3.0) * c4)))
        if i == 0 or (i > 1 and f >= 0.0):
            low, f_low, f_high = t, f, f_high * (0.5 if i > 1 else 1.0)
        else:
            high, f_high, f_low = t, f, f_low * (0.5 if i > 1 else 1.0)
    return t


@inlined_kernel
def _crossing(which, samples, i):
    """Where in the step function ``which`` falls through zero: (θ, whether the samples tell)."""
    g0, g1, g2 = samples[0, which, i], samples[1, which, i], samples[2, which, i]
    g3, g4 = samples[3, which, i], samples[4, which, i]
    if g0 == NEVER or min(min(g1, g2), min(g3, g4)) >= 0.0:
        return NO_SWITCH, True
    place = 1
    while samples[place, which, i] >= 0.0:
        place += 1
    if is_corner(which) or is_wall(which) or samples[place - 1, which, i] <= 0.0:
        return 0.25 * (place - 1), False
    if which < COMBINED_COUNT:
        first = samples[0, SWITCH_COUNT + which, i]
        for node in range(1, NODES):
            if samples[node, SWITCH_COUNT + which, i] != first:
                return 0.25 * (place - 1), False
    return 0.25 * _quartic_root(place, g0, g1, g2, g3, g4), True


@kernel
def _first_crossing(samples, i):
    """(which, θ, whether the samples tell) of the first crossing in the step of lane ``i``."""
    first, which_first, sure = NO_SWITCH, -1, True
    for which in WATCHED:
        theta, tells = _crossing(which, samples, i)
        if theta == NO_SWITCH:
            continue
        if abs(theta - first) < _TOGETHER or not tells:
            sure = False
        if theta < first:
            first, which_first = theta, which
    return which_first, first, sure


@kernel
def _first_switch(method, lanes, runs, work, i):
    """(which, θ) of the first switch, by the reference engine's search on the dense output."""
    time, h = runs[TIME, i], runs[LENGTH, i]
    p, mode = constants_of(runs, i), mode_of(runs, i)
    for n in range(STATE_SIZE):
        work.y[n] = runs[STATE + n, i]
        for j in range(METHOD.c.size):
            work.k[j, n] = lanes.k[j, n * LANES + i]
    dense_coefficients(method, work.k, work.dense)
    sample_step(time, h, work.y, work.dense, p, mode, work.nodes, work.samples)
    return first_switch(time, h, work.y, work.dense, p, mode, work.samples)


@kernel
def _complete(length, lanes, runs, i):
    """Move the run to the end of its step."""
    note_step(length, runs[STEP_TILT, i], runs[STEP_FORCE, i], runs, i)
    for which in WATCHED:
        lowest = min(runs[CLOSEST + which, i], lanes.samples[NODES, which, i])
        runs[CLOSEST + which, i] = lowest
    for n in range(STATE_SIZE):
        runs[STATE + n, i] = runs[Y_END + n, i]
    runs[TIME, i] += length


@kernel
def _go_on(lanes, runs, i):
    """Let a lane step on from the state and mode that the run has come to."""
    runs[PHASE, i] = STEPPING
    q = state_in(runs, STATE, i)
    rates = rates_of(runs[TIME, i], q, constants_of(runs, i), mode_of(runs, i))
    runs[EVALUATIONS, i] += 1.0
    for n in range(STATE_SIZE):
        lanes.k[0, n * LANES + i] = rates[n]


@kernel
def _land_on(which, theta, searched, runs, i):
    """Repeat the step up to a switch found in it."""
    if runs[PHASE, i] == STEPPING:
        runs[FULL_STEP, i], runs[LANDINGS, i] = runs[LENGTH, i], 0.0
    runs[PHASE, i], runs[WHICH, i], runs[SEARCHED, i] = LANDING, which, searched
    runs[LENGTH, i] *= theta


@inlined_kernel
def _look_into(declared, method, lanes, runs, work, i):
    """A step in which something shows: whether it stands, with no switch in it after all."""
    which, theta, sure = _first_crossing(lanes.samples, i)
    search = not sure or runs[SHOWN, i] == UNCLEAR or runs[PHASE, i] == SEARCHING
    if search:
        which, theta = _first_switch(method, lanes, runs, work, i)
    if theta == NO_SWITCH:
        runs[PHASE, i] = STEPPING
        return True
    _land_on(which, theta, 1.0 if search else 0.0, runs, i)
    if theta == 0.0:
        make_switch(which, 0.0, runs[FULL_STEP, i], declared, runs, i)
    return False


@kernel
def _other_crossing(lanes, i, landing):
    """Whether another function than the one landed on is below zero in the step."""
    samples = lanes.samples
    for which in WATCHED:
        if which != landing and samples[0, which, i] != NEVER:
            for node in range(1, NODES):
                if samples[node, which, i] < 0.0 and samples[node - 1, which, i] > 0.0:
                    return True
    return False


@kernel
def _at_end(which, lanes, runs, i):
    """(value, slope) of function ``which`` at the end of the step."""
    samples, length = lanes.samples, runs[LENGTH, i]
    if not is_corner(which):
        g = samples[NODES - 1, which, i]
        _, _, _, _, rise = slopes(
            samples[0, which, i], samples[1, which, i], samples[2, which, i],
            samples[3, which, i], g,
        )  # fmt: skip
        return g, rise / (0.25 * length)
    p, mode, time = constants_of(runs, i), mode_of(runs, i), runs[TIME, i] + length
    q, back = state_in(runs, Y_END, i), -_NEAR * length
    g = switching_function(which, time, q, p, mode)
    before = short_step(time, back, q, p, mode)
    runs[EVALUATIONS, i] += 4.0
    return g, (switching_function(which, time + back, before, p, mode) - g) / back


@inlined_kernel
def _approach(which, g, by, runs, i):
    """Move Y_END onto the switch ``which``, ``by`` away where its function is ``g``.

    The secant method on steps so short that RK4 makes no error in them, and never back beyond the
    step's start. Returns the way made and whether it ends on the switch.
    """
    p, mode, length = constants_of(runs, i), mode_of(runs, i), runs[LENGTH, i]
    time = runs[TIME, i] + length
    q, way = state_in(runs, Y_END, i), 0.0
    enough = max(1e-15 * time, SWITCH_RESOLUTION * sqrt(runs[TOLERANCE, i]))
    trials = 0
    while abs(by) > enough and trials < _MOST_APPROACHES and length + way + by >= 0.0:
        trials += 1
        q = short_step(time + way, by, q, p, mode)
        runs[EVALUATIONS, i] += 4.0
        way += by
        f, g = g, switching_function(which, time + way, q, p, mode)
        slope = (g - f) / by
        further = -g / slope if slope < 0.0 else 2.0 * by
        if abs(further) > abs(by):
            break
        by = further
    there = abs(by) <= enough and length + way + by >= 0.0
    if there:
        q = moved(q, by, rates_of(time + way, q, p, mode))
        runs[EVALUATIONS, i] += 1.0
        way += by
    keep_state_in(q, runs, Y_END, i)
    return way, there


@inlined_kernel
def _land(declared, method, lanes, runs, work, i):
    """Judge a step toward a switch: switch there, or try another length."""
    which, length, full = int(runs[WHICH, i]), runs[LENGTH, i], runs[FULL_STEP, i]
    runs[LANDINGS, i] += 1.0
    if _other_crossing(lanes, i, which) and runs[LANDINGS, i] < _MOST_LANDINGS:
        earlier, theta = _first_switch(method, lanes, runs, work, i)
        if theta < 1.0 - 1e-9:
            _land_on(earlier, theta, 1.0, runs, i)
            return
    g, slope = _at_end(which, lanes, runs, i)
    by = -g / slope if slope < 0.0 else full
    near, there = abs(by) <= _NEAR * full, False
    if near:
        way, there = _approach(which, g, by, runs, i)
        length += way
    if runs[SEARCHED, i] == 0.0 and not there:
        if not near and runs[LANDINGS, i] < _MOST_TRIALS and 0.0 < length + by < full:
            runs[LENGTH, i] += by
        else:
            runs[PHASE, i], runs[LENGTH, i] = SEARCHING, full
        return
    _complete(length, lanes, runs, i)
    make_switch(which, length, full, declared, runs, i)
    runs[PHASE, i] = STEPPING


@inlined_kernel
def _stand(lanes, runs, i):
    """Complete a step without a switch; whether it reached its stop."""
    length, step = runs[LENGTH, i], runs[NEXT_STEP, i]
    _complete(length, lanes, runs, i)
    grown = length * runs[GROWTH, i]
    at_stop = length != step
    if at_stop:
        runs[TIME, i] = runs[STOP, i]
        # A step cut short by a stop says nothing against the length it was cut from.
        grown = max(step, grown)
    runs[NEXT_STEP, i] = grown
    return at_stop


@inlined_kernel
def _look_after(declared, method, control, lanes, runs, history, work, i):
    """Let lane ``i`` go on after a step that shows something."""
    if runs[SHOWN, i] == REJECTED_STEP:
        if is_too_short(runs[NEXT_STEP, i], runs[TIME, i]):
            q = state_in(runs, STATE, i)
            rates = rates_of(runs[TIME, i], q, constants_of(runs, i), mode_of(runs, i))
            fail(runs, i, _STEP_TOO_SMALL if are_finite(rates) else _NOT_FINITE)
        return
    at_stop = False
    if runs[PHASE, i] == LANDING:
        _land(declared, method, lanes, runs, work, i)
        if runs[PHASE, i] != STEPPING:
            return
    else:
        stands = runs[SHOWN, i] == AT_STOP or _look_into(declared, method, lanes, runs, work, i)
        if stands:
            at_stop = _stand(lanes, runs, i)
        elif runs[LENGTH, i] > 0.0:
            return
    end_step(at_stop, history, control, runs, i)
    _go_on(lanes, runs, i)


@kernel
def _run_elsewhere(declared, method, control, lanes, runs, history, work, i):
    """Advance a run by the reference engine until lanes can hold it, or it ends."""
    while runs[OUTCOME, i] == CONTINUES and not lanes_hold(mode_of(runs, i)):
        advance(declared, method, control, work.nodes[:0], history, work, runs, i)
    _go_on(lanes, runs, i)


class Many(NamedTuple):
    """Memory for as many runs at a time as there are lanes."""

    lanes: Lanes
    history: History
    work: Workspace
    sums: Combinations


def new_many() -> Many:
    """A ``Many`` without runs."""
    return Many(new_lanes(), new_history(LANES), new_workspace(METHOD), COMBINATIONS)


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
    lanes, history = borrowed_lanes(many.lanes), borrowed_history(many.history)
    work, rows, endings = borrowed_workspace(many.work), borrowed(rows), borrowed(endings)
    runs = lanes.w.reshape(LANE_ROWS, LANES)
    queue = 0
    runs[PHASE] = IDLE
    runs[OUTCOME] = CONTINUES
    while True:
        active = False
        for i in range(LANES):
            if runs[PHASE, i] != IDLE:
                if runs[SHOWN, i] != CLEAR:
                    _look_after(declared, method, control, lanes, runs, history, work, i)
                    if runs[PHASE, i] == STEPPING and not lanes_hold(mode_of(runs, i)):
                        _run_elsewhere(declared, method, control, lanes, runs, history, work, i)
                # Whatever a lane does between two ends of a step, also while it only steps on.
                if runs[EVALUATIONS, i] > control.max_evaluations and runs[OUTCOME, i] == CONTINUES:
                    fail(runs, i, _TOO_MANY_EVALUATIONS)
                if runs[OUTCOME, i] != CONTINUES:
                    keep_ending(ending_of(runs, i), endings, int(runs[ROW_OF_BATCH, i]))
                    runs[PHASE, i] = IDLE
            while runs[PHASE, i] == IDLE and queue < rows.shape[0]:
                begin(rows[queue], tolerances[queue], declared, control, runs, i)
                runs[ROW_OF_BATCH, i] = queue
                _run_elsewhere(declared, method, control, lanes, runs, history, work, i)
                if runs[OUTCOME, i] != CONTINUES:
                    keep_ending(ending_of(runs, i), endings, queue)
                    runs[PHASE, i] = IDLE
                queue += 1
            active = active or runs[PHASE, i] != IDLE
        if not active:
            break
        step_all(method, many.sums, lanes)
