"""The equations of motion (3): in every mode, accelerations as a sum of named forces."""

from math import sqrt
from typing import NamedTuple

from model.compile.kernels import inlined_kernel, operation, separate_kernel
from model.physics.contacts import (
    contact_load,
    corner_on_flat,
    corner_on_wall,
    dot,
    edge_on_side,
    support_on_face,
)
from model.physics.forces import applied_forces
from model.physics.modes import CLOSED, STICKING
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

NO_ROW = (0.0, 0.0, 0.0)


class Support(NamedTuple):
    """The contacts of one group, support or side (see ``Mode``), taken together.

    ``load`` is the sum of the normal forces and ``x``, ``y``, ``moment`` their share of (3);
    ``tangent`` is the row of the common friction force, and the rest as in ``Contact``.
    """

    load: float
    x: float
    y: float
    moment: float
    tangent: tuple[float, float, float]
    slip: float
    slip_row: tuple[float, float, float]
    slip_drift: float


class Forces(NamedTuple):
    """Resultants of all forces but friction, and the contacts where friction may act."""

    x: float
    y: float
    moment: float
    support: Support
    side: Support


class Motion(NamedTuple):
    """Accelerations and contact forces at one instant.

    ``support_drive`` and ``side_drive`` are d slip / dτ. ``support_mobility`` and ``side_mobility``
    are the slip acceleration from a unit friction force; friction has a solution if positive.
    """

    x: float
    y: float
    tilt: float
    support_load: float
    support_friction: float
    support_slip: float
    support_drive: float
    support_mobility: float
    side_load: float
    side_friction: float
    side_slip: float
    side_drive: float
    side_mobility: float


NO_CONTACT = Support(0.0, 0.0, 0.0, 0.0, NO_ROW, 0.0, NO_ROW, 0.0)


@inlined_kernel
def _pressing(contact, load):
    """Return the ``Support`` by one contact."""
    normal = contact.normal
    return Support(
        load, load * normal[0], load * normal[1], load * normal[2],
        contact.tangent, contact.slip, contact.slip_row, contact.slip_drift,
    )  # fmt: skip


@operation
def corner_share(load, load_of_edge):
    """Return the share in the friction of a corner that presses, perhaps beside an edge."""
    total = load_of_edge + load
    return load / total if load_of_edge > 0.0 and total > 0.0 else 1.0


@inlined_kernel
def _with_corner(edge, corner, corner_load, slip_at_corner):
    """Return the ``Support`` by an edge and a corner on the same side.

    If both press, they share the friction in proportion to their normal forces.
    """
    normal, tangent = corner.normal, edge.tangent
    share = corner_share(corner_load, edge.load)
    tangent = (
        tangent[0] + share * (corner.tangent[0] - tangent[0]),
        tangent[1] + share * (corner.tangent[1] - tangent[1]),
        tangent[2] + share * (corner.tangent[2] - tangent[2]),
    )
    slip, slip_row, drift = edge.slip, edge.slip_row, edge.slip_drift
    if slip_at_corner:
        slip, slip_row, drift = corner.slip, corner.slip_row, corner.slip_drift
    return Support(
        edge.load + corner_load, edge.x + corner_load * normal[0], edge.y + corner_load * normal[1],
        edge.moment + corner_load * normal[2], tangent, slip, slip_row, drift,
    )  # fmt: skip


@inlined_kernel
def _beside(side, edge_state, corner_state, slip_at_corner, q, p):
    """Return the contacts of one side: its edge on the side face, its corner on the wall."""
    found = NO_CONTACT
    if edge_state == CLOSED:
        edge = edge_on_side(side, q, p)
        found = _pressing(edge, contact_load(edge.depth, edge.closing_rate, q, p))
    if corner_state == CLOSED:
        corner = corner_on_wall(side, q, p)
        corner_load = contact_load(corner.depth, corner.closing_rate, q, p)
        found = _with_corner(found, corner, corner_load, slip_at_corner)
    return found


@inlined_kernel
def support_contact(q, p, mode):
    """Return the support: an edge on the bottom face and its corner on the flat base.

    In the slot, A1 on the right side face and B1 on the right wall.
    """
    if mode.in_slot:
        return _beside(RIGHT_EDGE, mode.face, mode.corner, mode.slip_at_corner, q, p)
    support = NO_CONTACT
    if mode.face == CLOSED:
        face = support_on_face(mode.edge, q, p)
        support = _pressing(face, contact_load(face.depth, face.closing_rate, q, p))
    if mode.corner == CLOSED:
        corner = corner_on_flat(mode.edge, q, p)
        corner_load = contact_load(corner.depth - mode.corner_offset, corner.closing_rate, q, p)
        support = _with_corner(support, corner, corner_load, mode.slip_at_corner)
    return support


@inlined_kernel
def side_contact(q, p, mode):
    """Return the left side: A2 on the side face, and in the slot B2 on the wall."""
    return _beside(LEFT_EDGE, mode.side, mode.wall, mode.slip_at_wall, q, p)


@inlined_kernel
def is_supported(mode):
    """Return True if the supporting edge or its corner presses."""
    return mode.face == CLOSED or mode.corner == CLOSED


@inlined_kernel
def is_beside(mode):
    """Return True if a contact on the left side presses."""
    return mode.side == CLOSED or mode.wall == CLOSED


@inlined_kernel
def contact_rate(p, mode):
    """Return an upper bound of the rate at which contacts oscillate or, overdamped, come to rest.

    It is the larger of √(k_a m) and h_a m, where m is the sum of 1 + r²/I over support and side, if
    they press: at the arm r of its normal, a contact moves the part like a mass 1 / (1 + r²/I).
    """
    width, height = p.half_width * p.half_width, p.half_height * p.half_height
    mobility = 0.0
    if is_supported(mode):
        below = width + height if p.is_round else width
        mobility += 1.0 + (height if mode.in_slot else below) / p.inertia
    if is_beside(mode):
        mobility += 1.0 + height / p.inertia
    return max(sqrt(p.contact_stiffness * mobility), p.contact_damping * mobility)


@inlined_kernel
def largest_rate(p, mode):
    """Return an estimate of the part's fastest oscillation: of its contacts or its springs."""
    springs = max(max(1.0, p.lateral_stiffness), p.tilt_stiffness / p.inertia)
    return max(sqrt(springs), contact_rate(p, mode))


@inlined_kernel
def never_sticks(p):
    """Return True if the friction state never changes: printed friction (R2), or none."""
    return p.printed_friction_law != 0.0 or p.friction == 0.0


@inlined_kernel
def turning(moment, p):
    """Return φ̈ = moment / I_φ, by the reciprocal of I_φ: a division that all calls share."""
    return moment * (1.0 / p.inertia)


@inlined_kernel
def mobility(slip_row, tangent, p):
    """Return the slip acceleration along ``slip_row`` from a unit friction force on ``tangent``."""
    return dot(slip_row, tangent[0], tangent[1], turning(tangent[2], p))


@inlined_kernel
def sticking_friction(support_sticks, side_sticks, drive, side_drive, g11, g12, g21, g22):
    """Return the friction forces (T, T_side) that cancel slip accelerations of sticking contacts.

    Solves G T = -drive with the matrix G of mobilities; zero where a contact does not stick. With
    slip velocities as drives it gives impulses.
    """
    top, side_top, bottom, side_bottom = -drive, -side_drive, g11, g22
    if support_sticks and side_sticks:
        top, side_top = g12 * side_drive - g22 * drive, g21 * drive - g11 * side_drive
        bottom = side_bottom = g11 * g22 - g12 * g21
    return (
        top / bottom if support_sticks else 0.0,
        side_top / side_bottom if side_sticks else 0.0,
    )


@inlined_kernel
def forces_without_friction(time, q, p, mode):
    """Return ``Forces`` in state ``q`` at ``time``: equations (3) without friction."""
    applied = applied_forces(time, q, p)
    support = support_contact(q, p, mode)
    side = side_contact(q, p, mode)
    return Forces(
        applied.x + support.x + side.x,
        applied.y + support.y + side.y,
        applied.moment + support.moment + side.moment,
        support,
        side,
    )


@inlined_kernel
def under_friction(forces, p, mode):
    """Return ``Motion`` under these forces and the friction of ``mode``.

    Sliding friction is T = -μ n sign(slip); sticking friction keeps the slip at zero. Loads are not
    clamped here: an event ends the mode where a load turns negative.
    """
    x, y, moment, support, side = forces
    support_sticks = mode.support_slip == STICKING and is_supported(mode)
    side_sticks = mode.side_slip == STICKING and is_beside(mode)
    # Sliding friction first: sticking friction balances everything else.
    friction = -p.friction * support.load * mode.support_slip
    side_friction = -p.friction * side.load * mode.side_slip
    t, u = support.tangent, side.tangent
    x += friction * t[0] + side_friction * u[0]
    y += friction * t[1] + side_friction * u[1]
    moment += friction * t[2] + side_friction * u[2]

    g11 = mobility(support.slip_row, t, p)
    g12 = mobility(support.slip_row, u, p)
    g21 = mobility(side.slip_row, t, p)
    g22 = mobility(side.slip_row, u, p)
    drive = dot(support.slip_row, x, y, turning(moment, p)) + support.slip_drift
    side_drive = dot(side.slip_row, x, y, turning(moment, p)) + side.slip_drift
    if support_sticks or side_sticks:
        stick, side_stick = sticking_friction(
            support_sticks, side_sticks, drive, side_drive, g11, g12, g21, g22
        )
        x += stick * t[0] + side_stick * u[0]
        y += stick * t[1] + side_stick * u[1]
        moment += stick * t[2] + side_stick * u[2]
        drive += g11 * stick + g12 * side_stick
        side_drive += g21 * stick + g22 * side_stick
        friction += stick
        side_friction += side_stick
    return Motion(
        x, y, turning(moment, p),
        support.load, friction, support.slip, drive, g11,
        side.load, side_friction, side.slip, side_drive, g22,
    )  # fmt: skip


@inlined_kernel
def motion(time, q, p, mode):
    """Return ``Motion`` in state ``q`` at ``time``: equations (3) in ``mode``, a sum of forces."""
    return under_friction(forces_without_friction(time, q, p, mode), p, mode)


@separate_kernel
def motion_at(time, q, p, mode):
    """Return ``motion`` by a call: for code that runs once an event, so that it stays small."""
    return motion(time, q, p, mode)
