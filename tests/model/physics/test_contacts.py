"""The printed variants of the contacts, letter by letter as in the paper.

The part is taken as a rigid body with corners; rates are central differences along a motion. The
consistent contacts are compared in test_motion.py.
"""

from math import cos, hypot, sin, tan

import numpy as np
import pytest

from model.physics.contacts import contact_load, edge_on_face, edge_on_side
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from vibralign import Variants

STEP = 1e-5
# Central differences: h²/6 times a third derivative of order 10, plus 1e-15/h from rounding.
DIFFERENCE = 3e-9
ROUNDING = 1e-13


@pytest.fixture(scope="module")
def p(device, constants):
    return constants(device)


class Part:
    """The part in one pose, as points."""

    def __init__(self, pose, p):
        x, y, tilt = pose[:3]
        self.centre = np.array([x, y])
        self.turn = np.array([[cos(tilt), -sin(tilt)], [sin(tilt), cos(tilt)]])
        a, b, length = p.half_width, p.half_height, p.slot_half_width
        self.b1, self.b2, self.d2 = (self.place(point) for point in ([a, -b], [-a, -b], [-a, b]))
        self.edges = {RIGHT_EDGE: np.array([length, 0.0]), LEFT_EDGE: np.array([-length, 0.0])}

    def place(self, own):
        """Position of the point ``own``, which is fixed in the part."""
        return self.centre + self.turn @ np.asarray(own)

    def own(self, point):
        """Coordinates in the part of the point at ``point``."""
        return self.turn.T @ (point - self.centre)


def side_depth(pose, p):
    """Distance of A2 to the left of the way from D2 down to B2."""
    part = Part(pose, p)
    (u_x, u_y), (v_x, v_y) = part.b2 - part.d2, part.edges[LEFT_EDGE] - part.d2
    return (u_x * v_y - u_y * v_x) / hypot(u_x, u_y)


def along(state, time):
    """Pose after ``time`` with the rates of ``state`` and no accelerations."""
    return np.asarray(state[:3]) + time * np.asarray(state[3:])


def slip_on_face(state, p):
    """Velocity along the bottom face of the part's point at A2, by following it."""
    part = Part(state, p)
    own = part.own(part.edges[LEFT_EDGE])
    ahead, behind = (Part(along(state, time), p).place(own) for time in (STEP, -STEP))
    return (ahead - behind) / (2 * STEP) @ part.turn[:, 0]


def test_printed_load_is_damped_by_the_centres_speed(device, constants):
    changed = device.replace(contact_stiffness=50.0, contact_damping=4.0)
    p = constants(changed, Variants(contact_damping_law="printed"))
    q = State(0.0, 0.0, 0.0, 3.0, 4.0, 9.0)  # speed 5, whatever the closing rate
    for closing_rate in (0.25, -0.25):
        assert contact_load(2.0, closing_rate, q, p) == pytest.approx(100.0 - 20.0, rel=ROUNDING)


def printed_d1(part):
    x_a, y_a = part.edges[RIGHT_EDGE]
    (x1, y1), (x2, y2) = part.b1, part.b2
    bracket = x_a * (y2 - y1) + y_a * (x1 - x2) + y1 * (x2 - x1) + x1 * (y1 - y2)
    return -bracket / np.sqrt((y2 - y1) ** 2 + (x2 - x1) ** 2)


def printed_d2(part):
    x_a, y_a = part.edges[LEFT_EDGE]
    (x_b, y_b), (x_d, y_d) = part.b2, part.d2
    bracket = x_a * (y_d - y_b) + y_a * (y_d - y_b) + x_b * (y_b - y_d) + y_b * (y_d - y_b)
    return -bracket / np.sqrt((y_d - y_b) ** 2 + (x_d - x_b) ** 2)


def test_printed_d1_is_the_depth_with_the_other_sign(p, random_states):
    for state in random_states(20):
        depth = edge_on_face(RIGHT_EDGE, State(*state), p).depth
        assert depth == pytest.approx(-printed_d1(Part(state, p)), abs=ROUNDING)


def test_printed_d2_is_the_side_gap_as_printed_and_no_distance(device, constants, random_states):
    p = constants(device, Variants(side_gap="printed"))
    furthest = 0.0
    for state in random_states(20):
        depth = edge_on_side(LEFT_EDGE, State(*state), p).depth
        assert depth == pytest.approx(-printed_d2(Part(state, p)), abs=ROUNDING)
        furthest = max(furthest, abs(depth - side_depth(state, p)))
    assert furthest > 0.1  # the misprint matters


def test_printed_side_gap_closes_at_its_own_rate(device, constants, random_states):
    p = constants(device, Variants(side_gap="printed"))
    for state in random_states(20):
        gaps = [-printed_d2(Part(along(state, time), p)) for time in (STEP, -STEP)]
        rate = (gaps[0] - gaps[1]) / (2 * STEP)
        assert edge_on_side(LEFT_EDGE, State(*state), p).closing_rate == pytest.approx(
            rate, abs=DIFFERENCE
        )


def test_printed_u1_u2_u3_are_the_rows_of_the_sliding_contact(device, constants, random_states):
    p = constants(device, Variants.printed())
    mu, b, length = p.friction, p.half_height, p.slot_half_width
    for state in random_states(20):
        x, tilt = state[0], state[2]
        q = (length - x) / cos(tilt) - b * tan(tilt)
        u = (sin(tilt) - mu * cos(tilt), cos(tilt) + mu * sin(tilt), q + mu * b)
        contact = edge_on_face(RIGHT_EDGE, State(*state), p)
        # T = +μ n in the print, so that a unit n enters (3) with normal + μ tangent.
        rows = np.add(contact.normal, mu * np.asarray(contact.tangent))
        assert rows == pytest.approx(u, abs=ROUNDING)


def test_each_printed_row_comes_from_its_own_switch(device, constants, random_states):
    mu, b, length = device.friction, device.half_height, device.slot_half_width
    for state in random_states(10):
        x, tilt = state[0], state[2]
        q = (length - x) / cos(tilt) - b * tan(tilt)
        mended = edge_on_face(RIGHT_EDGE, State(*state), constants(device))
        p = constants(device, Variants(normal_sign="printed"))
        signs = edge_on_face(RIGHT_EDGE, State(*state), p)
        u1 = signs.normal[0] + mu * signs.tangent[0]
        assert u1 == pytest.approx(sin(tilt) - mu * cos(tilt), abs=ROUNDING)
        assert signs.normal[1:] == mended.normal[1:]
        assert signs.tangent[1:] == mended.tangent[1:]
        p = constants(device, Variants(moment_arms="printed"))
        arms = edge_on_face(RIGHT_EDGE, State(*state), p)
        assert (arms.normal[2], arms.tangent[2]) == pytest.approx((q, b), abs=ROUNDING)
        assert arms.normal[:2] == mended.normal[:2]
        assert arms.tangent[:2] == mended.tangent[:2]
        # Kinematics are geometry: no variant changes them.
        for other in (signs, arms):
            assert other[:4] == mended[:4]
            assert other.slip_row == mended.slip_row


@pytest.mark.parametrize("sign", ["consistent", "printed"])
def test_printed_side_force_enters_as_at_a1_with_the_mirrored_q(
    device, constants, random_states, sign
):
    p = constants(device, Variants(side_force="printed", normal_sign=sign))
    flip = 1.0 if sign == "consistent" else -1.0
    for state in random_states(20):
        x, tilt = state[0], state[2]

        def q(x, tilt):
            return (device.slot_half_width - x) / cos(tilt) - device.half_height * tan(tilt)

        contact = edge_on_side(LEFT_EDGE, State(*state), p)
        mirrored_q = -q(-x, -tilt)  # a moment changes sign in the mirror
        expected = (-flip * sin(tilt), cos(tilt), mirrored_q)
        assert contact.normal == pytest.approx(expected, abs=ROUNDING)
        expected = (flip * cos(tilt), sin(tilt), device.half_height)
        assert contact.tangent == pytest.approx(expected, abs=ROUNDING)
        # Its slip is that of the bottom face at A2; its depth stays the side face's.
        assert contact.slip == pytest.approx(slip_on_face(state, p), abs=DIFFERENCE)
        assert contact.depth == pytest.approx(side_depth(state, p), abs=ROUNDING)
