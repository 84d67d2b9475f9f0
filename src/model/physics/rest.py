"""Rest of the part on A1, or on tips, under a press that rises slowly, with dry friction.

Pressed slowly, the part passes through equilibria. In the coordinates s (of A1 along the bottom
face), d (depth) and φ the mass centre is C = A1 - s e_t + (b - d) e_n, and with the force F and the
moment M_φ of the suspension equilibrium asks for

    n = k_a d = -F·e_n,   T = -F·e_t,   s n + (b - d) T + M_φ = 0.

A round part rests on its tips, with their place ξ along the face as s, and X for l. While
|T| <= μ n the contact sticks and s stays; beyond, it slides until |T| = μ n. The load rises from
0 to its full value in steps, which are halved where no equilibrium is found. A fold, where the
equilibrium ceases to be stable, ends the path: the part topples or slides off. To first order, and
as long as the edge sticks,

    φ = f0 s / (k_φ + s² + k_x b² - f0 b)       (φ_st = 0, x_st = x(0), y_st = b).
"""

from math import isfinite, sqrt
from typing import NamedTuple

from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.physics.contacts import support_on_face
from model.physics.forces import applied_forces, excitation
from model.physics.geometry import edge_place, first_touch, place_on_rim
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.trigonometry import sine_cosine

_LONGEST_STEP = 1.0 / 16.0  # of the full load
_SHORTEST_STEP = 1e-4  # of the full load: the accuracy of the load at a fold
_LARGEST_TURN = 0.05  # change of the tilt in one step, rad
_ITERATIONS = 30
_RESOLUTION = 1e-13  # of the equilibrium, in units of the forces and moments that balance
_DIFFERENCE = 1e-7  # for derivatives


class Rest(NamedTuple):
    """Pose of a part that has been pressed slowly; all rates are zero.

    Attributes:
        x, y, tilt: mass centre and tilt; of the last equilibrium if the part finds no rest.
        found: True if the part rests on A1 alone under the full load.
    """

    x: float
    y: float
    tilt: float
    found: bool


class _Balance(NamedTuple):
    """Contact forces that equilibrium requires at one place and tilt, and the residual moment."""

    load: float
    friction: float
    moment: float
    scale: float  # of the moment
    x: float
    y: float


@kernel
def _suspension(x, y, tilt, share, first, p):
    """(x, y, moment) of the forces without contact, excitation excluded.

    Of ``first``, the axial force at the first touch, only the part ``share`` acts.
    """
    force = applied_forces(0.0, State(x, y, tilt, 0.0, 0.0, 0.0), p)
    return force.x, force.y - excitation(0.0, p) - (1.0 - share) * first, force.moment


@inlined_kernel
def _placed(s, depth, tilt, p):
    """(x, y) of the mass centre with the contact at ``s`` of the bottom face, at a depth."""
    sine, cosine = sine_cosine(tilt)
    x, behind = p.slot_half_width, depth
    if p.is_round:
        x = place_on_rim(s, p)
        offset, across = x * cosine - s, p.slot_half_width * sine
        behind = depth * sqrt(offset * offset + across * across) / (x - cosine * s)
    up = p.half_height - behind
    return x - s * cosine - up * sine, -s * sine + up * cosine


@kernel
def _required(s, depth, tilt, share, first, p):
    """(load, friction, moment, scale, x, y) with which the contact balances the suspension."""
    x, y = _placed(s, depth, tilt, p)
    fx, fy, moment = _suspension(x, y, tilt, share, first, p)
    contact = support_on_face(RIGHT_EDGE, State(x, y, tilt, 0.0, 0.0, 0.0), p)
    normal, tangent = contact.normal, contact.tangent
    size = normal[0] * tangent[1] - normal[1] * tangent[0]
    load = (tangent[0] * fy - tangent[1] * fx) / size
    friction = (normal[1] * fx - normal[0] * fy) / size
    turning, sliding = load * normal[2], friction * tangent[2]
    scale = 1.0 + abs(turning) + abs(sliding) + abs(moment)
    return _Balance(load, friction, turning + sliding + moment, scale, x, y)


@kernel
def _balance(s, tilt, share, first, p):
    """``_Balance`` with the contact at ``s`` of the face; the depth follows from its load.

    The load is linear in the depth at an edge, and nearly so at tips: two steps of Newton's method.
    """
    depth, h = 0.0, 1e-3
    for _ in range(2):
        load = _required(s, depth, tilt, share, first, p).load
        slope = (_required(s, depth + h, tilt, share, first, p).load - load) / h
        depth += (load - p.contact_stiffness * depth) / (p.contact_stiffness - slope)
    return _required(s, depth, tilt, share, first, p)


@kernel
def _slides_by(at, direction, p):
    """Excess of the required friction over its limit; ``direction`` is the sign of the friction."""
    return at.friction - direction * p.friction * at.load


@kernel
def _sticking(s, tilt, share, first, p):
    """(tilt, stable): equilibrium with A1 held at ``s``, by Newton's iteration from ``tilt``."""
    start = tilt
    for _ in range(_ITERATIONS):
        at = _balance(s, tilt, share, first, p)
        beyond = _balance(s, tilt + _DIFFERENCE, share, first, p)
        slope = (beyond.moment - at.moment) / _DIFFERENCE
        if not slope < 0.0 or not abs(tilt - start) < _LARGEST_TURN:
            return tilt, False
        tilt -= at.moment / slope
        if abs(at.moment) <= _RESOLUTION * at.scale:
            return tilt, True
    return tilt, False


@kernel
def _sliding(s, tilt, direction, share, first, p):
    """(s, tilt, stable): equilibrium at the limit of friction, by Newton's iteration."""
    start, h = tilt, _DIFFERENCE
    for _ in range(_ITERATIONS):
        at = _balance(s, tilt, share, first, p)
        turned = _balance(s, tilt + h, share, first, p)
        moved = _balance(s + h, tilt, share, first, p)
        slip = _slides_by(at, direction, p)
        m_tilt, m_s = (turned.moment - at.moment) / h, (moved.moment - at.moment) / h
        g_tilt = (_slides_by(turned, direction, p) - slip) / h
        g_s = (_slides_by(moved, direction, p) - slip) / h
        # Stable if the moment falls with the tilt, and the excess of friction with the slide.
        determinant = m_tilt * g_s - m_s * g_tilt
        if not (m_tilt < 0.0 and determinant > 0.0) or not abs(tilt - start) < _LARGEST_TURN:
            return s, tilt, False
        tilt -= (at.moment * g_s - slip * m_s) / determinant
        s -= (slip * m_tilt - at.moment * g_tilt) / determinant
        if abs(at.moment) + abs(slip) <= _RESOLUTION * at.scale:
            return s, tilt, abs(s) < p.half_width
    return s, tilt, False


@kernel
def _loaded(s, tilt, share, first, p):
    """(s, tilt, stable) under a ``share`` of the load, from the equilibrium under a smaller one."""
    held, stable = _sticking(s, tilt, share, first, p)
    if stable:
        at = _balance(s, held, share, first, p)
        if abs(at.friction) <= p.friction * at.load:
            return s, held, True
        direction = 1.0 if at.friction > 0.0 else -1.0
        return _sliding(s, tilt, direction, share, first, p)
    return s, tilt, False


@separate_kernel
def rest_under_press(p):
    """Return the ``Rest`` of a part that is pressed slowly, from x(0) and the tilt φ_st on.

    Consistent variants only. The excitation does not act.
    """
    tilt = p.rest_tilt
    s = first_touch(tilt, p)
    _, y = _placed(s, 0.0, tilt, p)  # without load
    _, first, _ = _suspension(p.misalignment, y, tilt, 1.0, 0.0, p)
    share, step, rests = 0.0, _LONGEST_STEP, abs(s) < p.half_width
    while rests and share < 1.0:
        step = min(step, 1.0 - share)
        share_then = 1.0 if step == 1.0 - share else share + step
        s_then, tilt_then, rests = _loaded(s, tilt, share_then, first, p)
        if rests:
            share, s, tilt = share_then, s_then, tilt_then
            step = min(2.0 * step, _LONGEST_STEP)
        elif step > _SHORTEST_STEP:
            step, rests = 0.5 * step, True
    at = _balance(s, tilt, share, first, p)
    beside = edge_place(LEFT_EDGE, at.x, at.y, tilt, p).along_face + p.half_width
    found = rests and at.load > 0.0 and tilt > 0.0 and beside <= 0.0 and isfinite(tilt)
    return Rest(at.x, at.y, tilt, found)
