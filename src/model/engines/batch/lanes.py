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

from math import floor
from typing import NamedTuple

import numpy as np

from model.engines.batch.series import CONSISTENT, GIVEN, Contacts
from model.engines.batch.series_code import (
    FRACTIONS,
    NODES,
    ORDER,
    ROWS,
    SINES,
    TILT,
    WIDTH,
    fill_series,
    follow_series,
)
from model.engines.scalar.tableaux import Array
from model.events.table import (
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
from model.events.transitions import hold_sticking
from model.physics.compiled import inlined_kernel, kernel
from model.physics.motion import never_sticks
from model.physics.notation import RIGHT_EDGE, STATE_SIZE, State
from model.physics.parameters import Constants
from model.physics.scenes import CLOSED, OPEN, STICKING, Mode
from model.physics.trigonometry import sine_cosine
from model.physics.views import reader

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
    SHOWN,  # switching functions that may fall through zero in the step, as bits
    STEP_TILT,  # what |tilt| stays below in the step
    STEP_FORCE,  # the same of the normal forces
) = range(GIVEN, GIVEN + 13)
END = STEP_FORCE + 1
SAMPLES = END + STATE_SIZE  # switching functions at each node
BENDS = SAMPLES + NODES * SWITCH_COUNT  # of those that are one quantity
LOWEST = BENDS + SWITCH_COUNT  # the functions' lowest samples, up to the end of each quarter
MAY_SWITCH = LOWEST + (NODES - 1) * SWITCH_COUNT  # where each may fall through zero, as bits
VALUES = MAY_SWITCH + SWITCH_COUNT  # the tilt and what is watched at each node, and their bends
COEFFICIENTS = VALUES + (NODES + 1) * SINES
LANE_ROWS = COEFFICIENTS + (ORDER + 1) * ROWS

OUTLINE_AT, CONTACTS_AT = STATE_SIZE, STATE_SIZE + len(Outline._fields)  # in a row
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


# (w, i): ``Constants`` of lane ``i``, consistent readings.
_PLACES = {row: place for place, row in enumerate(CONSISTENT)}
constants_of_lane = reader(
    Constants,
    "w, i",
    lambda n: f"w[{_PLACES[n]} * WIDTH + i]" if n in _PLACES else "0.0",
    WIDTH=WIDTH,
)


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


# (w, row, i): the ``State`` of lane ``i`` that stands from ``row`` on.
_state = reader(State, "w, row, i", "w[(row + {}) * WIDTH + i]".format, WIDTH=WIDTH)
# (row, scale, w, i): ``Outline`` and ``Contacts`` of lane ``i`` from ``row`` on, times ``scale``.
_scaled = "scale * w[(row + FIRST + {}) * WIDTH + i]".format
outline_in = reader(Outline, "row, scale, w, i", _scaled, FIRST=OUTLINE_AT, WIDTH=WIDTH)
contacts_in = reader(Contacts, "row, scale, w, i", _scaled, FIRST=CONTACTS_AT, WIDTH=WIDTH)


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
def _root(value, order):
    """The root of this order of a positive number, to half a percent.

    The bits of a number, its exponent before its mantissa, are nearly its logarithm.
    """
    logarithm = np.float64(value).view(np.int64) * 2.0**-52 - 1023.0
    power = logarithm * (1.0 / order)
    whole = floor(power)
    part = power - whole
    octave = np.int64((np.int64(whole) + 1023) << 52).view(np.float64)
    return octave * (1.0 + part * (0.6565 + 0.3435 * part))


@inlined_kernel
def _step_of(order, admitted, w, i):
    """The step at which the terms of an order, over 1 + |value|, come to what is admitted.

    Those of states and outline: in flight the states' series end sooner than those of the places,
    which turn with the tilt. Ratios are compared by products, which take less than divisions.
    """
    largest_size, its_scale = 1e-200, 1.0
    for n in range(CONTACTS_AT):
        size = abs(w[(COEFFICIENTS + order * ROWS + n) * WIDTH + i])
        scale = 1.0 + abs(w[(COEFFICIENTS + n) * WIDTH + i])
        is_larger = size * its_scale > largest_size * scale
        largest_size = size if is_larger else largest_size
        its_scale = scale if is_larger else its_scale
    return _root(admitted * its_scale / largest_size, order)


@kernel
def _set_lengths(w):
    """The steps at which the larger of the series' last two terms comes to what is admitted."""
    for i in range(WIDTH):
        admitted = LAST_TERMS * w[TOLERANCE * WIDTH + i]
        step = min(_step_of(ORDER, admitted, w, i), _step_of(ORDER - 1, admitted, w, i))
        step = min(step, w[LONGEST * WIDTH + i])
        time, deadline = w[TIME * WIDTH + i], w[DEADLINE * WIDTH + i]
        w[LENGTH * WIDTH + i] = deadline - time if time + 1.0001 * step >= deadline else step


@inlined_kernel
def bend_of(row, w, i):
    """How far a row may be from the line through two of its samples."""
    return _BEND * w[(VALUES + NODES * SINES + row) * WIDTH + i]


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


# What makes a function its constant.
NOWHERE = Outline(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
UNLOADED = Contacts(0.0, 0.0, 0.0, 0.0)
_SMALL = Sizes(0.0, 0.0, 0.0, 0.0)


@inlined_kernel
def _enter_single(first, g, w, i):
    """Enter one number for each of the ``single_functions``, from row ``first`` on."""
    at, n = first * WIDTH + i, WIDTH
    w[at + FACE_LOAD * n], w[at + FACE_GAP * n], w[at + FACE_RELOAD * n] = g[0], g[1], g[2]
    w[at + FACE_END * n], w[at + FACE_FAR_END * n], w[at + SIDE_LOAD * n] = g[3], g[4], g[5]
    w[at + SIDE_GAP * n], w[at + SIDE_RELOAD * n], w[at + SIDE_END * n] = g[6], g[7], g[8]
    w[at + SUPPORT_SLIP * n], w[at + SIDE_SLIP * n] = g[9], g[10]
    w[at + OVERTURNED * n] = g[11]


@inlined_kernel
def _sample_single(node, w):
    row = VALUES + node * SINES
    for i in range(WIDTH):
        places, contacts = outline_in(row, 1.0, w, i), contacts_in(row, 1.0, w, i)
        sizes = Sizes(
            abs(places.left_along_axis), abs(contacts.support_friction),
            abs(contacts.side_friction), abs(w[(row + TILT) * WIDTH + i]),
        )  # fmt: skip
        g = single_functions(places, contacts, sizes, constants_of_lane(w, i), mode_of_lane(w, i))
        _enter_single(SAMPLES + node * SWITCH_COUNT, g, w, i)


@kernel
def _note_bends(w):
    """Enter how far the single functions may be from lines through their samples."""
    row = VALUES + NODES * SINES
    for i in range(WIDTH):
        p, mode = constants_of_lane(w, i), mode_of_lane(w, i)
        places, contacts = outline_in(row, _BEND, w, i), contacts_in(row, _BEND, w, i)
        sizes = Sizes(  # which are subtracted
            -places.left_along_axis, -contacts.support_friction,
            -contacts.side_friction, -bend_of(TILT, w, i),
        )  # fmt: skip
        g = single_functions(places, contacts, sizes, p, mode)
        constant = single_functions(NOWHERE, UNLOADED, _SMALL, p, mode)
        bends = (
            abs(g[0] - constant[0]), abs(g[1] - constant[1]), abs(g[2] - constant[2]),
            abs(g[3] - constant[3]), abs(g[4] - constant[4]), abs(g[5] - constant[5]),
            abs(g[6] - constant[6]), abs(g[7] - constant[7]), abs(g[8] - constant[8]),
            abs(g[9] - constant[9]), abs(g[10] - constant[10]), abs(g[11] - constant[11]),
        )  # fmt: skip
        _enter_single(BENDS, bends, w, i)


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
def _samples_of(which, w, i):
    """A function at each node."""
    n = WIDTH
    at = (SAMPLES + which) * n + i
    return (
        w[at], w[at + SWITCH_COUNT * n], w[at + 2 * SWITCH_COUNT * n],
        w[at + 3 * SWITCH_COUNT * n], w[at + 4 * SWITCH_COUNT * n],
    )  # fmt: skip


@inlined_kernel
def _lowest_of(samples):
    inner = min(min(samples[1], samples[2]), samples[3])
    return min(min(samples[0], samples[4]), inner)


@inlined_kernel
def _screen_single(which, w, i):
    """The bit of a function if it may come to zero."""
    above = _lowest_of(_samples_of(which, w, i)) - w[(BENDS + which) * WIDTH + i]
    return 0.0 if above > 0.0 else float(1 << which)


@inlined_kernel
def _enter_quarters(which, flagged, w, i):
    w[(MAY_SWITCH + which) * WIDTH + i] = flagged
    w[SHOWN * WIDTH + i] += float(1 << which) if flagged > 0.0 else 0.0


@inlined_kernel
def _find_single(which, shown, w):
    """Enter where a function of those ``shown``, as bits, may fall through zero."""
    if shown & (1 << which) == 0:
        return
    for i in range(WIDTH):
        g, bend = _samples_of(which, w, i), w[(BENDS + which) * WIDTH + i]
        flagged = _quarters(
            stays_above(g[0], g[1], bend), stays_above(g[1], g[2], bend),
            stays_above(g[2], g[3], bend), stays_above(g[3], g[4], bend),
        )  # fmt: skip
        _enter_quarters(which, 0.0 if g[0] == NEVER else flagged, w, i)


@inlined_kernel
def is_corner(which):
    """Whether a function is watched without its closing rate, and so does not tell by itself."""
    return which == RIGHT_CORNER_LANDS or which == LEFT_CORNER_LANDS


@inlined_kernel
def one_stays_above(left, right, bends):
    """Whether one of four quantities ``stays_above``, and with it the largest of them."""
    return (
        stays_above(left[0], right[0], bends[0])
        | stays_above(left[1], right[1], bends[1])
        | stays_above(left[2], right[2], bends[2])
        | stays_above(left[3], right[3], bends[3])
    )


@inlined_kernel
def _quantities_at(node, which, w, i):
    row = VALUES + node * SINES
    tilt = w[(row + TILT) * WIDTH + i]
    return quantities_at(which, outline_in(row, 1.0, w, i), tilt, constants_of_lane(w, i))


@inlined_kernel
def _quantities(which, w, i):
    """The quantities of a function at each node."""
    return (
        _quantities_at(0, which, w, i), _quantities_at(1, which, w, i),
        _quantities_at(2, which, w, i), _quantities_at(3, which, w, i),
        _quantities_at(4, which, w, i),
    )  # fmt: skip


@inlined_kernel
def _bends(which, w, i):
    """How far the quantities of a function may be from lines through their samples."""
    p, places = constants_of_lane(w, i), outline_in(VALUES + NODES * SINES, _BEND, w, i)
    g = quantities_at(which, places, bend_of(TILT, w, i), p)
    constant = quantities_at(which, NOWHERE, 0.0, p)
    return (
        abs(g[0] - constant[0]), abs(g[1] - constant[1]),
        abs(g[2] - constant[2]), abs(g[3] - constant[3]),
    )  # fmt: skip


@inlined_kernel
def _screen_combined(which, w):
    """The same of the largest of several quantities, which is sampled here.

    It stays clear of zero if one of the quantities does.
    """
    n = WIDTH
    first = (SAMPLES + which) * n
    least = TOO_FLAT_TO_TELL if is_corner(which) else 0.0
    for i in range(WIDTH):
        applies = applies_in(mode_of_lane(w, i))[which]
        bends = _bends(which, w, i)
        q0, q1, q2, q3, q4 = _quantities(which, w, i)
        g0, g1, g2 = largest(q0)[0], largest(q1)[0], largest(q2)[0]
        g3, g4 = largest(q3)[0], largest(q4)[0]
        w[first + i] = g0 if applies else NEVER
        w[first + SWITCH_COUNT * n + i] = g1
        w[first + 2 * SWITCH_COUNT * n + i] = g2
        w[first + 3 * SWITCH_COUNT * n + i] = g3
        w[first + 4 * SWITCH_COUNT * n + i] = g4
        is_clear = (
            (_lowest_of((q0[0], q1[0], q2[0], q3[0], q4[0])) > max(least, bends[0]))
            | (_lowest_of((q0[1], q1[1], q2[1], q3[1], q4[1])) > max(least, bends[1]))
            | (_lowest_of((q0[2], q1[2], q2[2], q3[2], q4[2])) > max(least, bends[2]))
            | (_lowest_of((q0[3], q1[3], q2[3], q3[3], q4[3])) > max(least, bends[3]))
        )
        bit = 0.0 if is_clear else float(1 << which)
        w[SHOWN * n + i] += bit if applies else 0.0


@inlined_kernel
def _find_combined(which, shown, w):
    """The same of the largest of several quantities."""
    if shown & (1 << which) == 0:
        return
    for i in range(WIDTH):
        bends = _bends(which, w, i)
        q0, q1, q2, q3, q4 = _quantities(which, w, i)
        flagged = _quarters(
            one_stays_above(q0, q1, bends), one_stays_above(q1, q2, bends),
            one_stays_above(q2, q3, bends), one_stays_above(q3, q4, bends),
        )  # fmt: skip
        # Near flat, what is on its switch to rounding may be beyond it.
        g = _samples_of(which, w, i)
        flat = is_corner(which) & (_lowest_of(g) < TOO_FLAT_TO_TELL)
        flagged = float(ALL_QUARTERS) if flat else flagged
        _enter_quarters(which, 0.0 if g[0] == NEVER else flagged, w, i)


@kernel
def _find(w):
    """Of functions that may come to zero, find where they may fall through it."""
    shown = 0
    for i in range(WIDTH):
        shown |= int(w[SHOWN * WIDTH + i])
    for i in range(WIDTH):
        w[SHOWN * WIDTH + i] = 0.0
    # Each by its own constant, as above.
    _find_combined(ALIGNED, shown, w)
    _find_combined(CORNERS_INSIDE, shown, w)
    _find_combined(RIGHT_EDGE_ENTERS, shown, w)
    _find_combined(LEFT_EDGE_ENTERS, shown, w)
    _find_combined(RIGHT_CORNER_LANDS, shown, w)
    _find_combined(LEFT_CORNER_LANDS, shown, w)
    _find_combined(RIGHT_WALL, shown, w)
    _find_combined(LEFT_WALL, shown, w)
    _find_single(FACE_LOAD, shown, w)
    _find_single(FACE_GAP, shown, w)
    _find_single(FACE_RELOAD, shown, w)
    _find_single(FACE_END, shown, w)
    _find_single(FACE_FAR_END, shown, w)
    _find_single(SIDE_LOAD, shown, w)
    _find_single(SIDE_GAP, shown, w)
    _find_single(SIDE_RELOAD, shown, w)
    _find_single(SIDE_END, shown, w)
    _find_single(SUPPORT_SLIP, shown, w)
    _find_single(SIDE_SLIP, shown, w)
    _find_single(OVERTURNED, shown, w)


@inlined_kernel
def _leave_out(which, w, i):
    """Enter that a function does not apply."""
    w[(SAMPLES + which) * WIDTH + i] = NEVER


@kernel
def _leave_out_side(w):
    for i in range(WIDTH):
        _leave_out(SIDE_LOAD, w, i)
        _leave_out(SIDE_GAP, w, i)
        _leave_out(SIDE_RELOAD, w, i)
        _leave_out(SIDE_END, w, i)
        _leave_out(SIDE_SLIP, w, i)


@kernel
def _leave_out_flight(w):
    for i in range(WIDTH):
        _leave_out(ALIGNED, w, i)
        _leave_out(CORNERS_INSIDE, w, i)
        _leave_out(RIGHT_EDGE_ENTERS, w, i)
        _leave_out(RIGHT_WALL, w, i)


@kernel
def _screen_side(w):
    # In one loop: the compiler unrolls short ones, and does not make vectors of them.
    for i in range(WIDTH):
        w[SHOWN * WIDTH + i] += (
            _screen_single(SIDE_LOAD, w, i) + _screen_single(SIDE_GAP, w, i)
            + _screen_single(SIDE_RELOAD, w, i) + _screen_single(SIDE_END, w, i)
            + _screen_single(SIDE_SLIP, w, i)
        )  # fmt: skip


@kernel
def _screen_face(w):
    for i in range(WIDTH):
        w[SHOWN * WIDTH + i] += (
            _screen_single(FACE_LOAD, w, i) + _screen_single(FACE_GAP, w, i)
            + _screen_single(FACE_RELOAD, w, i) + _screen_single(FACE_END, w, i)
            + _screen_single(FACE_FAR_END, w, i) + _screen_single(SUPPORT_SLIP, w, i)
            + _screen_single(OVERTURNED, w, i)
        )  # fmt: skip


@kernel
def _screen(flies, beside, w):
    """Screen every function that may apply."""
    for i in range(WIDTH):
        w[SHOWN * WIDTH + i] = 0.0
    if beside:
        _screen_side(w)
    else:
        _leave_out_side(w)
    _screen_face(w)
    if flies:
        _screen_combined(ALIGNED, w)
        _screen_combined(CORNERS_INSIDE, w)
        _screen_combined(RIGHT_EDGE_ENTERS, w)
        _screen_combined(RIGHT_WALL, w)
    else:
        _leave_out_flight(w)
    _screen_combined(LEFT_EDGE_ENTERS, w)
    _screen_combined(RIGHT_CORNER_LANDS, w)
    _screen_combined(LEFT_CORNER_LANDS, w)
    _screen_combined(LEFT_WALL, w)
    _find(w)


@inlined_kernel
def _enter_lowest(which, w, i):
    """How low a function comes; NEVER where it leaves zero, which is no approach to it."""
    at, quarter = (LOWEST + which) * WIDTH + i, SWITCH_COUNT * WIDTH
    g = _samples_of(which, w, i)
    second = min(g[1], g[2])
    third = min(second, g[3])
    counts = (g[0] > ON_A_SWITCH) & (g[0] != NEVER)
    w[at] = g[1] if counts else NEVER
    w[at + quarter] = second if counts else NEVER
    w[at + 2 * quarter] = third if counts else NEVER
    w[at + 3 * quarter] = min(third, g[4]) if counts else NEVER


@kernel
def _note_lowest(w):
    """How low every function comes up to the end of each quarter."""
    for i in range(WIDTH):
        _enter_lowest(ALIGNED, w, i)
        _enter_lowest(CORNERS_INSIDE, w, i)
        _enter_lowest(RIGHT_EDGE_ENTERS, w, i)
        _enter_lowest(LEFT_EDGE_ENTERS, w, i)
        _enter_lowest(RIGHT_CORNER_LANDS, w, i)
        _enter_lowest(LEFT_CORNER_LANDS, w, i)
        _enter_lowest(RIGHT_WALL, w, i)
        _enter_lowest(LEFT_WALL, w, i)
        _enter_lowest(FACE_LOAD, w, i)
        _enter_lowest(FACE_GAP, w, i)
        _enter_lowest(FACE_RELOAD, w, i)
        _enter_lowest(FACE_END, w, i)
        _enter_lowest(FACE_FAR_END, w, i)
        _enter_lowest(SIDE_LOAD, w, i)
        _enter_lowest(SIDE_GAP, w, i)
        _enter_lowest(SIDE_RELOAD, w, i)
        _enter_lowest(SIDE_END, w, i)
        _enter_lowest(SUPPORT_SLIP, w, i)
        _enter_lowest(SIDE_SLIP, w, i)
        _enter_lowest(OVERTURNED, w, i)


@inlined_kernel
def _at_most(row, w, i):
    """What |row| stays below in the step, by its samples and its bend."""
    first, node = (VALUES + row) * WIDTH + i, SINES * WIDTH
    ends, inner = max(abs(w[first]), abs(w[first + 4 * node])), abs(w[first + 2 * node])
    inner = max(inner, max(abs(w[first + node]), abs(w[first + 3 * node])))
    return max(ends, inner) + bend_of(row, w, i)


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
def step_all(kind, flies, beside, control, w):
    """Make one step in every lane, and say in SHOWN where a switch may be in it.

    ``flies`` and ``beside``: whether in any lane the edge is not under the face, and whether A2 is
    behind the side. How low functions come, and what tilt and forces stay below, is entered where
    ``control`` asks for it.
    """
    _turn(w)
    fill_series(kind, w, COEFFICIENTS, 0)
    _set_lengths(w)
    follow_series(w, COEFFICIENTS, LENGTH, VALUES)
    _sample(w)
    _note_bends(w)
    _screen(flies, beside, w)
    if control.may_settle != 0.0:
        _note_lowest(w)
    if control.alignment_only == 0.0:
        _note_largest(w)
    _end_steps(w)
