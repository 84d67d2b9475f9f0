"""When a run that will never align may stop: its motion repeats itself.

Once an excitation period the state is compared with the state n periods back. If these differences
are small and contract, by a ratio ρ < 1 over n periods, twice in a row, what is left of the motion
is at most Δ ρ/(1 - ρ). The run has settled when that remainder, taken fivefold, cannot reach
alignment or any switch that the last n periods did not make.
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
_LINEAR = 1e-3  # largest difference at which contraction counts as a property of the cycle
_NEARLY_LINEAR = 1e-2  # and largest of the two differences before it
_CONTRACTION = 0.98
_SAFETY = 5.0


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
def _differences(count, n, states, out):
    """Write the absolute differences of the states at periods ``count`` and ``count - n``."""
    for i in range(STATE_SIZE):
        out[i] = abs(states[count % _HISTORY, i] - states[(count - n) % _HISTORY, i])


@kernel
def _change(which, r, p):
    """How much a switching function can change while the state's components change by ``r``.

    Lengths and slips are those of points of the part, at most half its diagonal from the centre;
    loads are depths and closing rates times the base's stiffness and damping; a friction margin is
    a load and the friction force that answers to it.
    """
    arm = p.half_width + p.half_height
    length = r[0] + r[1] + arm * r[2]
    rate = r[3] + r[4] + arm * r[5]
    load = p.contact_stiffness * length + p.contact_damping * rate
    if which == SUPPORT_SLIP or which == SIDE_SLIP:
        return 2.0 * load + length + rate
    if (
        which == FACE_LOAD
        or which == FACE_RELOAD
        or which == SIDE_LOAD
        or which == SIDE_RELOAD
        or which == CORNER_LOAD
        or which == CORNER_RELOAD
    ):
        return load
    return length + rate


@kernel
def settled_period(count, states, lowest, p, noise):
    """Period (in excitation periods) of the motion the run has settled on, or 0.

    ``noise`` is the size of a difference that is the integrator's own.
    """
    remainder, before, earlier = np.empty(STATE_SIZE), np.empty(STATE_SIZE), np.empty(STATE_SIZE)
    for n in range(1, LONGEST_PERIOD + 1):
        if count < 3 * n:
            break
        _differences(count, n, states, remainder)
        gap = remainder.max()
        if gap > _LINEAR:
            continue
        _differences(count - n, n, states, before)
        _differences(count - 2 * n, n, states, earlier)
        if max(before.max(), earlier.max()) > _NEARLY_LINEAR:
            continue
        contraction = 0.0
        if gap > noise:
            contraction = max(gap / before.max(), before.max() / earlier.max())
            if contraction > _CONTRACTION:
                continue
        elif before.max() > noise:
            contraction = min(before.max() / earlier.max(), _CONTRACTION)
        for i in range(STATE_SIZE):
            remainder[i] = max(remainder[i], noise) / (1.0 - contraction)
        clear = True
        for i in range(n):
            for which in range(SWITCH_COUNT):
                distance = lowest[(count - i) % _HISTORY, which]
                if distance != NEVER and _SAFETY * _change(which, remainder, p) > distance:
                    clear = False
        if clear:
            return n
    return 0
