"""Stiff bases: implicit steps where damping, and not accuracy, limits explicit ones.

A hard base that damps well ends a contact's own fast motion within moments. What is left is smooth,
but an explicit step stays below some 6/|λ| to be stable, λ being the fast motion's rate. Between
switches such a run is carried by Radau IIA, an implicit collocation that damps what is fast. The
transient after a switch, and the way to the next one, are left to the reference engine's explicit
steps: every switch is located and made by loop.py.

The unknowns of a step are the accelerations at its places; velocities and positions follow from
them by integration. Radau IIA: Hairer and Wanner, Solving Ordinary Differential Equations II, sect.
IV.5 (nodes), IV.8 (Newton's iteration, error estimate).
"""

from math import isfinite, sqrt
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from model.engines.course import begin, end_step, note_step
from model.engines.queue import next_in
from model.engines.record import (
    EVALUATIONS,
    NEXT_STEP,
    OUTCOME,
    REJECTED,
    STATE,
    STOP,
    TIME,
    TOLERANCE,
    constants_of,
    ending_of,
    keep_ending,
    keep_state,
    mode_of,
    state_in,
)
from model.engines.scalar.loop import (
    advance,
    note_closest,
    side_force,
    support_force,
    track_run,
    track_sample,
)
from model.engines.scalar.step import CAUTION, LEAST_SHRINKING, MOST_GROWTH, keep_in, state_of
from model.engines.scalar.tableaux import Array
from model.events.table import (
    COMBINED_COUNT,
    NEVER,
    SAMPLE_SIZE,
    SWITCH_COUNT,
    switching_functions,
)
from model.events.transitions import CONTINUES, hold_sticking
from model.physics.compiled import inlined_kernel, kernel
from model.physics.contacts import corner_on_flat, dot, edge_on_face, edge_on_side
from model.physics.motion import motion
from model.physics.notation import STATE_SIZE
from model.physics.parameters import Constants
from model.physics.scenes import CLOSED

_STAGES = 7
_HALF = STATE_SIZE // 2  # positions, as many as velocities
_UNKNOWNS = _STAGES * _HALF
_LIMITED = 0.5  # |λ| times the length from which on stability may limit an explicit step
_WORTH = 6.0  # an implicit step over an explicit one, from which on it costs less
_FIRST = 10.0  # the first implicit step over the explicit one
_MOST_ITERATIONS = 8
_SLOW = 0.1  # contraction of Newton's iteration from which on its matrix is renewed
_ENOUGH = 1e-2  # last correction over the error that a step may make
_ROUNDING = 4e-16
_DIFFERENCE = 1e-8  # for derivatives, relative to 1 + |state|
_PAUSES = 8.0, 256.0  # explicit steps after an implicit one has failed, doubled each time
_BEFORE = 0.9  # how much of the way to a switch an implicit step goes

# What a run given to this engine must at least have: |λ| and the rate at which its motion decays.
_FAST, _DAMPED = 500.0, 100.0


class Collocation(NamedTuple):
    """Radau IIA as data.

    Shapes: places (s + 1,), 0 and the nodes, the last of which is 1; once (s, s), weights of a
    function's values at the nodes in its integrals up to them; twice (s, s), in the integrals'
    integrals; error (s + 1,), weights of a rate at the places in the estimate of its integral's
    error.
    """

    places: Array
    once: Array
    twice: Array
    error: Array


def radau(stages: int) -> Collocation:
    """Radau IIA with an odd number of ``stages``, of order 2 ``stages`` - 1.

    The error estimate is of order ``stages``: how far the collocation polynomial's slope at the
    start, which is not asked of it, is from the true one, times the real eigenvalue of ``once``.
    """
    last = np.zeros(stages + 1)
    last[-2:] = -1.0, 1.0
    x = np.sort(legendre.legroots(last))
    x[-1] = 1.0
    values = legendre.legvander(x, stages)  # P_0 to P_s on -1 to 1
    integrals = np.empty((stages, stages))
    integrals[:, 0] = x + 1.0
    for k in range(1, stages):
        integrals[:, k] = (values[:, k + 1] - values[:, k - 1]) / (2 * k + 1)
    once = (0.5 * np.linalg.solve(values[:, :stages].T, integrals.T).T).astype(np.float64)
    eigenvalues = np.linalg.eigvals(once)
    gamma = float(eigenvalues[np.argmin(np.abs(eigenvalues.imag))].real)
    at_start = np.linalg.solve(values[:, :stages].T, legendre.legvander(-1.0, stages - 1)[0])
    error = np.array([gamma, *(-gamma * at_start)])
    return Collocation(np.array([0.0, *(0.5 * (x + 1.0))]), once, once @ once, error)


RADAU = radau(_STAGES)


class Memory(NamedTuple):
    """Arrays of implicit steps.

    Shapes: length (1,), of the next implicit step; pause (2,), explicit steps to make before it,
    and how many it will be when it fails;
    states (s + 1, 6) and rates (s, 3), states at the places and accelerations at the nodes;
    residual and correction (3 s,); slopes (s, 3, 6), of the accelerations by the state; matrix
    (3 s, 3 s) of Newton's iteration, factored; pivots (3 s,); filter (3, 3) and filtered (3,);
    samples (s + 1, SAMPLE_SIZE).
    """

    length: Array
    pause: Array
    states: Array
    rates: Array
    residual: Array
    correction: Array
    slopes: Array
    matrix: Array
    pivots: np.ndarray
    filter: Array
    filtered: Array
    samples: Array


def new_memory() -> Memory:
    """A ``Memory`` without steps."""
    return Memory(
        length=np.zeros(1),
        pause=np.zeros(2),
        states=np.zeros((_STAGES + 1, STATE_SIZE)),
        rates=np.zeros((_STAGES, _HALF)),
        residual=np.zeros(_UNKNOWNS),
        correction=np.zeros(_UNKNOWNS),
        slopes=np.zeros((_STAGES, _HALF, STATE_SIZE)),
        matrix=np.zeros((_UNKNOWNS, _UNKNOWNS)),
        pivots=np.zeros(_UNKNOWNS, dtype=np.int64),
        filter=np.zeros((_HALF, _HALF)),
        filtered=np.zeros(_HALF),
        samples=np.zeros((_STAGES + 1, SAMPLE_SIZE)),
    )


# --------------------------------------------------------------------------------- how fast it is


def _rate(damping, stiffness):
    """|λ| of the faster root of λ² + damping λ + stiffness = 0."""
    half, turns = 0.5 * damping, np.sqrt(stiffness)
    return np.maximum(half + np.sqrt(np.maximum(half - turns, 0.0)) * np.sqrt(half + turns), turns)


_rate_in_kernels = inlined_kernel(_rate)


def are_stiff(rows: Array) -> np.ndarray:
    """Which parameter sets are for this engine: rows of ``Constants``, shape (n, constants).

    Those with a motion on a spring of theirs, the base's above all, that is both fast and gone
    within moments: with the mass that a force at the end of the face finds, h_a / 2m is the rate at
    which a contact's motion decays.
    """
    p = Constants(*rows.T)
    stiff = np.zeros(len(rows), dtype=np.bool_)
    with np.errstate(over="ignore", invalid="ignore"):  # no limit to what a set may ask for
        per_mass = 1.0 + p.half_width**2 / p.inertia
        for damping, stiffness in (
            (p.contact_damping * per_mass, p.contact_stiffness * per_mass),
            (p.tilt_damping / p.inertia, p.tilt_stiffness / p.inertia),
            (p.lateral_damping, p.lateral_stiffness),
        ):
            stiff |= (_rate(damping, stiffness) > _FAST) & (0.5 * damping > _DAMPED)
    return stiff


@inlined_kernel
def _contact_rate(contact, p):
    """|λ| of a contact's own motion: a normal force finds the mass 1 / (n · M⁻¹ n)."""
    n = contact.normal
    per_mass = dot(n, n[0], n[1], n[2] / p.inertia)
    return _rate_in_kernels(p.contact_damping * per_mass, p.contact_stiffness * per_mass)


@kernel
def _fastest(q, p, mode):
    """The largest |λ| of the motions on the springs that act in ``mode``."""
    rate = _rate_in_kernels(p.tilt_damping / p.inertia, p.tilt_stiffness / p.inertia)
    rate = max(rate, _rate_in_kernels(p.lateral_damping, p.lateral_stiffness))
    if mode.face == CLOSED:
        rate = max(rate, _contact_rate(edge_on_face(mode.edge, q, p), p))
    if mode.corner == CLOSED:
        rate = max(rate, _contact_rate(corner_on_flat(mode.edge, q, p), p))
    if mode.side == CLOSED:
        rate = max(rate, _contact_rate(edge_on_side(q, p), p))
    return rate


# ------------------------------------------------------------------------------- linear equations


@kernel
def _factor(matrix, pivots):
    """Factor ``matrix`` in place, rows exchanged for the largest pivots; whether it is regular."""
    n = matrix.shape[0]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        pivots[k] = best
        if not abs(matrix[best, k]) > 0.0:
            return False
        if best != k:
            for j in range(n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            matrix[i, k] = factor
            for j in range(k + 1, n):
                matrix[i, j] -= factor * matrix[k, j]
    return True


@kernel
def _solve(matrix, pivots, x):
    """Solve with the factors, in place of the right-hand side ``x``."""
    n = matrix.shape[0]
    for k in range(n):
        x[k], x[pivots[k]] = x[pivots[k]], x[k]
    for k in range(n):
        for j in range(k):
            x[k] -= matrix[k, j] * x[j]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            x[k] -= matrix[k, j] * x[j]
        x[k] /= matrix[k, k]


# ----------------------------------------------------------------------------------------- a step


@kernel
def _place(h, table, memory):
    """Write the states at the nodes that follow from the accelerations there."""
    states, rates = memory.states, memory.rates
    for i in range(_STAGES):
        for n in range(_HALF):
            once, twice = 0.0, 0.0
            for j in range(_STAGES):
                once += table.once[i, j] * rates[j, n]
                twice += table.twice[i, j] * rates[j, n]
            velocity = states[0, _HALF + n]
            way = table.places[i + 1] * velocity + h * twice
            states[i + 1, n] = states[0, n] + h * way
            states[i + 1, _HALF + n] = velocity + h * once


@kernel
def _accelerations(time, y, p, mode):
    at = motion(time, state_of(y), p, mode)
    return at.x, at.y, at.tilt


@kernel
def _differentiate(time, y, p, mode, out):
    """Write the accelerations' derivatives by the state, shape (3, 6), by forward differences."""
    base = _accelerations(time, y, p, mode)
    for n in range(STATE_SIZE):
        kept = y[n]
        y[n] += _DIFFERENCE * (1.0 + abs(kept))
        moved = _accelerations(time, y, p, mode)
        for m in range(_HALF):
            out[m, n] = (moved[m] - base[m]) / (y[n] - kept)
        y[n] = kept


@kernel
def _prepare(time, h, p, mode, table, memory):
    """Factor the matrix of Newton's iteration at the states at the nodes; whether it is regular."""
    slopes, matrix = memory.slopes, memory.matrix
    for i in range(_STAGES):
        at = time + table.places[i + 1] * h
        _differentiate(at, memory.states[i + 1], p, mode, slopes[i])
        for m in range(_HALF):
            row = _HALF * i + m
            for j in range(_STAGES):
                once, twice = h * table.once[i, j], h * h * table.twice[i, j]
                for n in range(_HALF):
                    by_way, by_velocity = slopes[i, m, n], slopes[i, m, _HALF + n]
                    matrix[row, _HALF * j + n] = -(twice * by_way + once * by_velocity)
            matrix[row, row] += 1.0
    return _factor(matrix, memory.pivots)


@kernel
def _correct(time, h, p, mode, table, tolerance, memory):
    """One correction by Newton: how far it moves the states, over the tolerance."""
    rates, x = memory.rates, memory.correction
    for i in range(_STAGES):
        at = time + table.places[i + 1] * h
        found = _accelerations(at, memory.states[i + 1], p, mode)
        for n in range(_HALF):
            x[_HALF * i + n] = found[n] - rates[i, n]
    _solve(memory.matrix, memory.pivots, x)
    square = 0.0
    for i in range(_STAGES):
        for n in range(_HALF):
            rates[i, n] += x[_HALF * i + n]
            once, twice = 0.0, 0.0
            for j in range(_STAGES):
                once += table.once[i, j] * x[_HALF * j + n]
                twice += table.twice[i, j] * x[_HALF * j + n]
            way, change = h * h * twice, h * once
            square += (way / (tolerance * (1.0 + abs(memory.states[0, n])))) ** 2
            square += (change / (tolerance * (1.0 + abs(memory.states[0, _HALF + n])))) ** 2
    _place(h, table, memory)
    return sqrt(square / (2 * _UNKNOWNS))


@kernel
def _collocate(time, h, p, mode, table, tolerance, memory):
    """Solve for the step from ``memory.states[0]``: (whether it is solved, evaluations)."""
    start = _accelerations(time, memory.states[0], p, mode)
    for i in range(_STAGES):
        for n in range(_HALF):
            memory.rates[i, n] = start[n]
    _place(h, table, memory)
    evaluations = 1
    last, fresh = 0.0, False
    enough = max(_ENOUGH, _ROUNDING / tolerance)
    for iteration in range(_MOST_ITERATIONS):
        if iteration == 0 or (not fresh and last > 0.0):
            if not _prepare(time, h, p, mode, table, memory):
                return False, evaluations
            evaluations += _STAGES * (STATE_SIZE + 1)
        change = _correct(time, h, p, mode, table, tolerance, memory)
        evaluations += _STAGES
        if not isfinite(change):
            return False, evaluations
        if change <= enough:
            return True, evaluations
        fresh = iteration == 0 or change <= _SLOW * last
        last = change
    return False, evaluations


@kernel
def _error(time, h, p, mode, table, tolerance, memory):
    """The step's error over the tolerance, as in step.py; what is fast counts as it is damped."""
    gamma, weights, states = table.error[0], table.error, memory.states
    start = _accelerations(time, states[0], p, mode)
    ways, x = memory.residual, memory.filtered
    for n in range(_HALF):
        way, change = gamma * states[0, _HALF + n], gamma * start[n]
        for i in range(_STAGES):
            way += weights[i + 1] * states[i + 1, _HALF + n]
            change += weights[i + 1] * memory.rates[i, n]
        ways[n], x[n] = h * way, h * change
    slopes, matrix, short = memory.slopes[0], memory.filter, h * gamma
    for m in range(_HALF):
        for n in range(_HALF):
            by_way, by_velocity = slopes[m, n], slopes[m, _HALF + n]
            x[m] += short * by_way * ways[n]
            matrix[m, n] = -(short * short * by_way + short * by_velocity)
        matrix[m, m] += 1.0
    if not _factor(matrix, memory.pivots):
        return 1e300
    _solve(matrix, memory.pivots, x)
    square = 0.0
    for n in range(_HALF):
        way = ways[n] + short * x[n]
        place = max(abs(states[0, n]), abs(states[_STAGES, n]))
        velocity = max(abs(states[0, _HALF + n]), abs(states[_STAGES, _HALF + n]))
        square += (way / (tolerance * (1.0 + place))) ** 2
        square += (x[n] / (tolerance * (1.0 + velocity))) ** 2
    return sqrt(square / STATE_SIZE)


# -------------------------------------------------------------------------- what it may step over


@inlined_kernel
def _may_fall(t0, t1, t2, f0, f1, f2):
    """Whether a function with these samples may have a minimum below zero among them."""
    d1, d2 = t1 - t0, t2 - t1
    rise, further = (f1 - f0) / d1, (f2 - f1) / d2
    bend = (further - rise) / (d1 + d2)  # half the parabola's second derivative
    if bend <= 0.0:
        return False
    slope = rise + bend * d1  # in the middle
    move = -0.5 * slope / bend
    return -d1 < move < d2 and f1 + 0.5 * slope * move <= 0.5 * min(f0, min(f1, f2))


@kernel
def _clear_until(places, samples):
    """How far into the step, as a fraction, its samples show that no switching function falls."""
    until = 1.0
    for which in range(SWITCH_COUNT):
        if samples[0, which] == NEVER:
            continue
        for i in range(1, _STAGES + 1):
            if places[i - 1] >= until:
                break
            before, here = samples[i - 1, which], samples[i, which]
            if not here >= 0.0:
                step = places[i] - places[i - 1]
                until = min(until, places[i - 1] + step * before / (before - here))
                break
            turns = False
            if which < COMBINED_COUNT:
                place = SWITCH_COUNT + which
                turns = samples[i, place] != samples[i - 1, place]
                if turns:  # there it is lowest, down the steeper slope of the samples around
                    steepest = 0.0
                    for k in range(max(i - 1, 1), min(i + 2, _STAGES + 1)):
                        rise = samples[k, which] - samples[k - 1, which]
                        steepest = max(steepest, abs(rise) / (places[k] - places[k - 1]))
                    fall = 1.5 * steepest * (places[i] - places[i - 1])
                    turns = min(before, here) <= fall
            if i < _STAGES:
                turns = turns or _may_fall(
                    places[i - 1], places[i], places[i + 1],
                    before, here, samples[i + 1, which],
                )  # fmt: skip
            if turns:
                until = min(until, places[i - 1])
                break
    return until


# ------------------------------------------------------------------------------------------ a run


@kernel
def _implicit_length(time, longest, p, mode, table, tolerance, max_evaluations, memory, runs, i):
    """Length of an implicit step from ``memory.states[0]``, solved and clear of switches, or 0.

    ``memory.length`` becomes what the error estimate proposes for the next one.
    """
    h = longest
    while h > _WORTH * runs[i, NEXT_STEP] and runs[i, EVALUATIONS] <= max_evaluations:
        solved, evaluations = _collocate(time, h, p, mode, table, tolerance, memory)
        runs[i, EVALUATIONS] += evaluations
        shrinking = 0.25
        if solved:
            error = _error(time, h, p, mode, table, tolerance, memory)
            runs[i, EVALUATIONS] += 1
            growth = CAUTION * max(error, 1e-12) ** (-1.0 / (_STAGES + 1.0))
            if error <= 1.0:
                memory.length[0] = h * min(growth, MOST_GROWTH)
                for node in range(1, _STAGES + 1):
                    at, q = time + table.places[node] * h, state_of(memory.states[node])
                    switching_functions(at, q, p, mode, memory.samples[node])
                until = _clear_until(table.places, memory.samples)
                if until == 1.0:
                    return h
                shrinking = _BEFORE * until
            else:
                shrinking = max(LEAST_SHRINKING, growth)
        runs[i, REJECTED] += 1
        h *= shrinking
    return 0.0


@kernel
def _advance_implicitly(table, control, track, history, memory, runs, i):
    """Advance run ``i`` by one implicit step: whether there is one."""
    time, p, mode = runs[i, TIME], constants_of(runs, i), mode_of(runs, i)
    states, samples = memory.states, memory.samples
    keep_in(state_in(runs, STATE, i), states[0])
    switching_functions(time, state_of(states[0]), p, mode, samples[0])
    left = runs[i, STOP] - time
    longest = max(memory.length[0], _FIRST * runs[i, NEXT_STEP])
    cut = longest >= left
    h = _implicit_length(
        time, left if cut else longest, p, mode, table, runs[i, TOLERANCE],
        control.max_evaluations, memory, runs, i,
    )  # fmt: skip
    if h == 0.0:
        memory.length[0] = 0.0
        memory.pause[0] = memory.pause[1]
        memory.pause[1] = min(2.0 * memory.pause[1], _PAUSES[1])
        return False
    memory.pause[1] = _PAUSES[0]
    at_stop = cut and h == left
    if at_stop:  # a step cut short says nothing against the length it was cut from
        memory.length[0] = max(memory.length[0], longest)
    tilt, force = 0.0, 0.0
    for node in range(_STAGES + 1):
        tilt = max(tilt, abs(states[node, 2]))
        force = max(force, max(support_force(samples[node]), side_force(samples[node])))
    note_step(h, tilt, force, runs, i)
    note_closest(samples, _STAGES, runs, i)
    for node in range(1, _STAGES + 1):
        at, q = time + table.places[node] * h, state_of(states[node])
        track_sample(track, at, q, samples[node], runs, i)
    keep_state(hold_sticking(state_of(states[_STAGES]), p, mode), runs, i)
    runs[i, TIME] = runs[i, STOP] if at_stop else time + h
    end_step(at_stop, history, control, runs, i)
    return True


@kernel
def advance_stiff(declared, method, table, control, track, history, work, memory, runs, i):
    """Advance run ``i`` by one step, implicit where stability would limit an explicit one."""
    p, mode = constants_of(runs, i), mode_of(runs, i)
    rate = _fastest(state_in(runs, STATE, i), p, mode)
    if rate * runs[i, NEXT_STEP] <= _LIMITED or memory.pause[0] > 0.0:
        memory.pause[0] = max(memory.pause[0] - 1.0, 0.0)
    elif _advance_implicitly(table, control, track, history, memory, runs, i):
        return
    advance(declared, method, control, track, history, work, runs, i)


@kernel
def integrate_stiff(
    rows, tolerances, declared, method, table, control, track, queue, endings, single, memory
):
    """As ``integrate_each``, for parameter sets that ``are_stiff``; ``table`` is RADAU."""
    runs, history, work = single.runs, single.history, single.work
    i = runs.shape[0] - 1
    row = next_in(queue)
    while row < rows.shape[0]:
        begin(rows[row], tolerances[row], declared, control, runs, i)
        memory.length[0], memory.pause[0], memory.pause[1] = 0.0, 0.0, _PAUSES[0]
        track_run(track, work.scratch, runs, i)
        while runs[i, OUTCOME] == CONTINUES:
            advance_stiff(declared, method, table, control, track, history, work, memory, runs, i)
        keep_ending(ending_of(runs, i), endings, row)
        row = next_in(queue)
