"""Many runs side by side: one step of DOP853 in all lanes at once, and what it shows.

The loops over lanes are plain arithmetic on one flat array, each lane with its own time, step and
mode, so that a compiler carries eight or more runs in one vector register. A row of ``w`` holds one
number of every lane: row r of lane i stands at ``w[r * LANES + i]``. The first rows are those of
record.py.

Lanes hold the modes in which the part stands on A1 or flies, alone or with A2 on its side face;
other modes, and readings of the printed equations, are left to the reference engine.
"""

import math
from math import isnan, sqrt
from typing import NamedTuple

import numpy as np

from model.physics.compiled import borrowed, inlined_kernel, kernel
from model.physics.motion import is_supported, motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.parameters import Constants
from model.physics.scenes import OPEN, STICKING, Mode
from model.solver.record import (
    CLOSEST,
    EVALUATIONS,
    FORCE_MAX,
    MODE,
    NEXT_STEP,
    REJECTED,
    ROWS,
    STATE,
    STATE_SIZE,
    STEPS,
    STICKING_TIME,
    STOP,
    TILT_MAX,
    TIME,
    TOLERANCE,
)
from model.solver.step import CAUTION, LEAST_GROWTH, LEAST_SHRINKING, MOST_GROWTH
from model.solver.switching import (
    COMBINED_COUNT,
    CORNER_END,
    CORNER_GAP,
    CORNER_LOAD,
    CORNER_RELOAD,
    FACE_LOAD,
    FLAT,
    LEFT_CORNER_LANDS,
    NEVER,
    ON_A_SWITCH,
    RIGHT_CORNER_LANDS,
    SAMPLE_SIZE,
    SIDE_LOAD,
    SWITCH_COUNT,
    corner_below,
    switching_sample,
)
from model.solver.tableaux import DOP853, Array, Tableau
from model.solver.transitions import hold_sticking

LANES = 16  # two vectors of eight; with more, a batch waits longer for its last runs
NODES = 5  # places of a step at which it is sampled: its ends and quarters
METHOD = DOP853.method

# What a lane does.
# SEARCHING repeats a step for its dense output.
IDLE, STEPPING, LANDING, SEARCHING = 0.0, 1.0, 2.0, 3.0
# What a step has shown, what matters more the larger.
CLEAR, AT_STOP, CROSSING, UNCLEAR, REJECTED_STEP = 0.0, 1.0, 2.0, 3.0, 4.0

# Rows behind those of the record.
(
    PHASE,
    LENGTH,
    SHOWN,
    GROWTH,  # the next step over this one
    STEP_TILT,  # largest |tilt| in the step
    STEP_FORCE,  # largest normal force in the step
    REACH,  # more than any corner or edge moves in half a quarter of the step
    WHICH,  # the switch that a lane lands on
    FULL_STEP,  # the step in which it was found
    LANDINGS,  # steps made toward it
    SEARCHED,  # 1.0 where it was found on the dense output
) = range(ROWS, ROWS + 11)
LENGTHS = SEARCHED + 1  # the length, once for each component of the state
TRIAL = LENGTHS + STATE_SIZE
RATES = TRIAL + STATE_SIZE
Y_END = RATES + STATE_SIZE
SUM = Y_END + STATE_SIZE
COARSE_SUM = SUM + STATE_SIZE
SAMPLE = COARSE_SUM + STATE_SIZE
TILT_SAMPLE = SAMPLE + SAMPLE_SIZE
SPEED_SAMPLE = TILT_SAMPLE + 1
LANE_ROWS = SPEED_SAMPLE + 1
SAMPLE_ROWS = SAMPLE_SIZE + 2

_BLOCK = STATE_SIZE * LANES  # one state of every lane
_CACHE_LINE = 64  # bytes
_TOO_FLAT_TO_TELL = 10.0 * FLAT
_NO_CORNER = (CORNER_LOAD, CORNER_GAP, CORNER_RELOAD, CORNER_END)
WATCHED = np.array([which for which in range(SWITCH_COUNT) if which not in _NO_CORNER])


class Lanes(NamedTuple):
    """Runs side by side.

    Shapes: w (LANE_ROWS * LANES,); k (m, 6 * LANES), the stages, component by component; samples
    (NODES + 1, SAMPLE_ROWS, LANES), the switching functions, |tilt| and a bound of the speed at the
    step's quarters and, behind them, the lowest switching functions of the step.
    """

    w: Array
    k: Array
    samples: Array


class Combinations(NamedTuple):
    """Weighted sums of stages, their terms without weight left out and filled up to fours.

    Shapes: weights and stages (sums, terms), fours (sums,). The sums, in order: the states at which
    stages 1 to m - 1 are evaluated, those at the step's quarters, and the two error estimates.
    """

    weights: Array
    stages: np.ndarray
    fours: np.ndarray


def _combinations(tableau: Tableau) -> Combinations:
    quarters = np.array([0.25, 0.5, 0.75])
    powers = quarters[:, None] ** np.arange(1, tableau.dense.shape[1] + 1)
    sums = [*tableau.a[1:], *(powers @ tableau.dense.T), *tableau.error]
    terms = [np.flatnonzero(weights) for weights in sums]
    fours = np.array([-(-len(each) // 4) for each in terms])
    weights, stages = np.zeros((2, len(sums), 4 * fours.max()))
    for row, (each, values) in enumerate(zip(terms, sums, strict=True)):
        weights[row, : len(each)] = values[each]
        stages[row, : len(each)] = each
    return Combinations(weights, stages.astype(np.int64), fours)


COMBINATIONS = _combinations(DOP853)
_FIRST_QUARTER = METHOD.c.size - 1  # which sum
_FINE, _COARSE = _FIRST_QUARTER + 3, _FIRST_QUARTER + 4


@inlined_kernel
def _constants(w, i):
    """``Constants`` of lane ``i``, consistent readings."""
    n = LANES
    return Constants(
        w[i], w[n + i], w[2 * n + i], w[3 * n + i], w[4 * n + i], w[5 * n + i], w[6 * n + i],
        w[7 * n + i], w[8 * n + i], w[9 * n + i], w[10 * n + i], w[11 * n + i], w[12 * n + i],
        w[13 * n + i], w[14 * n + i], w[15 * n + i], w[16 * n + i], w[17 * n + i], w[18 * n + i],
        w[19 * n + i], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip


@inlined_kernel
def _mode(w, i):
    """``Mode`` of lane ``i``, of those that lanes hold."""
    return Mode(
        RIGHT_EDGE,
        int(w[(MODE + 1) * LANES + i]),
        OPEN,
        0.0,
        False,
        int(w[(MODE + 5) * LANES + i]),
        int(w[(MODE + 6) * LANES + i]),
        int(w[(MODE + 7) * LANES + i]),
        w[(MODE + 8) * LANES + i] != 0.0,
    )


@inlined_kernel
def lanes_hold(mode):
    """Whether lanes can carry this mode."""
    return mode.edge == RIGHT_EDGE and mode.corner == OPEN


@inlined_kernel
def _state(w, row, i):
    n = LANES
    return State(
        w[row * n + i], w[(row + 1) * n + i], w[(row + 2) * n + i],
        w[(row + 3) * n + i], w[(row + 4) * n + i], w[(row + 5) * n + i],
    )  # fmt: skip


@inlined_kernel
def _keep_state(q, row, w, i):
    n = LANES
    w[row * n + i], w[(row + 1) * n + i], w[(row + 2) * n + i] = q.x, q.y, q.tilt
    w[(row + 3) * n + i], w[(row + 4) * n + i], w[(row + 5) * n + i] = (
        q.x_rate,
        q.y_rate,
        q.tilt_rate,
    )


def _on_cache_lines(*shape: int) -> Array:
    """Zeros that begin on a cache line, as then every row does: no vector lies across two."""
    count, line = math.prod(shape), _CACHE_LINE // 8
    numbers = np.zeros(count + line)
    first = -numbers.ctypes.data % _CACHE_LINE // 8
    return numbers[first : first + count].reshape(shape)


def new_lanes() -> Lanes:
    """Lanes without runs."""
    return Lanes(
        _on_cache_lines(LANE_ROWS * LANES),
        _on_cache_lines(METHOD.c.size, _BLOCK),
        _on_cache_lines(NODES + 1, SAMPLE_ROWS, LANES),
    )


@kernel
def borrowed_lanes(lanes):
    """``lanes`` without reference counts."""
    return Lanes(borrowed(lanes.w), borrowed(lanes.k), borrowed(lanes.samples))


@kernel
def _set_lengths(w):
    """Choose every lane's length: what the last step proposes, cut at the stop."""
    for i in range(LANES):
        time, step, stop = w[TIME * LANES + i], w[NEXT_STEP * LANES + i], w[STOP * LANES + i]
        length = stop - time if time + 1.0001 * step >= stop else step
        phase = w[PHASE * LANES + i]
        length = w[LENGTH * LANES + i] if phase >= LANDING else length
        w[LENGTH * LANES + i] = 0.0 if phase == IDLE else length
    for n in range(STATE_SIZE):
        for i in range(LANES):
            w[(LENGTHS + n) * LANES + i] = w[LENGTH * LANES + i]


@kernel
def _combine(which, sums, w, k):
    """Σ_j weights[j] k_j into the rows SUM."""
    for e in range(_BLOCK):
        w[SUM * LANES + e] = 0.0
    for four in range(sums.fours[which]):
        t = 4 * four
        w0, w1 = sums.weights[which, t], sums.weights[which, t + 1]
        w2, w3 = sums.weights[which, t + 2], sums.weights[which, t + 3]
        j0, j1 = sums.stages[which, t], sums.stages[which, t + 1]
        j2, j3 = sums.stages[which, t + 2], sums.stages[which, t + 3]
        for e in range(_BLOCK):
            w[SUM * LANES + e] += w0 * k[j0, e] + w1 * k[j1, e] + w2 * k[j2, e] + w3 * k[j3, e]


@kernel
def _move(which, sums, w, k):
    """The state y + h Σ_j weights[j] k_j into the rows TRIAL."""
    _combine(which, sums, w, k)
    for e in range(_BLOCK):
        w[TRIAL * LANES + e] = w[STATE * LANES + e] + w[LENGTHS * LANES + e] * w[SUM * LANES + e]


@kernel
def _evaluate(c, w):
    """dy/dτ at the fraction ``c`` of the step and the state in TRIAL, into the rows RATES."""
    for i in range(LANES):
        q = _state(w, TRIAL, i)
        time = w[TIME * LANES + i] + c * w[LENGTH * LANES + i]
        at = motion(time, q, _constants(w, i), _mode(w, i))
        _keep_state(State(q.x_rate, q.y_rate, q.tilt_rate, at.x, at.y, at.tilt), RATES, w, i)


@kernel
def _take_step(method, sums, w, k):
    """Stages 1 to the last of the continuous extension, the step's end into Y_END."""
    for stage in range(1, method.c.size):
        _move(stage - 1, sums, w, k)
        if stage == method.stages:
            for e in range(_BLOCK):
                w[Y_END * LANES + e] = w[TRIAL * LANES + e]
        _evaluate(method.c[stage], w)
        for e in range(_BLOCK):
            k[stage, e] = w[RATES * LANES + e]


@kernel
def _judge_step(sums, w, k):
    """Error of the step over tolerance, as in step.py, into what follows from it.

    GROWTH is the next step over this one; SHOWN is CLEAR where the step stands.
    """
    _combine(_COARSE, sums, w, k)
    for e in range(_BLOCK):
        w[COARSE_SUM * LANES + e] = w[SUM * LANES + e]
    _combine(_FINE, sums, w, k)
    for i in range(LANES):
        fine, coarse = 0.0, 0.0
        for n in range(STATE_SIZE):
            start, end = w[(STATE + n) * LANES + i], w[(Y_END + n) * LANES + i]
            per_scale = 1.0 / (w[TOLERANCE * LANES + i] * (1.0 + max(abs(start), abs(end))))
            first = w[(SUM + n) * LANES + i] * per_scale
            second = w[(COARSE_SUM + n) * LANES + i] * per_scale
            fine += first * first
            coarse += second * second
        length = w[LENGTH * LANES + i]
        square = (fine + 0.01 * coarse) * STATE_SIZE
        error = length * fine / sqrt(square) if fine > 0.0 else 0.0
        error = 1e300 if isnan(fine) else error
        growth = CAUTION / sqrt(sqrt(sqrt(max(error, 1e-12))))  # error^(-1/8), the step's order
        stands = error <= 1.0 or w[PHASE * LANES + i] != STEPPING
        least = LEAST_GROWTH if stands else LEAST_SHRINKING
        w[GROWTH * LANES + i] = min(max(growth, least), MOST_GROWTH)
        w[SHOWN * LANES + i] = CLEAR if stands else REJECTED_STEP


@inlined_kernel
def _keep_sample(sample, w, i):
    # Each by its own constant: an index that varies keeps the loop over lanes scalar.
    at, n = SAMPLE * LANES + i, LANES
    w[at + 0 * n], w[at + 1 * n] = sample[0], sample[1]
    w[at + 2 * n], w[at + 3 * n] = sample[2], sample[3]
    w[at + 4 * n], w[at + 5 * n] = sample[4], sample[5]
    w[at + 6 * n], w[at + 7 * n] = sample[6], sample[7]
    w[at + 8 * n], w[at + 9 * n] = sample[8], sample[9]
    w[at + 10 * n], w[at + 11 * n] = sample[10], sample[11]
    w[at + 12 * n], w[at + 13 * n] = sample[12], sample[13]
    w[at + 14 * n], w[at + 15 * n] = sample[14], sample[15]
    w[at + 16 * n], w[at + 17 * n] = sample[16], sample[17]
    w[at + 18 * n], w[at + 19 * n] = sample[18], sample[19]
    w[at + 20 * n], w[at + 21 * n] = sample[20], sample[21]
    w[at + 22 * n], w[at + 23 * n] = sample[22], sample[23]
    w[at + 24 * n], w[at + 25 * n] = sample[24], sample[25]
    w[at + 26 * n], w[at + 27 * n] = sample[26], sample[27]
    w[at + 28 * n], w[at + 29 * n] = sample[28], sample[29]
    w[at + 30 * n], w[at + 31 * n] = sample[30], sample[31]


@inlined_kernel
def _largest_speed(q, p):
    """What no corner of the part is faster than, nor an edge in its frame, nor its tilt."""
    to_corner, to_edge = p.half_width + p.half_height, p.slot_half_width + abs(q.x) + abs(q.y)
    return abs(q.x_rate) + abs(q.y_rate) + abs(q.tilt_rate) * max(1.0, max(to_corner, to_edge))


@kernel
def _sample(node, w, samples):
    """Switching functions at a quarter of the step, the state in TRIAL, into SAMPLES.

    A corner that comes down on the flat is watched as long as it stands below the plane, whether it
    moves down or not: the lower of the two, and smooth for longer.
    """
    theta = 0.25 * node
    for i in range(LANES):
        q, p = _state(w, TRIAL, i), _constants(w, i)
        time, mode = w[TIME * LANES + i] + theta * w[LENGTH * LANES + i], _mode(w, i)
        sample = switching_sample(time, q, p, mode)
        right = corner_below(RIGHT_EDGE, q, p)
        left = corner_below(LEFT_EDGE, q, p)
        _keep_sample(sample, w, i)
        w[(SAMPLE + RIGHT_CORNER_LANDS) * LANES + i] = right[0]
        w[(SAMPLE + LEFT_CORNER_LANDS) * LANES + i] = left[0] if mode.side == OPEN else NEVER
        w[(SAMPLE + SWITCH_COUNT + RIGHT_CORNER_LANDS) * LANES + i] = right[1]
        w[(SAMPLE + SWITCH_COUNT + LEFT_CORNER_LANDS) * LANES + i] = left[1]
    for i in range(LANES):  # by itself: the loop above is as long as it may be
        q = _state(w, TRIAL, i)
        w[TILT_SAMPLE * LANES + i] = abs(q.tilt)
        w[SPEED_SAMPLE * LANES + i] = _largest_speed(q, _constants(w, i))
    for j in range(SAMPLE_ROWS):
        for i in range(LANES):
            samples[node, j, i] = w[(SAMPLE + j) * LANES + i]


@kernel
def _sample_step(sums, w, k, samples):
    for e in range(_BLOCK):
        w[TRIAL * LANES + e] = w[STATE * LANES + e]
    _sample(0, w, samples)
    for node in range(1, NODES - 1):
        _move(_FIRST_QUARTER + node - 1, sums, w, k)
        _sample(node, w, samples)
    for e in range(_BLOCK):
        w[TRIAL * LANES + e] = w[Y_END * LANES + e]
    _sample(NODES - 1, w, samples)


@inlined_kernel
def slopes(g0, g1, g2, g3, g4):
    """Slopes, per quarter, of the quartic through five samples at a step's quarters."""
    twelfth = 1.0 / 12.0
    return (
        twelfth * (-25.0 * g0 + 48.0 * g1 - 36.0 * g2 + 16.0 * g3 - 3.0 * g4),
        twelfth * (-3.0 * g0 - 10.0 * g1 + 18.0 * g2 - 6.0 * g3 + g4),
        twelfth * (g0 - 8.0 * g1 + 8.0 * g3 - g4),
        twelfth * (-g0 + 6.0 * g1 - 18.0 * g2 + 10.0 * g3 + 3.0 * g4),
        twelfth * (3.0 * g0 - 16.0 * g1 + 36.0 * g2 - 48.0 * g3 + 25.0 * g4),
    )


@inlined_kernel
def _may_dip(f_left, f_right, slope_left, slope_right):
    """Whether a function with a minimum between two samples may fall below zero there.

    It lies above its tangents: the place where they meet bounds it.
    """
    turns = (slope_left < 0.0) & (slope_right > 0.0)
    bound = f_left * slope_right - slope_left * f_right + slope_left * slope_right
    return turns & (bound < 0.0)


@inlined_kernel
def is_corner(which):
    """Whether a function is sampled without its closing rate, so that its samples do not tell."""
    return which == RIGHT_CORNER_LANDS or which == LEFT_CORNER_LANDS


@kernel
def _may_show(which, w, samples):
    """Whether in any lane function ``which`` is so low, for its changes, that it needs a look.

    Also enters its lowest sample. A slope of the quartic is at most 16/3 of the samples' range, and
    two tangents meet by no more than half a slope below the lower sample.
    """
    lanes = 0
    for i in range(LANES):
        g0, g1, g2 = samples[0, which, i], samples[1, which, i], samples[2, which, i]
        g3, g4 = samples[3, which, i], samples[4, which, i]
        lowest = min(min(g1, g2), min(g3, g4))
        highest = max(max(g0, g1), max(max(g2, g3), g4))
        low = min(g0, lowest)
        far = max(w[REACH * LANES + i], _TOO_FLAT_TO_TELL)
        lanes += 0 if low > 8.0 / 3.0 * (highest - low) and low > far else 1
        samples[NODES, which, i] = lowest if g0 > ON_A_SWITCH else NEVER
    return lanes > 0


@kernel
def _screen(which, w, samples):
    """Raise SHOWN where function ``which`` falls through zero in the step, or may do so."""
    combined = which < COMBINED_COUNT
    place = which + SWITCH_COUNT if combined else which
    corner = is_corner(which)
    for i in range(LANES):
        g0, g1, g2 = samples[0, which, i], samples[1, which, i], samples[2, which, i]
        g3, g4 = samples[3, which, i], samples[4, which, i]
        s0, s1, s2, s3, s4 = slopes(g0, g1, g2, g3, g4)
        lowest = min(min(g1, g2), min(g3, g4))
        # A mode starts on its own switch, as far as that is located, and leaves it.
        leaves = abs(g0) <= 0.1 * w[TOLERANCE * LANES + i]
        dips = (
            (not leaves) & _may_dip(g0, g1, s0, s1)
            | _may_dip(g1, g2, s1, s2)
            | _may_dip(g2, g3, s2, s3)
            | _may_dip(g3, g4, s3, s4)
        )
        # Where another quantity has become the largest, all may have been negative in between. The
        # one falls to zero and the other rises from there, both within a quarter of the step.
        p0 = samples[0, place, i]
        near = min(g0, lowest) < w[REACH * LANES + i]
        turns = (combined & near) & (
            (p0 != samples[1, place, i])
            | (p0 != samples[2, place, i])
            | (p0 != samples[3, place, i])
            | (p0 != samples[4, place, i])
        )
        # Near flat, a tilt too small for the samples decides whether the corner lands.
        flat = corner & (min(g0, lowest) < _TOO_FLAT_TO_TELL)
        shown = UNCLEAR if dips | turns | flat else CLEAR
        shown = max(shown, CROSSING) if lowest < 0.0 else shown
        shown = CLEAR if g0 == NEVER else shown
        w[SHOWN * LANES + i] = max(w[SHOWN * LANES + i], shown)


@inlined_kernel
def _peak(left, middle, right):
    """Highest value of the parabola through three equidistant samples, if the middle is highest."""
    bend = 2.0 * middle - left - right
    change = right - left
    peaks = middle >= left and middle >= right and bend > 0.0
    return middle + 0.125 * change * change / bend if peaks else middle


@inlined_kernel
def _load(samples, node, row, i):
    load = samples[node, row, i]
    return load if load != NEVER else 0.0


@kernel
def _note_largest(w, samples):
    """Largest |tilt| and normal force of the step, and its reach."""
    for i in range(LANES):
        tilt, force, speed = 0.0, 0.0, 0.0
        for node in range(NODES):
            tilt = max(tilt, samples[node, SAMPLE_SIZE, i])
            speed = max(speed, samples[node, SAMPLE_SIZE + 1, i])
            force = max(force, _load(samples, node, FACE_LOAD, i))
            force = max(force, _load(samples, node, SIDE_LOAD, i))
        for node in range(1, NODES - 1):
            before, after = node - 1, node + 1
            tilt = max(
                tilt,
                _peak(
                    samples[before, SAMPLE_SIZE, i],
                    samples[node, SAMPLE_SIZE, i],
                    samples[after, SAMPLE_SIZE, i],
                ),
            )
            for row in (FACE_LOAD, SIDE_LOAD):
                force = max(
                    force,
                    _peak(
                        _load(samples, before, row, i),
                        _load(samples, node, row, i),
                        _load(samples, after, row, i),
                    ),
                )
        w[STEP_TILT * LANES + i] = tilt
        w[STEP_FORCE * LANES + i] = force
        # Between two samples it may be faster than at both; twice as fast is ample.
        w[REACH * LANES + i] = 2.0 * speed * 0.125 * w[LENGTH * LANES + i]


@kernel
def _accept(w, k, samples):
    """Complete the steps that stand and show nothing: the usual way of a step, in all lanes."""
    for i in range(LANES):
        length, step = w[LENGTH * LANES + i], w[NEXT_STEP * LANES + i]
        shown = w[SHOWN * LANES + i]
        stepping = w[PHASE * LANES + i] == STEPPING
        cut = length != step
        at_stop = cut and shown == CLEAR and stepping
        shown = AT_STOP if at_stop else shown
        w[SHOWN * LANES + i] = shown if stepping or shown == UNCLEAR else CROSSING
        clear = stepping and shown == CLEAR
        rejected = stepping and shown == REJECTED_STEP
        grown = length * w[GROWTH * LANES + i]
        w[NEXT_STEP * LANES + i] = grown if clear or rejected else step
        w[TIME * LANES + i] += length if clear else 0.0
        w[STEPS * LANES + i] += 1.0 if clear else 0.0
        w[REJECTED * LANES + i] += 1.0 if rejected else 0.0
        w[EVALUATIONS * LANES + i] += METHOD.c.size - 1.0
        mode, p = _mode(w, i), _constants(w, i)
        counted = clear and not mode.dropped
        tilt, force = w[STEP_TILT * LANES + i], w[STEP_FORCE * LANES + i]
        w[TILT_MAX * LANES + i] = max(w[TILT_MAX * LANES + i], tilt if counted else 0.0)
        w[FORCE_MAX * LANES + i] = max(w[FORCE_MAX * LANES + i], force if counted else 0.0)
        sticks = counted and mode.support_slip == STICKING and is_supported(mode)
        w[STICKING_TIME * LANES + i] += length if sticks else 0.0
        q, end = _state(w, STATE, i), hold_sticking(_state(w, Y_END, i), p, mode)
        _keep_state(
            State(
                end.x if clear else q.x,
                end.y if clear else q.y,
                end.tilt if clear else q.tilt,
                end.x_rate if clear else q.x_rate,
                end.y_rate if clear else q.y_rate,
                end.tilt_rate if clear else q.tilt_rate,
            ),
            STATE, w, i,
        )  # fmt: skip
    for n in range(STATE_SIZE):
        for i in range(LANES):
            clear = w[SHOWN * LANES + i] == CLEAR
            first, last = k[0, n * LANES + i], k[METHOD.stages, n * LANES + i]
            k[0, n * LANES + i] = last if clear else first
    runs = w.reshape(LANE_ROWS, LANES)
    for which in WATCHED:
        for i in range(LANES):
            clear = w[SHOWN * LANES + i] == CLEAR
            so_far, here = runs[CLOSEST + which, i], samples[NODES, which, i]
            runs[CLOSEST + which, i] = min(so_far, here) if clear else so_far


@kernel
def step_all(method, sums, lanes):
    """Try one step in every lane, complete those that show nothing, and say in SHOWN the others."""
    w, k, samples = lanes
    _set_lengths(w)
    _take_step(method, sums, w, k)
    _judge_step(sums, w, k)
    _sample_step(sums, w, k, samples)
    _note_largest(w, samples)
    for which in WATCHED:
        if _may_show(which, w, samples):
            _screen(which, w, samples)
    _accept(w, k, samples)
