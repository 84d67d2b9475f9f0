"""When a run that will never align may stop: its motion repeats itself.

Once an excitation period the state is compared with the state n periods back. If these differences
contract, by a ratio ρ < 1 over n periods, twice in a row, what is left of the motion is at most
Δ ρ/(1 - ρ). The run has settled when that remainder, taken tenfold, is smaller than the distance to
alignment and to every switch that the last n periods did not make.
"""

import numpy as np

from model.physics.compiled import kernel
from model.solver.step import STATE_SIZE
from model.solver.switching import (
    CORNER_LOAD,
    CORNER_RELOAD,
    FACE_LOAD,
    FACE_RELOAD,
    NEVER,
    SIDE_LOAD,
    SIDE_RELOAD,
    SIDE_SLIP,
    SUPPORT_SLIP,
    SWITCH_COUNT,
)

LONGEST_PERIOD = 8
_HISTORY = 3 * LONGEST_PERIOD + 1
_LINEAR = 1e-4  # largest difference at which contraction counts as a property of the cycle
_CONTRACTION = 0.98
_SAFETY = 10.0


@kernel
def new_history():
    """(states, lowest): ring buffers of the states and lowest switching functions by period."""
    return np.full((_HISTORY, STATE_SIZE), np.nan), np.full((_HISTORY, SWITCH_COUNT), NEVER)


@kernel
def record_period(count, y, closest, states, lowest):
    """Store the state at the end of period ``count`` and the lowest switching functions in it."""
    row = count % _HISTORY
    states[row] = y
    lowest[row] = closest


@kernel
def _difference(count, n, states):
    gap = 0.0
    for i in range(STATE_SIZE):
        gap = max(gap, abs(states[count % _HISTORY, i] - states[(count - n) % _HISTORY, i]))
    return gap


@kernel
def _steepness(which, stiffness, length):
    """How much a switching function can change with a unit of the state.

    Loads and friction margins change with the base's stiffness, the others are lengths and
    velocities of points of the part.
    """
    is_load = (
        which == FACE_LOAD
        or which == FACE_RELOAD
        or which == SIDE_LOAD
        or which == SIDE_RELOAD
        or which == CORNER_LOAD
        or which == CORNER_RELOAD
        or which == SUPPORT_SLIP
        or which == SIDE_SLIP
    )
    return stiffness * length if is_load else length


@kernel
def settled_period(count, states, lowest, p, noise):
    """Period (in excitation periods) of the motion the run has settled on, or 0.

    ``noise`` is the size of a difference that is the integrator's own.
    """
    length = 1.0 + p.half_width + p.half_height
    stiffness = 1.0 + p.contact_stiffness + p.contact_damping
    for n in range(1, LONGEST_PERIOD + 1):
        if count < 3 * n:
            break
        gap = _difference(count, n, states)
        if gap > _LINEAR:
            continue
        before = _difference(count - n, n, states)
        earlier = _difference(count - 2 * n, n, states)
        contraction = 0.0
        if gap > noise:
            contraction = max(gap / before, before / earlier)
            if contraction > _CONTRACTION:
                continue
        elif before > noise:
            contraction = min(before / earlier, _CONTRACTION)
        remainder = max(gap, noise) / (1.0 - contraction)
        clear = True
        for i in range(n):
            for which in range(SWITCH_COUNT):
                distance = lowest[(count - i) % _HISTORY, which]
                steepness = _steepness(which, stiffness, length)
                if distance != NEVER and _SAFETY * remainder * steepness > distance:
                    clear = False
        if clear:
            return n
    return 0
