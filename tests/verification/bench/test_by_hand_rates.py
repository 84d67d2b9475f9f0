"""The right-hand side without modes is that of each mode, and the order of fixed steps."""

from math import cos, sin, tan

import numpy as np
import pytest

from model.compile.entries import compiled
from model.events.event_functions import edge_inside
from model.events.sources import corner_positions
from model.physics.contacts import contact_load, corner_on_flat, edge_on_face, edge_on_side
from model.physics.geometry import bottom_corner
from model.physics.modes import (
    CLOSED,
    OPEN,
    RELEASED,
    START,
)
from model.physics.motion import motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from verification.bench.methods import by_hand
from verification.bench.methods.by_hand import state_of
from vibralign import Variants

ROUNDING = 1e-12  # relative to 1 + the largest acceleration; loads are of order 10
STATES = 40  # of each kind


@pytest.fixture(scope="module", params=["consistent", "printed"])
def p(request, device, constants):
    return constants(device, getattr(Variants, request.param)())


def rates(time, y, p):
    out = np.empty(6)
    by_hand.write_rates(np.array([time, *y]), np.array(p), out)
    return out


def outside(y, p):
    return by_hand.outside_of(np.array([0.0, *y]), np.array(p))


# --------------------------------------------------------------------- the modes that a state is in


def standing(edge, along_face, depth, tilt, p):
    """(x, y) of the mass centre with an edge at s = ``along_face``, ``depth`` inside the face."""
    along_axis = depth - p.half_height
    c, s = cos(tilt), sin(tilt)
    r_x, r_y = along_face * c - along_axis * s, along_face * s + along_axis * c
    return edge * p.slot_half_width - r_x, -r_y


def placed(kind, random, p):
    """Position and tilt of a random state in which the contacts of ``kind`` overlap the base."""
    a = p.half_width
    depth, tilt = random.uniform(0.001, 0.1), random.uniform(0.05, 0.3)
    if kind == "flight":
        x, y = standing(RIGHT_EDGE, random.uniform(-0.5, 0.5) * a, -depth, tilt, p)
    elif kind == "right_face":
        x, y = standing(RIGHT_EDGE, random.uniform(-0.5, 0.95) * a, depth, tilt, p)
    elif kind == "left_side":  # B2 in the slot, beyond its wall by the reading's own measure
        tilt, height = -tilt, -random.uniform(0.2, 0.5)
        lean = height if p.printed_side_gap != 0.0 else height * tan(-tilt)
        wall = lean - p.slot_half_width
        corner_x, corner_y = bottom_corner(LEFT_EDGE, 0.0, 0.0, tilt, p)
        x, y = wall - depth - corner_x, height - corner_y
    elif kind == "left_face":
        tilt = -tilt
        x, y = standing(LEFT_EDGE, random.uniform(-0.5, 0.5) * a, depth, tilt, p)
    elif kind == "right_corner":  # A1 off the face, above it
        tilt = -tilt
        x = p.slot_half_width + random.uniform(0.05, 0.3) - a * cos(tilt)
        y = 0.0
        y -= bottom_corner(RIGHT_EDGE, x, y, tilt, p)[1] + 0.02 * depth
    else:  # right_face_and_corner
        tilt = -0.2 * tilt
        x, y = standing(RIGHT_EDGE, random.uniform(-0.5, 0.5) * a, depth, tilt, p)
    return x, y, tilt


def overlaps(y, p):
    """Return the contacts that overlap the base, from the geometry."""
    q = state_of(y)
    found = set()
    right, left = (edge_inside(edge, corner_positions(q, p), p) for edge in (RIGHT_EDGE, LEFT_EDGE))
    if min(right) > 0.0:
        found.add("right_face")
    if min(left) > 0.0:
        found.add("left_face" if left[0] <= left[1] else "left_side")
    for name, edge in (("right_corner", RIGHT_EDGE), ("left_corner", LEFT_EDGE)):
        x, height = bottom_corner(edge, q.x, q.y, q.tilt, p)
        if height < 0.0 and edge * x > p.slot_half_width and edge * q.tilt < 0.0:
            found.add(name)
    return found


def slip_state(slip, p):
    return -1 if p.printed_friction_law != 0.0 or slip < 0.0 else 1


def located_mode(kinds, y, p):
    """Return the mode of a state in the located solver, or None if it has none."""
    q = state_of(y)
    mode = START._replace(face=OPEN)
    slips = []
    if "right_face" in kinds or "left_face" in kinds:
        edge = RIGHT_EDGE if "right_face" in kinds else LEFT_EDGE
        contact = edge_on_face(edge, q, p)
        pulls = contact_load(contact.depth, contact.closing_rate, q, p) <= 0.0
        mode = mode._replace(edge=edge, face=RELEASED if pulls else CLOSED)
        slips += [] if pulls else [contact.slip]
    if "right_corner" in kinds:
        contact = corner_on_flat(RIGHT_EDGE, q, p)
        # The corner has begun to press where the tilt changed sign: as deep as the edge then was.
        offset = (
            edge_inside(RIGHT_EDGE, corner_positions(q, p), p)[0] if "right_face" in kinds else 0.0
        )
        pulls = contact_load(contact.depth - offset, contact.closing_rate, q, p) <= 0.0
        mode = mode._replace(
            edge=RIGHT_EDGE, corner=RELEASED if pulls else CLOSED, corner_offset=offset,
            slip_at_corner=mode.face != CLOSED,
        )  # fmt: skip
        slips += [] if pulls else [contact.slip]
    if len({slip_state(slip, p) for slip in slips}) > 1:
        return None  # edge and corner slip apart: the mode has one friction state for both
    if slips:
        mode = mode._replace(support_slip=slip_state(slips[0], p))
    if "left_side" in kinds:
        contact = edge_on_side(LEFT_EDGE, q, p)
        pulls = contact_load(contact.depth, contact.closing_rate, q, p) <= 0.0
        mode = mode._replace(
            side=RELEASED if pulls else CLOSED, side_slip=slip_state(contact.slip, p)
        )
    return mode


KINDS = {
    "flight": set(),
    "right_face": {"right_face"},
    "left_side": {"left_side"},
    "left_face": {"left_face"},
    "right_corner": {"right_corner"},
    "right_face_and_corner": {"right_face", "right_corner"},
}


@pytest.mark.parametrize("kind", KINDS)
def test_in_each_mode_the_right_hand_side_is_that_of_the_mode(kind, p):
    random = np.random.default_rng(7)
    pressed = released = compared = 0
    for _ in range(100 * STATES):
        x, y, tilt = placed(kind, random, p)
        state = np.array([x, y, tilt, *random.uniform(-0.5, 0.5, 3)])
        if overlaps(state, p) != KINDS[kind]:
            continue
        mode = located_mode(KINDS[kind], state, p)
        if mode is None:
            continue
        time = random.uniform(0.0, 10.0)
        at = motion(time, state_of(state), p, mode)
        expected = np.array([*state[3:], at.x, at.y, at.tilt])
        scale = 1.0 + np.abs(expected).max()
        np.testing.assert_allclose(rates(time, state, p), expected, rtol=0, atol=ROUNDING * scale)
        states = (mode.face, mode.corner, mode.side)
        pressed, released = pressed + (CLOSED in states), released + (RELEASED in states)
        compared += 1
        if compared == STATES:
            break
    assert compared == STATES
    assert kind == "flight" or min(pressed, released) > 0, "both n > 0 and n = 0 are compared"


def test_at_rest_there_is_no_friction(device, constants):
    p = constants(device)
    y = np.array([*standing(RIGHT_EDGE, 0.9, 0.05, 0.0, p), 0.0, 0.0, 0.0, 0.0])
    frictionless = constants(device.replace(friction=0.0))
    np.testing.assert_array_equal(rates(0.0, y, p), rates(0.0, y, frictionless))
    moving = y + [0, 0, 0, 1e-9, 0, 0]
    assert rates(0.0, moving, p)[3] < rates(0.0, y, p)[3] - 0.1


def test_outside_falls_through_zero_with_the_criterion_in_force(device, constants):
    aligned = Variants()
    p = constants(device, aligned)
    before = np.array([*standing(RIGHT_EDGE, p.half_width - 1e-3, 0.02, 0.1, p), 0.1, 0, 0, 0])
    after = np.array([*standing(RIGHT_EDGE, p.half_width + 1e-3, 0.02, 0.1, p), 0.1, 0, 0, 0])
    assert outside(before, p) > 0.0
    assert outside(after, p) < 0.0
    printed = constants(device, Variants(alignment_criterion="printed"))
    assert outside(after, printed) > 0.0, "B1 has not passed the edge yet"


# ----------------------------------------------------------------------------------- order of steps

HALVINGS = 6
rates_at, rk4_step, euler_step = map(
    compiled, (by_hand.rates, by_hand.rk4_step, by_hand.euler_step)
)


def integrated(scheme, p, count):
    """The state at τ = 0.2 after ``count`` equal steps, sliding on A1 and pressed all the way."""
    q = state_of(np.array([*standing(RIGHT_EDGE, 0.5, 0.05, 0.1, p), 0.1, -0.5, 0.0, 0.0]))
    h = 0.2 / count
    for i in range(count):
        k1 = rates_at(i * h, q, p)
        q = rk4_step(i * h, h, q, k1, p) if scheme == "rk4" else euler_step(h, q, k1)
        assert overlaps(np.array(q), p) == {"right_face"}, "the stretch is smooth"
        contact = edge_on_face(RIGHT_EDGE, q, p)
        assert contact.slip < -0.1
        assert contact_load(contact.depth, contact.closing_rate, q, p) > 0.1
    return np.array(q)


@pytest.mark.parametrize(("scheme", "order"), [("rk4", 4), ("semi_implicit_euler", 1)])
def test_order_on_a_smooth_stretch(scheme, order, device, constants):
    p = constants(device)
    counts = [8 * 2**i for i in range(HALVINGS)]
    true = integrated("rk4", p, 2048)
    errors = [np.abs(integrated(scheme, p, count) - true).max() for count in counts]
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, rel=0.05)
