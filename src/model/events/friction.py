"""Friction states at an instant, and removal of residual slip where contacts stick."""

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.physics.modes import STICKING, with_friction, with_slip_place
from model.physics.motion import (
    forces_without_friction,
    is_beside,
    is_supported,
    mobility,
    motion_at,
    never_sticks,
    side_contact,
    sticking_friction,
    support_contact,
    turning,
    under_friction,
)
from model.physics.notation import State

# A slip below this counts as zero: rounding of velocities of order one, with a margin.
REST_SLIP = 1e-12
# A load below NO_LOAD, or below the rounding of lengths times the stiffness of the base, counts as
# zero; the friction states are then tried a moment later.
NO_LOAD = 1e-12
_ROUNDING = 4e-16
_MOMENT = 1e-5


@kernel
def _friction_holds(slip_state, friction, load, drive, p):
    """Return whether a friction state at zero slip agrees with its forces and slip acceleration.

    ``drive`` is the slip acceleration in this state.
    """
    if slip_state == STICKING:
        return load > 0.0 and abs(friction) <= p.friction * load
    return drive * slip_state >= 0.0


@kernel
def _may_begin(slip_state, friction, drive, least):
    """Return whether an unloaded contact at rest may start in a friction state.

    ``drive`` is the slip acceleration without friction, and ``least`` the load that counts as zero.
    A state that slides against ``drive`` would end and begin again at once.
    """
    if slip_state == STICKING:
        return abs(friction) <= least
    return drive * slip_state >= 0.0


@kernel
def sign(value):
    """Return -1 for a negative value, else 1."""
    return -1 if value < 0.0 else 1


@kernel
def _advanced(q, at):
    """State a moment later, under the accelerations of ``at``."""
    return State(
        q.x + _MOMENT * (q.x_rate + 0.5 * _MOMENT * at.x),
        q.y + _MOMENT * (q.y_rate + 0.5 * _MOMENT * at.y),
        q.tilt + _MOMENT * (q.tilt_rate + 0.5 * _MOMENT * at.tilt),
        q.x_rate + _MOMENT * at.x,
        q.y_rate + _MOMENT * at.y,
        q.tilt_rate + _MOMENT * at.tilt,
    )


@separate_kernel
def decide_friction(time, q, p, mode, support_at_rest, side_at_rest):
    """Return (mode, possible): the mode with consistent friction states, if there are any.

    A contact that slips keeps the sign of its slip. For a contact at rest every state is tried,
    sticking first; the first combination that is consistent with its own accelerations holds. If a
    contact at rest carries no load yet, its forces at this instant decide nothing: its states are
    tried on the motion a moment later, and against the drives without friction.
    """
    mode = with_slip_place(mode)
    if never_sticks(p):
        return with_friction(mode, -1, -1), True
    forces = forces_without_friction(time, q, p, mode)
    now = under_friction(forces, p, mode)
    supported = is_supported(mode)
    beside = is_beside(mode)
    support_at_rest = supported and (support_at_rest or abs(now.support_slip) <= REST_SLIP)
    side_at_rest = beside and (side_at_rest or abs(now.side_slip) <= REST_SLIP)
    lengths = p.half_width + p.half_height + abs(q.x) + abs(q.y)
    least = NO_LOAD + _ROUNDING * p.contact_stiffness * lengths
    support_unloaded = support_at_rest and now.support_load <= least
    side_unloaded = side_at_rest and now.side_load <= least
    no_load = support_unloaded or side_unloaded
    begins = now  # the motion as unloaded contacts begin to slip, and so without friction
    if no_load:
        support_begins = -1 if support_at_rest else sign(now.support_slip)
        side_begins = -1 if side_at_rest else sign(now.side_slip)
        begins = under_friction(forces, p, with_friction(mode, support_begins, side_begins))
    for i in range(3 if support_at_rest else 1):
        support = (STICKING, -1, 1)[i] if support_at_rest else sign(now.support_slip)
        for j in range(3 if side_at_rest else 1):
            side = (STICKING, -1, 1)[j] if side_at_rest else sign(now.side_slip)
            trial = with_friction(mode, support, side)
            at = under_friction(forces, p, trial)
            holds = True
            if support_unloaded:
                holds = _may_begin(support, at.support_friction, begins.support_drive, least)
            if side_unloaded:
                holds = holds and _may_begin(side, at.side_friction, begins.side_drive, least)
            if no_load:
                at = motion_at(time + _MOMENT, _advanced(q, at), p, trial)
            if support_at_rest:
                holds = holds and _friction_holds(
                    support, at.support_friction, at.support_load, at.support_drive, p
                )
            if side_at_rest:
                holds = holds and _friction_holds(
                    side, at.side_friction, at.side_load, at.side_drive, p
                )
            if holds:
                return trial, True
    if no_load and support_unloaded == support_at_rest and side_unloaded == side_at_rest:
        support = sign(begins.support_drive if support_at_rest else now.support_slip)
        side = sign(begins.side_drive if side_at_rest else now.side_slip)
        return with_friction(mode, support, side), True
    return mode, False


@inlined_kernel
def sticking(mode):
    """Return whether the support sticks, and whether the side does."""
    support_sticks = is_supported(mode) and mode.support_slip == STICKING
    return support_sticks, is_beside(mode) and mode.side_slip == STICKING


@inlined_kernel
def without_slip(q, p, mode):
    """Return ``q`` with the slip of sticking contacts removed by friction impulses."""
    support_sticks, side_sticks = sticking(mode)
    if not (support_sticks or side_sticks):
        return q
    support, side = support_contact(q, p, mode), side_contact(q, p, mode)
    t, u = support.tangent, side.tangent
    impulse, side_impulse = sticking_friction(
        support_sticks, side_sticks, support.slip, side.slip,
        mobility(support.slip_row, t, p), mobility(support.slip_row, u, p),
        mobility(side.slip_row, t, p), mobility(side.slip_row, u, p),
    )  # fmt: skip
    return State(
        q.x, q.y, q.tilt,
        q.x_rate + impulse * t[0] + side_impulse * u[0],
        q.y_rate + impulse * t[1] + side_impulse * u[1],
        q.tilt_rate + turning(impulse * t[2] + side_impulse * u[2], p),
    )  # fmt: skip


@separate_kernel
def _without_slip_at(q, p, mode):
    return without_slip(q, p, mode)


@inlined_kernel
def hold_sticking(q, p, mode):
    """Return ``without_slip``, by a call if a contact sticks: for code that runs once a step."""
    support_sticks, side_sticks = sticking(mode)
    return _without_slip_at(q, p, mode) if support_sticks or side_sticks else q


@inlined_kernel
def at_rest_on_support(q, p, mode):
    """Return ``q`` with exactly zero slip at a sliding support that has come to rest.

    An event is located to the accuracy of a step; the residual slip would contradict the friction
    state chosen at rest.
    """
    if mode.support_slip != STICKING:
        return hold_sticking(q, p, with_friction(mode, STICKING, mode.side_slip))
    return q


@inlined_kernel
def at_rest_on_side(q, p, mode):
    """Return ``q`` with exactly zero slip at a sliding side face that has come to rest."""
    if mode.side_slip != STICKING:
        return hold_sticking(q, p, with_friction(mode, mode.support_slip, STICKING))
    return q
