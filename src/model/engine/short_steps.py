"""Steps where series have no numbers: the loads of an edge and its corner may begin together.

Their shares in the friction are then 0 / 0, and so are later coefficients. The classical method of
order 4 makes a short step, after which the loads differ from zero. Where the rates of the state are
no numbers either, or no step is short enough, the run fails.
"""

from math import sqrt

from model.compile.kernels import inlined_kernel, separate_kernel
from model.engine.carried_error import DISPLACEMENT, NO_ERROR, size_of
from model.engine.lifecycle import carries_error, end_step, fail, note_step
from model.engine.rates import STILL, are_finite, is_too_short, moved, rates_at, short_step
from model.engine.record import (
    AT,
    ERROR,
    STATE,
    constants_of,
    mode_of,
    state_in,
    store_state,
    store_state_in,
)
from model.events.friction import hold_sticking
from model.events.outcomes import REASON
from model.physics.motion import contact_rate
from model.physics.notation import STATE_SIZE

_RADIANS = 0.1  # first trial of a step, in radians of a contact's oscillation
_SHRINKING = 0.25


@inlined_kernel
def _two_steps(time, length, q, p, mode):
    """Return the state after two steps of half the length."""
    half = 0.5 * length
    return short_step(time + half, half, short_step(time, half, q, p, mode), p, mode)


@inlined_kernel
def _is_accurate(difference, q, tolerance):
    accurate = True
    for n in range(STATE_SIZE):
        accurate = accurate and abs(difference[n]) <= tolerance * (1.0 + abs(q[n]))
    return accurate


@separate_kernel
def step_without_series(scene, control, history, runs, i):
    """Advance run ``i`` by a short step, or let it fail."""
    time, p, mode = runs[i, AT.time], constants_of(scene.events, runs, i), mode_of(runs, i)
    q = state_in(runs, STATE, i)
    if not are_finite(rates_at(time, q, p, mode)):
        fail(scene, runs, i, REASON.NOT_FINITE)
        return
    end, difference, found = q, STILL, False
    until = min(runs[i, AT.stop], runs[i, AT.halt])
    length = min(_RADIANS / (1.0 + contact_rate(p, mode)), 0.5 * (until - time))
    length = min(length, 0.1 * sqrt(runs[i, AT.tolerance]))  # an event in it is met at its end
    while length > 0.0 and not (found or is_too_short(length, time)):
        end = _two_steps(time, length, q, p, mode)
        difference = moved(end, -1.0, short_step(time, length, q, p, mode))
        found = _is_accurate(difference, q, runs[i, AT.tolerance])
        runs[i, AT.rhs_evaluations] += 12.0
        length *= 1.0 if found else _SHRINKING
    if not found:
        fail(scene, runs, i, REASON.STEP_TOO_SMALL)
        return
    if carries_error(scene, control, runs, i):
        error = state_in(runs, ERROR, i)
        factor = DISPLACEMENT / max(size_of(error), NO_ERROR)
        displaced = _two_steps(time, length, moved(q, factor, error), p, mode)
        error = moved(difference, 1.0 / factor, moved(displaced, -1.0, end))
        store_state_in(error, runs, ERROR, i)
        runs[i, AT.largest_error] = max(runs[i, AT.largest_error], size_of(error))
    store_state(hold_sticking(end, p, mode), runs, i)
    runs[i, AT.time] = time + length
    note_step(scene, length, abs(end.tilt), runs, i)
    end_step(scene, False, history, control, runs, i)
