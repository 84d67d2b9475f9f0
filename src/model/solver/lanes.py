"""WIDTH runs in the same kind of mode, side by side: one step of a power series, and what it shows.

The loops over lanes are plain arithmetic on one flat array, so that a compiler carries eight or
more runs in one vector register; the series themselves are written for vectors (series_code.py).
A row of ``w`` holds one number of every lane: row r of lane i stands at ``w[r * WIDTH + i]``.

Between two of its samples a function g of the step's fraction θ stays above the line through them
less its bend, an eighth of their distance squared times the largest |g''|, of which the series'
coefficients tell a bound. What is above zero by this bound has not switched.

Lanes hold the modes in which the part stands on A1 or flies, alone or with A2 on its side face;
other modes, and readings of the printed equations, are left to the reference engine.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from model.physics.compiled import inlined_kernel, kernel
from model.physics.motion import never_sticks
from model.physics.notation import RIGHT_EDGE, State
from model.physics.parameters import Constants
from model.physics.scenes import CLOSED, OPEN, STICKING, Mode
from model.physics.trigonometry import sine_cosine
from model.solver.record import STATE_SIZE
from model.solver.series import GIVEN, Contacts
from model.solver.series_code import (
    FRACTIONS,
    NODES,
    ORDER,
    ROWS,
    SINES,
    WIDTH,
    fill_series,
    follow_series,
)
from model.solver.switching import (
    ALIGNED,
    CORNERS_INSIDE,
    FACE_END,
    FACE_FAR_END,
    FACE_GAP,
    FACE_LOAD,
    FACE_RELOAD,
    FLAT,
    LARGEST_TILT,
    LEFT_CORNER_LANDS,
    LEFT_EDGE_ENTERS,
    LEFT_WALL,
    NEVER,
    ON_A_SWITCH,
    OVERTURNED,
    RIGHT_CORNER_LANDS,
    RIGHT_EDGE_ENTERS,
    RIGHT_WALL,
    SIDE_END,
    SIDE_GAP,
    SIDE_LOAD,
    SIDE_RELOAD,
    SIDE_SLIP,
    SUPPORT_SLIP,
    SWITCH_COUNT,
    Outline,
    applies_in,
    face_switches,
    friction_margin,
    largest,
    quantities_at,
    side_switches,
)
from model.solver.tableaux import Array
from model.solver.transitions import hold_sticking

# Rows: the constants and signs of the slips, numbers of the lanes, and what a step shows.
(
    TIME,
    DEADLINE,
    TOLERANCE,
    LONGEST,  # step
    FACE,
    SUPPORT_SLIP_STATE,
    SIDE,
    SIDE_SLIP_STATE,
    DROPPED,
    LENGTH,
    SHOWN,  # above 0 where a switch may be in the step
    STEP_TILT,  # what |tilt| stays below in the step
    STEP_FORCE,  # the same of the normal forces
    OUTLINE_BEND,  # over a quarter of the step, the largest of what combined functions are made of,
    FACE_BEND,  # of the load under the edge, its friction, the load at the side, its friction
    SUPPORT_BEND,
    SIDE_BEND,
    SIDE_FRICTION_BEND,
) = range(GIVEN, GIVEN + 18)
END = SIDE_FRICTION_BEND + 1
SAMPLES = END + STATE_SIZE  # switching functions at each node
LOWEST = SAMPLES + NODES * SWITCH_COUNT  # the lowest of them in the step
MAY_SWITCH = LOWEST + SWITCH_COUNT  # quarters in which each may fall through zero, as bits
VALUES = MAY_SWITCH + SWITCH_COUNT  # the states and what is watched at each node, and their bends
COEFFICIENTS = VALUES + (NODES + 1) * SINES
LANE_ROWS = COEFFICIENTS + (ORDER + 1) * ROWS

TILT, OUTLINE_AT, CONTACTS_AT = 2, STATE_SIZE, STATE_SIZE + len(Outline._fields)  # in a row
ALL_QUARTERS = 15
LAST_TERMS = 4.0  # of a series, over the tolerance: what follows them is smaller
_CACHE_LINE = 64  # bytes
TOO_FLAT_TO_TELL = 10.0 * FLAT
# The largest distance from a line through samples at a step's quarters, over the bound of |g''|.
_BEND = FRACTIONS[0] ** 2 / 8.0
_NO_CORNER = range(SIDE_END + 1, SUPPORT_SLIP)  # functions of the other modes
WATCHED_SWITCHES = np.array([each for each in range(SWITCH_COUNT) if each not in _NO_CORNER])


def new_lanes() -> Array:
    """The array ``w``. It begins on a cache line, as then every row does."""
    count, line = LANE_ROWS * WIDTH, _CACHE_LINE // 8
    numbers = np.zeros(count + line)
    first = -numbers.ctypes.data % _CACHE_LINE // 8
    return numbers[first : first + count]


@inlined_kernel
def constants_of_lane(w, i):
    """``Constants`` of lane ``i``, consistent readings."""
    n = WIDTH
    return Constants(
        w[i], w[n + i], w[2 * n + i], w[3 * n + i], w[4 * n + i], w[5 * n + i], w[6 * n + i],
        w[7 * n + i], w[8 * n + i], w[9 * n + i], w[10 * n + i], w[11 * n + i], w[12 * n + i],
        w[13 * n + i], w[14 * n + i], w[15 * n + i], w[16 * n + i], w[17 * n + i], w[18 * n + i],
        w[19 * n + i], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip


@inlined_kernel
def mode_of_lane(w, i):
    """``Mode`` of lane ``i``, of those that lanes hold."""
    return Mode(
        RIGHT_EDGE,
        int(w[FACE * WIDTH + i]),
        OPEN,
        0.0,
        False,
        int(w[SUPPORT_SLIP_STATE * WIDTH + i]),
        int(w[SIDE * WIDTH + i]),
        int(w[SIDE_SLIP_STATE * WIDTH + i]),
        w[DROPPED * WIDTH + i] != 0.0,
    )


@inlined_kernel
def lanes_hold(mode):
    """Whether lanes can carry this mode."""
    return mode.edge == RIGHT_EDGE and mode.corner == OPEN


@inlined_kernel
def _state(w, row, i):
    n = WIDTH
    return State(
        w[row * n + i], w[(row + 1) * n + i], w[(row + 2) * n + i],
        w[(row + 3) * n + i], w[(row + 4) * n + i], w[(row + 5) * n + i],
    )  # fmt: skip


@inlined_kernel
def outline_in(row, scale, w, i):
    """``Outline`` of lane ``i`` that stands from ``row`` on, times ``scale``."""
    at, n = (row + OUTLINE_AT) * WIDTH + i, WIDTH
    return Outline(
        scale * w[at], scale * w[at + n], scale * w[at + 2 * n], scale * w[at + 3 * n],
        scale * w[at + 4 * n], scale * w[at + 5 * n], scale * w[at + 6 * n],
        scale * w[at + 7 * n], scale * w[at + 8 * n],
    )  # fmt: skip


@inlined_kernel
def contacts_in(row, scale, w, i):
    """``Contacts`` of lane ``i`` that stand from ``row`` on, times ``scale``."""
    at, n = (row + CONTACTS_AT) * WIDTH + i, WIDTH
    return Contacts(scale * w[at], scale * w[at + n], scale * w[at + 2 * n], scale * w[at + 3 * n])


@kernel
def _turn(w):
    """Sine and cosine of the tilt and of the excitation's angle, at the start of the step."""
    first = COEFFICIENTS + SINES
    for i in range(WIDTH):
        p = constants_of_lane(w, i)
        s, c = sine_cosine(w[(COEFFICIENTS + TILT) * WIDTH + i])
        w[first * WIDTH + i], w[(first + 1) * WIDTH + i] = s, c
        s, c = sine_cosine(p.frequency * w[TIME * WIDTH + i] + p.phase)
        w[(first + 2) * WIDTH + i], w[(first + 3) * WIDTH + i] = s, c


@inlined_kernel
def _sixteenth_root(value):
    return sqrt(sqrt(sqrt(sqrt(value))))


@inlined_kernel
def _last_terms(w, i):
    """The coefficients of the last two orders over 1 + |value|: the largest of states and outline.

    In flight the states' series end sooner than those of the places, which turn with the tilt.
    """
    last, before = 1e-200, 1e-200
    for n in range(CONTACTS_AT):
        over = 1.0 / (1.0 + abs(w[(COEFFICIENTS + n) * WIDTH + i]))
        last = max(last, over * abs(w[(COEFFICIENTS + ORDER * ROWS + n) * WIDTH + i]))
        before = max(before, over * abs(w[(COEFFICIENTS + (ORDER - 1) * ROWS + n) * WIDTH + i]))
    return last, before


@kernel
def _set_lengths(w):
    """The steps at which the larger of the series' last two terms comes to what is admitted."""
    for i in range(WIDTH):
        longest = w[LONGEST * WIDTH + i]
        admitted = LAST_TERMS * w[TOLERANCE * WIDTH + i]
        last, before = _last_terms(w, i)
        # Its root of one order less: 1/15 = 1/16 + 1/16² + ...
        root = _sixteenth_root(admitted / before)
        step = min(_sixteenth_root(admitted / last), root * _sixteenth_root(root))
        step = min(step, longest)
        time, deadline = w[TIME * WIDTH + i], w[DEADLINE * WIDTH + i]
        w[LENGTH * WIDTH + i] = deadline - time if time + 1.0001 * step >= deadline else step


@inlined_kernel
def _bend(row, w, i):
    return _BEND * w[(VALUES + NODES * SINES + row) * WIDTH + i]


@kernel
def _note_bends(w):
    for i in range(WIDTH):
        bend = _bend(TILT, w, i)
        for row in range(OUTLINE_AT, CONTACTS_AT):
            bend = max(bend, _bend(row, w, i))
        w[OUTLINE_BEND * WIDTH + i] = bend
        mode, friction = mode_of_lane(w, i), constants_of_lane(w, i).friction
        face, side = _bend(CONTACTS_AT, w, i), _bend(CONTACTS_AT + 2, w, i)
        support_slip, side_slip = _bend(CONTACTS_AT + 1, w, i), _bend(CONTACTS_AT + 3, w, i)
        support_limit = friction * face if mode.support_slip == STICKING else 0.0
        side_limit = friction * side if mode.side_slip == STICKING else 0.0
        w[FACE_BEND * WIDTH + i], w[SIDE_BEND * WIDTH + i] = face, side
        w[SUPPORT_BEND * WIDTH + i] = support_slip + support_limit
        w[SIDE_FRICTION_BEND * WIDTH + i] = side_slip + side_limit


@inlined_kernel
def bend_row(which):
    """Where the bend of a function stands."""
    if which == FACE_LOAD or which == FACE_RELOAD:
        return FACE_BEND
    if which == SIDE_LOAD or which == SIDE_RELOAD:
        return SIDE_BEND
    if which == SUPPORT_SLIP:
        return SUPPORT_BEND
    return SIDE_FRICTION_BEND if which == SIDE_SLIP else OUTLINE_BEND


class Sizes(NamedTuple):
    """Absolute values of what switching functions ask the size of."""

    along_side: float
    support_friction: float
    side_friction: float
    tilt: float


@inlined_kernel
def single_functions(at, contacts, sizes, p, mode):
    """The switching functions that are one quantity, in their order; see switching.py.

    Each is a constant plus multiples of what it is made of.
    """
    face = face_switches(
        p.half_height + at.right_along_axis, contacts.face_load, at.right_along_face, p, mode
    )
    side = side_switches(at.left_behind_side, contacts.side_load, sizes.along_side, p, mode)
    slip = friction_margin(
        mode.support_slip == STICKING, mode.support_slip,
        contacts.support_friction, sizes.support_friction, contacts.face_load, p,
    )  # fmt: skip
    side_slip = friction_margin(
        mode.side_slip == STICKING, mode.side_slip,
        contacts.side_friction, sizes.side_friction, contacts.side_load, p,
    )  # fmt: skip
    no_face, no_side = mode.face == OPEN, mode.side == OPEN
    rubs = not never_sticks(p)
    return (
        NEVER if no_face else face[0], NEVER if no_face else face[1],
        NEVER if no_face else face[2], NEVER if no_face else face[3],
        NEVER if no_face else face[4],
        NEVER if no_side else side[0], NEVER if no_side else side[1],
        NEVER if no_side else side[2], NEVER if no_side else side[3],
        slip if mode.face == CLOSED and rubs else NEVER,
        side_slip if mode.side == CLOSED and rubs else NEVER,
        LARGEST_TILT - sizes.tilt,
    )  # fmt: skip


@inlined_kernel
def _sample_single(node, w):
    n, at, row = WIDTH, (SAMPLES + node * SWITCH_COUNT) * WIDTH, VALUES + node * SINES
    for i in range(WIDTH):
        p, mode = constants_of_lane(w, i), mode_of_lane(w, i)
        places, contacts = outline_in(row, 1.0, w, i), contacts_in(row, 1.0, w, i)
        sizes = Sizes(
            abs(places.left_along_axis), abs(contacts.support_friction),
            abs(contacts.side_friction), abs(w[(row + TILT) * n + i]),
        )  # fmt: skip
        g = single_functions(places, contacts, sizes, p, mode)
        w[at + FACE_LOAD * n + i], w[at + FACE_GAP * n + i] = g[0], g[1]
        w[at + FACE_RELOAD * n + i], w[at + FACE_END * n + i] = g[2], g[3]
        w[at + FACE_FAR_END * n + i], w[at + SIDE_LOAD * n + i] = g[4], g[5]
        w[at + SIDE_GAP * n + i], w[at + SIDE_RELOAD * n + i] = g[6], g[7]
        w[at + SIDE_END * n + i], w[at + SUPPORT_SLIP * n + i] = g[8], g[9]
        w[at + SIDE_SLIP * n + i], w[at + OVERTURNED * n + i] = g[10], g[11]


@kernel
def _sample(w):
    # Each by its own constant: offsets that vary keep the loop over lanes scalar.
    _sample_single(0, w)
    _sample_single(1, w)
    _sample_single(2, w)
    _sample_single(3, w)
    _sample_single(4, w)


@inlined_kernel
def stays_above(left, right, bend):
    """Whether a function that bends by no more than ``bend`` stays above zero between two places.

    Also where it is zero at one of them and leaves it.
    """
    rise = right - left
    return (
        (min(left, right) > bend)
        | ((left >= -ON_A_SWITCH) & (rise > 4.0 * bend))
        | ((right > 0.0) & (rise < -4.0 * bend))
    )


@inlined_kernel
def _quarters(first, second, third, fourth):
    """The quarters of the step in which a function does not stay above zero, as bits."""
    early = (0.0 if first else 1.0) + (0.0 if second else 2.0)
    return early + (0.0 if third else 4.0) + (0.0 if fourth else 8.0)


@inlined_kernel
def _screen_single(which, w):
    """Enter a function's lowest sample, and where it may fall through zero."""
    n = WIDTH
    row = bend_row(which)
    first = (SAMPLES + which) * n
    for i in range(WIDTH):
        bend = w[row * n + i]
        g0, g1 = w[first + i], w[first + SWITCH_COUNT * n + i]
        g2, g3 = w[first + 2 * SWITCH_COUNT * n + i], w[first + 3 * SWITCH_COUNT * n + i]
        g4 = w[first + 4 * SWITCH_COUNT * n + i]
        flagged = _quarters(
            stays_above(g0, g1, bend), stays_above(g1, g2, bend),
            stays_above(g2, g3, bend), stays_above(g3, g4, bend),
        )  # fmt: skip
        flagged = 0.0 if g0 == NEVER else flagged
        lowest = min(min(g1, g2), min(g3, g4))
        w[(LOWEST + which) * n + i] = lowest if g0 > ON_A_SWITCH else NEVER
        w[(MAY_SWITCH + which) * n + i] = flagged
        w[SHOWN * n + i] = max(w[SHOWN * n + i], flagged)


@inlined_kernel
def is_corner(which):
    """Whether a function is watched without its closing rate, and so does not tell by itself."""
    return which == RIGHT_CORNER_LANDS or which == LEFT_CORNER_LANDS


@inlined_kernel
def one_stays_above(left, right, bend):
    """Whether one of four quantities ``stays_above``, and with it the largest of them."""
    return (
        stays_above(left[0], right[0], bend)
        | stays_above(left[1], right[1], bend)
        | stays_above(left[2], right[2], bend)
        | stays_above(left[3], right[3], bend)
    )


@inlined_kernel
def _quantities(which, w, node, i):
    row = VALUES + node * SINES
    tilt = w[(row + TILT) * WIDTH + i]
    return quantities_at(which, outline_in(row, 1.0, w, i), tilt, constants_of_lane(w, i))


@inlined_kernel
def _screen_combined(which, w):
    """The same of the largest of several quantities, which is sampled here."""
    n = WIDTH
    first = (SAMPLES + which) * n
    for i in range(WIDTH):
        applies = applies_in(mode_of_lane(w, i))[which]
        bend = w[OUTLINE_BEND * n + i]
        q0, q1 = _quantities(which, w, 0, i), _quantities(which, w, 1, i)
        q2, q3 = _quantities(which, w, 2, i), _quantities(which, w, 3, i)
        q4 = _quantities(which, w, 4, i)
        g0, g1, g2 = largest(q0)[0], largest(q1)[0], largest(q2)[0]
        g3, g4 = largest(q3)[0], largest(q4)[0]
        flagged = _quarters(
            one_stays_above(q0, q1, bend), one_stays_above(q1, q2, bend),
            one_stays_above(q2, q3, bend), one_stays_above(q3, q4, bend),
        )  # fmt: skip
        w[first + i] = g0 if applies else NEVER
        w[first + SWITCH_COUNT * n + i] = g1
        w[first + 2 * SWITCH_COUNT * n + i] = g2
        w[first + 3 * SWITCH_COUNT * n + i] = g3
        w[first + 4 * SWITCH_COUNT * n + i] = g4
        lowest = min(min(g1, g2), min(g3, g4))
        w[(LOWEST + which) * n + i] = lowest if (g0 > ON_A_SWITCH) & applies else NEVER
        # Near flat, what is on its switch to rounding may be beyond it.
        flat = is_corner(which) & (min(g0, lowest) < TOO_FLAT_TO_TELL)
        flagged = float(ALL_QUARTERS) if flat else flagged
        flagged = flagged if applies else 0.0
        w[(MAY_SWITCH + which) * n + i] = flagged
        w[SHOWN * n + i] = max(w[SHOWN * n + i], flagged)


@kernel
def _leave_out(which, w):
    """Enter that a function applies in no lane."""
    for i in range(WIDTH):
        w[(SAMPLES + which) * WIDTH + i], w[(LOWEST + which) * WIDTH + i] = NEVER, NEVER
        w[(MAY_SWITCH + which) * WIDTH + i] = 0.0


@kernel
def _screen_side(w):
    _screen_single(SIDE_LOAD, w)
    _screen_single(SIDE_GAP, w)
    _screen_single(SIDE_RELOAD, w)
    _screen_single(SIDE_END, w)
    _screen_single(SIDE_SLIP, w)


@kernel
def _screen_face(w):
    _screen_single(FACE_LOAD, w)
    _screen_single(FACE_GAP, w)
    _screen_single(FACE_RELOAD, w)
    _screen_single(FACE_END, w)
    _screen_single(FACE_FAR_END, w)
    _screen_single(SUPPORT_SLIP, w)
    _screen_single(OVERTURNED, w)


@kernel
def _screen(flies, beside, w):
    """Screen every function that may apply."""
    for i in range(WIDTH):
        w[SHOWN * WIDTH + i] = 0.0
    if beside:
        _screen_side(w)
    else:
        for which in (SIDE_LOAD, SIDE_GAP, SIDE_RELOAD, SIDE_END, SIDE_SLIP):
            _leave_out(which, w)
    _screen_face(w)
    if flies:
        _screen_combined(ALIGNED, w)
        _screen_combined(CORNERS_INSIDE, w)
        _screen_combined(RIGHT_EDGE_ENTERS, w)
        _screen_combined(RIGHT_WALL, w)
    else:
        for which in (ALIGNED, CORNERS_INSIDE, RIGHT_EDGE_ENTERS, RIGHT_WALL):
            _leave_out(which, w)
    _screen_combined(LEFT_EDGE_ENTERS, w)
    _screen_combined(RIGHT_CORNER_LANDS, w)
    _screen_combined(LEFT_CORNER_LANDS, w)
    _screen_combined(LEFT_WALL, w)


@inlined_kernel
def _at_most(row, w, i):
    """What |row| stays below in the step, by its samples and its bend."""
    first, node = (VALUES + row) * WIDTH + i, SINES * WIDTH
    ends, inner = max(abs(w[first]), abs(w[first + 4 * node])), abs(w[first + 2 * node])
    inner = max(inner, max(abs(w[first + node]), abs(w[first + 3 * node])))
    return max(ends, inner) + _bend(row, w, i)


@kernel
def _note_largest(w):
    """What |tilt| and normal forces stay below in the step."""
    for i in range(WIDTH):
        w[STEP_TILT * WIDTH + i] = _at_most(TILT, w, i)
        face = _at_most(CONTACTS_AT, w, i) if w[FACE * WIDTH + i] == CLOSED else 0.0
        side = _at_most(CONTACTS_AT + 2, w, i) if w[SIDE * WIDTH + i] == CLOSED else 0.0
        w[STEP_FORCE * WIDTH + i] = max(face, side)


@kernel
def _end_steps(w):
    """The state at the end of every step, with what sticks at rest."""
    for i in range(WIDTH):
        end = _state(w, VALUES + (NODES - 1) * SINES, i)
        end = hold_sticking(end, constants_of_lane(w, i), mode_of_lane(w, i))
        n = WIDTH
        w[END * n + i], w[(END + 1) * n + i], w[(END + 2) * n + i] = end.x, end.y, end.tilt
        w[(END + 3) * n + i], w[(END + 4) * n + i] = end.x_rate, end.y_rate
        w[(END + 5) * n + i] = end.tilt_rate


@kernel
def step_all(kind, flies, beside, w):
    """Make one step in every lane, and say in SHOWN where a switch may be in it.

    ``flies`` and ``beside``: whether in any lane the edge is not under the face, and whether A2 is
    behind the side.
    """
    _turn(w)
    fill_series(kind, w, COEFFICIENTS, 0)
    _set_lengths(w)
    follow_series(w, COEFFICIENTS, LENGTH, VALUES)
    _note_bends(w)
    _sample(w)
    _screen(flies, beside, w)
    _note_largest(w)
    _end_steps(w)
