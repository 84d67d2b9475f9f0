"""The lifecycle of a run between its steps: events, stages, excitation periods and end.

Time counts from the start; of a part that is lowered (physics/approach.py),
from its first touch and, if it is lowered without vibration, anew from the onset of the vibration.
"""

from math import isfinite, isnan, pi
from typing import NamedTuple

import numpy as np

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.engine.rates import short_step
from model.engine.record import (
    AT,
    CLOSEST,
    DESCENDS,
    MADE,
    PRESSES,
    STATE,
    VIBRATES,
    constants_of,
    is_watched,
    mode_of,
    state_in,
    store_mode,
    store_state,
)
from model.events.event_functions import NEVER
from model.events.friction import decide_friction, hold_sticking
from model.events.insertion import end_in_slot
from model.events.kernels import MOST_EVENTS, reset, transition
from model.events.outcomes import OUTCOME, REASON
from model.events.steady_state import (
    HISTORY,
    LONGEST_PERIOD,
    record_closest,
    record_state,
    settled_period,
    watched_until,
)
from model.events.transitions import CONTINUES
from model.physics.approach import RUNNING, is_at_rest
from model.physics.modes import OPEN, STICKING
from model.physics.motion import is_beside, is_supported
from model.physics.notation import STATE_SIZE

_SHORTEST_STEP = 1e-12  # after an event
_SEVERAL_AT_ONCE = 16  # events in one instant, above which rounding may be their only cause
_MOST_EVENTS_AT_ONCE = 64
NOISE = 100.0  # difference between two periods due to errors, over the tolerance
_FALL_TIME = 20.0  # longest fall from the loss of contact until the corners are inside


class Control(NamedTuple):
    """Limits and flags of a run.

    Attributes:
        horizon: latest time; in the insertion scene once more after alignment.
        max_evaluations: largest number of right-hand-side evaluations.
        settling_noise: difference between periods that counts as none, unless that of the run's
            own tolerance is larger; 0.0 if runs may not stop in periodic steady state.
        alignment_only: 1.0 to end at alignment, without the largest tilt and force, else 0.0.
        start: number of the start: see physics/approach.py.
        carries_error: 1.0 to carry the error along, else 0.0.
    """

    horizon: float
    max_evaluations: int
    settling_noise: float
    alignment_only: float
    start: float
    carries_error: float = 0.0


class History(NamedTuple):
    """States and lowest levels in the last periods of runs, as ring buffers; see steady_state.py.

    Shapes: states (runs, HISTORY, 6), lowest (runs, LONGEST_PERIOD, MOST_EVENTS).
    """

    states: np.ndarray
    lowest: np.ndarray


def new_history(count: int) -> History:
    """Return an empty ``History`` of ``count`` runs."""
    states = np.zeros((count, HISTORY, STATE_SIZE))
    return History(states, np.zeros((count, LONGEST_PERIOD, MOST_EVENTS)))


@kernel
def period_length(p):
    """Period of the excitation; 2π if the excitation is constant."""
    return 2.0 * pi / p.frequency if p.frequency > 0.0 else 2.0 * pi


@kernel
def note_end_of_period(scene, runs, i):
    """Set the next stop: the end of the present period or, if earlier, of the run."""
    runs[i, AT.stop] = runs[i, AT.deadline]
    if runs[i, AT.stage] == VIBRATES:
        length = period_length(constants_of(scene.events, runs, i))
        next_period = (runs[i, AT.periods] + 1.0) * length
        runs[i, AT.stop] = min(next_period, runs[i, AT.deadline])
    _note_halt(runs, i)


@kernel
def _note_halt(runs, i):
    """Set the time at which the next steps must end: of the ramp, a look for rest, or the run."""
    halt = runs[i, AT.deadline]
    if runs[i, AT.time] < runs[i, AT.ramp_end]:
        halt = min(halt, runs[i, AT.ramp_end])
    elif runs[i, AT.stage] == PRESSES:
        halt = min(halt, runs[i, AT.time] + 2.0 * pi)
    runs[i, AT.halt] = halt


@kernel
def _count_anew(scene, stage, control, runs, i):
    """Count time from now on, in the next stage; what the periods before were does not matter."""
    time = runs[i, AT.time]
    runs[i, AT.phase] += runs[i, AT.frequency] * time
    runs[i, AT.ramp_end] = max(runs[i, AT.ramp_end] - time, 0.0)
    runs[i, AT.tau_align] -= time  # NaN unless the part aligned before the vibration set in
    runs[i, AT.tau_corners_inside] -= time
    runs[i, AT.stage], runs[i, AT.time], runs[i, AT.sticking_time] = stage, 0.0, 0.0
    runs[i, AT.deadline] = runs[i, AT.ramp_end] + control.horizon
    for which in range(scene.events.count):
        runs[i, CLOSEST + which], runs[i, MADE + which] = NEVER, 0.0
    note_end_of_period(scene, runs, i)


@kernel
def _look_for_rest(scene, control, runs, i):
    """Let the vibration set in if the pressed part is at rest."""
    q, mode = state_in(runs, STATE, i), mode_of(runs, i)
    if not is_at_rest(runs[i, AT.time], q, constants_of(scene.events, runs, i), mode):
        return
    _count_anew(scene, VIBRATES, control, runs, i)
    runs[i, AT.frequency], runs[i, AT.phase] = runs[i, AT.held_frequency], runs[i, AT.held_phase]
    note_end_of_period(scene, runs, i)
    p = constants_of(scene.events, runs, i)
    support, side = mode.support_slip == STICKING, mode.side_slip == STICKING
    mode, possible = decide_friction(0.0, q, p, mode, support, side)
    store_mode(mode, runs, i)
    if not possible:
        fail(scene, runs, i, REASON.NO_FRICTION_SOLUTION)


@kernel
def end(scene, runs, i, outcome, reason):
    """End run ``i``; a run that has aligned is aligned, or ends as its part does in the slot.

    The reason of one that has needed no vibration is the press alone.
    """
    waits = runs[i, AT.stage] != VIBRATES
    if waits and outcome == OUTCOME.HORIZON_REACHED:
        reason = REASON.STILL_MOVES if runs[i, AT.stage] == PRESSES else REASON.NO_TOUCH
    if isfinite(runs[i, AT.tau_align]):
        if not scene.events.inserts:
            outcome, reason = OUTCOME.ALIGNED, REASON.NONE
        else:
            q, mode = state_in(runs, STATE, i), mode_of(runs, i)
            p = constants_of(scene.events, runs, i)
            outcome, reason = end_in_slot(outcome, reason, q, p, mode)
    if outcome == OUTCOME.INSERTED:
        runs[i, AT.tau_inserted] = runs[i, AT.time] - runs[i, AT.tau_align]
    before_onset = waits or (outcome == OUTCOME.ALIGNED and runs[i, AT.tau_align] < 0.0)
    if before_onset and (outcome == OUTCOME.INSERTED or outcome == OUTCOME.ALIGNED):
        reason = REASON.BY_PRESS
    runs[i, AT.outcome], runs[i, AT.reason] = outcome, reason


@kernel
def fail(scene, runs, i, reason):
    """End run ``i`` as failed."""
    end(scene, runs, i, OUTCOME.FAILED, reason)


@kernel
def is_counted(mode, p):
    """Return whether the motion counts towards the results, unlike the fall after alignment."""
    return not mode.dropped or p.printed_alignment_criterion != 0.0


@kernel
def note_step(scene, length, tilt, runs, i):
    """Record an accepted step, with its largest |tilt|; the fall after alignment does not count.

    ``max`` returns its first argument if that is NaN: a largest tilt that is not computed stays so.
    """
    mode = mode_of(runs, i)
    runs[i, AT.steps] += 1.0
    if is_counted(mode, constants_of(scene.events, runs, i)):
        runs[i, AT.tilt_max] = max(runs[i, AT.tilt_max], tilt)
        if mode.support_slip == STICKING and is_supported(mode):
            runs[i, AT.sticking_time] += length


@inlined_kernel
def notes_forces(scene, mode, control, runs, i):
    """Return whether the largest forces grow: until alignment, or until inserted."""
    counts = scene.events.inserts or is_counted(mode, constants_of(scene.events, runs, i))
    return counts and control.alignment_only == 0.0


@inlined_kernel
def carries_error(scene, control, runs, i):
    """Return whether run ``i`` carries its error: without insertion, only until it aligns."""
    needed = scene.events.inserts or isnan(runs[i, AT.tau_align])
    return control.carries_error != 0.0 and needed


@kernel
def _is_lift_off(before, after):
    """Return whether the part loses its support at an event."""
    return (before.face != OPEN or before.corner != OPEN) and (
        after.face == OPEN and after.corner == OPEN
    )


@kernel
def _note_alignment(scene, is_inside, tilt, printed_criterion, control, runs, i):
    """Record alignment or, if ``is_inside``, all corners inside; return whether the run ends.

    The first instant counts (R8), even if the part is lifted and falls again. In the insertion
    scene the horizon begins anew.
    """
    time = runs[i, AT.time]
    inserts = scene.events.inserts
    if is_inside:
        runs[i, AT.tau_corners_inside] = time
    elif not printed_criterion and isnan(runs[i, AT.tau_align]):
        deadline = min(runs[i, AT.deadline], time + _FALL_TIME)
        runs[i, AT.deadline] = time + control.horizon if inserts else deadline
        note_end_of_period(scene, runs, i)
    if printed_criterion == is_inside and isnan(runs[i, AT.tau_align]):
        runs[i, AT.tau_align], runs[i, AT.tilt_at_alignment] = time, tilt
    if control.alignment_only != 0.0 and not printed_criterion:
        return True
    return is_inside and not inserts


@kernel
def skip_chatter(scene, before, runs, i):
    """Advance by a moment without event location, if the two modes agree within the tolerance.

    On a hard base, rounding of a length causes a load. A contact or slip near zero then alternates
    without time passing (chatter, Zeno behaviour). The moment doubles at every such event. Where
    the two modes differ by more than a step's tolerance, the run stays where it is; it fails after
    too many events.
    """
    time, p, mode = runs[i, AT.time], constants_of(scene.events, runs, i), mode_of(runs, i)
    q, tolerance = state_in(runs, STATE, i), runs[i, AT.tolerance]
    moment = _SHORTEST_STEP * 2.0 ** (runs[i, AT.events_at_once] - _SEVERAL_AT_ONCE)
    if time + moment >= min(runs[i, AT.stop], runs[i, AT.halt]):
        return
    here = short_step(time, moment, q, p, mode)
    there = short_step(time, moment, q, p, before)
    half = short_step(time, 0.5 * moment, q, p, mode)
    halves = short_step(time + 0.5 * moment, 0.5 * moment, half, p, mode)
    runs[i, AT.rhs_evaluations] += 16.0
    for n in range(STATE_SIZE):
        admitted = tolerance * (1.0 + abs(q[n]))
        if not (abs(there[n] - here[n]) <= admitted and abs(halves[n] - here[n]) <= admitted):
            return
    store_state(hold_sticking(here, p, mode), runs, i)
    runs[i, AT.time] = time + moment


@separate_kernel
def apply_event(which, length, step, scene, control, runs, i):
    """Apply the transition of the event ``which`` at the run's state: next mode, or end.

    ``length`` is the time from the last step to the event, ``step`` the length of the whole step.
    """
    time, p, before = runs[i, AT.time], constants_of(scene.events, runs, i), mode_of(runs, i)
    runs[i, AT.events] += 1.0
    runs[i, MADE + which], runs[i, AT.last_event] = 1.0, which + 1.0
    at_once = length <= 1e-13 * max(1.0, time)
    runs[i, AT.events_at_once] = runs[i, AT.events_at_once] + 1.0 if at_once else 0.0
    # If no time passes, the step was too long for the accuracy of its dense output (for instance
    # where the friction force only just reaches its limit).
    runs[i, AT.next_step] = max(0.25 * step if at_once else step, _SHORTEST_STEP)
    q = reset(scene.events, which, state_in(runs, STATE, i), p, before)
    mode, outcome, reason = transition(scene.events, which, time, q, p, before, scene.declared)
    if outcome == CONTINUES and is_counted(before, p) and _is_lift_off(before, mode):
        runs[i, AT.separations] += 1.0
    store_state(hold_sticking(q, p, mode), runs, i)
    store_mode(mode, runs, i)
    if outcome == OUTCOME.ALIGNED:
        printed_criterion = p.printed_alignment_criterion != 0.0
        inside = which == scene.events.corners_inside
        if not _note_alignment(scene, inside, q.tilt, printed_criterion, control, runs, i):
            outcome = CONTINUES
    if runs[i, AT.stage] == DESCENDS and (is_supported(mode) or is_beside(mode)):
        waits = control.start != RUNNING
        _count_anew(scene, PRESSES if waits else VIBRATES, control, runs, i)
    if outcome != CONTINUES:
        end(scene, runs, i, outcome, reason)
    elif runs[i, AT.events_at_once] > _SEVERAL_AT_ONCE:
        skip_chatter(scene, before, runs, i)


@kernel
def _compare_periods(scene, periods, history, settling_noise, runs, i):
    """Record the state and the closest approaches of a period; end a run that has settled."""
    if mode_of(runs, i).dropped and not scene.events.inserts:
        return
    states, lowest = history.states[i], history.lowest[i]
    p = constants_of(scene.events, runs, i)
    length = period_length(p)
    pressed = periods  # since the press has its full value
    if p.ramp_end > 0.0:
        pressed -= int(p.ramp_end / length) + 1
        if pressed < 1:
            return
    record_state(pressed, runs[i, STATE : STATE + STATE_SIZE], states)
    if periods <= runs[i, AT.watched_until]:
        for which in range(scene.events.count):  # events that happened need no distance
            if runs[i, MADE + which] != 0.0:
                runs[i, CLOSEST + which] = NEVER
        record_closest(pressed, runs[i, CLOSEST : CLOSEST + scene.events.count], lowest)
    noise = max(settling_noise, NOISE * runs[i, AT.tolerance])
    period = settled_period(scene.events, pressed, length, states, lowest, p, noise)
    if period > 0:
        runs[i, AT.period] = period
        end(scene, runs, i, OUTCOME.SETTLED, REASON.NONE)
    until = watched_until(pressed, states)
    if until > 0:
        until += periods - pressed
    runs[i, AT.watched_until] = max(runs[i, AT.watched_until], until)
    if is_watched(runs, i):
        for which in range(scene.events.count):
            runs[i, CLOSEST + which], runs[i, MADE + which] = NEVER, 0.0


@separate_kernel
def end_period(scene, history, settling_noise, runs, i):
    """Count a completed period; end the run if it may settle and its motion is periodic."""
    periods = int(runs[i, AT.periods]) + 1
    runs[i, AT.periods] = periods
    note_end_of_period(scene, runs, i)
    if settling_noise > 0.0:
        _compare_periods(scene, periods, history, settling_noise, runs, i)


@kernel
def end_step(scene, reached_stop, history, control, runs, i):
    """End a step: check the limits of the run, and count its periods."""
    if runs[i, AT.outcome] != CONTINUES:
        return
    if runs[i, AT.events_at_once] > _MOST_EVENTS_AT_ONCE:
        fail(scene, runs, i, REASON.CHATTER)
    elif runs[i, AT.rhs_evaluations] > control.max_evaluations:
        fail(scene, runs, i, REASON.TOO_MANY_EVALUATIONS)
    elif runs[i, AT.time] >= runs[i, AT.deadline]:
        end(scene, runs, i, OUTCOME.HORIZON_REACHED, REASON.NONE)
    elif runs[i, AT.time] >= runs[i, AT.halt]:
        _note_halt(runs, i)
        if runs[i, AT.stage] == PRESSES:
            _look_for_rest(scene, control, runs, i)
    if reached_stop and runs[i, AT.outcome] == CONTINUES:
        end_period(scene, history, control.settling_noise, runs, i)
