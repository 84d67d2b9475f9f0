"""Periodic steady state: the criterion by which a run that will never align may stop.

After every excitation period the state is compared with the state n periods earlier. If the
difference Δ is small and contracts twice in a row, by a ratio ρ < 1 over n periods, the remaining
transient is at most Δ/(1 - ρ). The rest of the difference, which does not contract, may be a creep:
it is assumed to last. The steady state is reached when neither change, times five, can bring about
alignment or any other event that did not happen in the last n periods. Its period is the shortest
that the rest of the transient admits.
"""

from model.compile.kernels import inlined_kernel, kernel
from model.events.event_functions import NEVER
from model.events.kernels import kind_of
from model.events.table import OF_FRICTION, OF_LOAD
from model.physics.notation import STATE_SIZE, State

LONGEST_PERIOD = 8
HISTORY = 3 * LONGEST_PERIOD + 1  # periods whose states are kept
_LINEAR = 1e-3  # largest difference at which contraction counts as a property of the cycle
_NEARLY_LINEAR = 1e-2  # largest of the two differences before it
_CONTRACTION = 0.98
_SAFETY = 5.0
_LASTING = 3000.0  # assumed duration of a creep: ten times the usual horizon


@inlined_kernel
def _repeats(count, n, states, admitted):
    """Return whether no component of the state differs by more than ``admitted`` over n periods."""
    now, then = states[count % HISTORY], states[(count - n) % HISTORY]
    for i in range(STATE_SIZE):  # noqa: SIM110 - mostly the first component decides
        if not abs(now[i] - then[i]) <= admitted:
            return False
    return True


@kernel
def watched_until(count, states):
    """Return the last period in which lowest levels must be recorded, as known so far; 0 for none.

    ``settled_period`` needs those of the last n periods, and a run that settles has nearly repeated
    its motion twice before them.
    """
    last = 0
    for n in range(1, LONGEST_PERIOD + 1):
        if count <= 2 * n:
            break
        if _repeats(count, n, states, _NEARLY_LINEAR) and (
            _repeats(count - n, n, states, _NEARLY_LINEAR)
        ):
            last = count + n
    return last


@kernel
def record_state(count, y, states):
    """Store the state at the end of period ``count`` in the ring ``states``, shape (HISTORY, 6)."""
    for i in range(STATE_SIZE):
        states[count % HISTORY, i] = y[i]


@kernel
def record_closest(count, closest, lowest):
    """Store the lowest levels of the events in period ``count`` in the ring ``lowest``.

    Its shape is (LONGEST_PERIOD, events).
    """
    for which in range(closest.size):
        lowest[count % LONGEST_PERIOD, which] = closest[which]


@kernel
def _difference(count, n, states):
    """Return the difference between the states at periods ``count`` and ``count - n``."""
    now, then = states[count % HISTORY], states[(count - n) % HISTORY]
    return State(
        now[0] - then[0], now[1] - then[1], now[2] - then[2],
        now[3] - then[3], now[4] - then[4], now[5] - then[5],
    )  # fmt: skip


@kernel
def _largest(vector):
    largest = 0.0
    for each in vector:
        largest = max(largest, abs(each))
    return largest


@kernel
def _creep(d0, d1, d2):
    """Return (largest component of the creep over one cycle, ratio of the transient).

    A difference is the sum of a creep c and a transient that contracts by a ratio r. The creep
    cancels in the differences of differences, which give r by least squares, and then c (Aitken's
    Δ² process).
    """
    product, square, largest = 0.0, 0.0, 0.0
    for i in range(STATE_SIZE):
        product += (d0[i] - d1[i]) * (d1[i] - d2[i])
        square += (d1[i] - d2[i]) * (d1[i] - d2[i])
    ratio = product / square
    for i in range(STATE_SIZE):
        largest = max(largest, abs(d0[i] + (d0[i] - d1[i]) * ratio / (1.0 - ratio)))
    return largest, ratio


@kernel
def _reach(d0, d1, d2, cycles, noise):
    """Return (bounds of the further motion as a ``State``, True if the motion contracts).

    ``d0``, ``d1``, ``d2`` are the differences over one cycle, the last one first; a creep is
    assumed to last for ``cycles`` cycles.
    """
    gap, before, earlier = _largest(d0), _largest(d1), _largest(d2)
    if max(before, earlier) > _NEARLY_LINEAR:
        return d0, False
    contraction, creep = 0.0, 0.0
    if max(gap, max(before, earlier)) > noise:
        contraction = max(gap / before, before / earlier)
        creep, ratio = _creep(d0, d1, d2)
        if not (contraction <= _CONTRACTION and ratio <= _CONTRACTION):
            return d0, False
        creep = creep * cycles if creep > noise else 0.0
    rest = 1.0 - contraction
    return State(
        max(max(abs(d0.x), noise) / rest, creep),
        max(max(abs(d0.y), noise) / rest, creep),
        max(max(abs(d0.tilt), noise) / rest, creep),
        max(max(abs(d0.x_rate), noise) / rest, creep),
        max(max(abs(d0.y_rate), noise) / rest, creep),
        max(max(abs(d0.tilt_rate), noise) / rest, creep),
    ), True


@kernel
def _change(kind, r, p):
    """Return a bound of the change of a level of this kind, if the state's components change by r.

    Lengths and slips belong to points of the part at most half its diagonal from the centre. Loads
    are depths and closing rates times the base's stiffness and damping. A friction margin is the
    difference of a load and the friction force that it causes.
    """
    arm = p.half_width + p.half_height
    length = r[0] + r[1] + arm * r[2]
    rate = r[3] + r[4] + arm * r[5]
    load = p.contact_stiffness * length + p.contact_damping * rate
    if kind == OF_FRICTION:
        return 2.0 * load + length + rate
    if kind == OF_LOAD:
        return load
    return length + rate


@kernel
def _no_event_follows(events, count, n, reach, lowest, p):
    """Return whether no level of the last ``n`` periods can still move as far as zero."""
    for i in range(n):
        for which in range(events.count):
            distance = lowest[(count - i) % LONGEST_PERIOD, which]
            if distance != NEVER and _SAFETY * _change(kind_of(events, which), reach, p) > distance:
                return False
    return True


@kernel
def _shortest_period(count, n, d0, d1, states, noise):
    """Return the shortest divisor of ``n`` that may be the period of the steady state.

    A transient that turns as it decays may contract over n periods only. States of one phase of the
    cycle then differ by no more than what is left of the transient now and n periods ago; ``d0``
    and ``d1`` are the last differences over n periods.
    """
    gap, before = _largest(d0), _largest(d1)
    contraction = gap / before if before > noise else 0.0
    admitted = (max(gap, noise) + max(before, noise)) / (1.0 - contraction)
    for divisor in range(1, n):
        if n % divisor == 0 and _repeats(count, divisor, states, admitted):
            return divisor
    return n


@kernel
def settled_period(events, count, period, states, lowest, p, noise):
    """Return the period of the steady state, in excitation periods; 0 if there is none yet.

    ``count`` excitation periods of length ``period`` have passed; ``noise`` is the size of
    differences caused by the integrator's error.
    """
    for n in range(1, LONGEST_PERIOD + 1):
        if count <= 3 * n:
            break
        if not _repeats(count, n, states, _LINEAR):
            continue
        d0, d1 = _difference(count, n, states), _difference(count - n, n, states)
        d2 = _difference(count - 2 * n, n, states)
        reach, contracts = _reach(d0, d1, d2, _LASTING / (n * period), noise)
        if contracts and _no_event_follows(events, count, n, reach, lowest, p):
            return _shortest_period(count, n, d0, d1, states, noise)
    return 0
