"""The contacts of the alignment scene, and their printed variants, from point coordinates alone.

The reference takes the part as a rigid body with corners: depths are signed distances between
points and lines, rates are central differences along a motion. Nothing here uses the algebra of
contacts.py.
"""

from math import cos, hypot, sin, tan

import numpy as np
import pytest

from model import Variants
from model.physics.contacts import contact_load, corner_on_flat, dot, edge_on_face, edge_on_side
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State

STEP = 1e-5
# Central differences: h²/6 times a third derivative of order 10, plus 1e-15/h from rounding.
DIFFERENCE = 3e-9
ROUNDING = 1e-13

SIDES = [RIGHT_EDGE, LEFT_EDGE]


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


def cross(u, v):
    return u[0] * v[1] - u[1] * v[0]


def beyond(point, start, end):
    """Distance of ``point`` to the left of the line from ``start`` to ``end``."""
    return cross(end - start, point - start) / hypot(*(end - start))


def depth_of(kind, side, pose, p):
    part = Part(pose, p)
    if kind == "face":  # inside is left of the way from B2 to B1
        return beyond(part.edges[side], part.b2, part.b1)
    if kind == "side":  # inside is left of the way from D2 down to B2
        return beyond(part.edges[LEFT_EDGE], part.d2, part.b2)
    return -(part.b1 if side == RIGHT_EDGE else part.b2)[1]


def touching_point(kind, side, part):
    if kind == "corner":
        return part.b1 if side == RIGHT_EDGE else part.b2
    return part.edges[LEFT_EDGE if kind == "side" else side]


def directions(kind, part):
    """(normal, tangent) of the force on the part."""
    e_t, e_n = part.turn[:, 0], part.turn[:, 1]
    return {
        "face": (e_n, e_t),
        "side": (e_t, e_n),
        "corner": (np.array([0.0, 1.0]), np.array([1.0, 0.0])),
    }[kind]


def contact_of(kind, side, state, p):
    q = State(*state)
    if kind == "face":
        return edge_on_face(side, q, p)
    return edge_on_side(LEFT_EDGE, q, p) if kind == "side" else corner_on_flat(side, q, p)


def along(state, time):
    """Pose after ``time`` with the rates of ``state`` and no accelerations."""
    return np.asarray(state[:3]) + time * np.asarray(state[3:])


def point_velocity(kind, side, state, p):
    """Velocity of the part's touching point, by following it."""
    own = Part(state, p).own(touching_point(kind, side, Part(state, p)))
    ahead = Part(along(state, STEP), p).place(own)
    behind = Part(along(state, -STEP), p).place(own)
    return (ahead - behind) / (2 * STEP)


def slip_of(kind, side, state, p):
    return point_velocity(kind, side, state, p) @ directions(kind, Part(state, p))[1]


KINDS = [
    ("face", RIGHT_EDGE),
    ("face", LEFT_EDGE),
    ("side", LEFT_EDGE),
    ("corner", RIGHT_EDGE),
    ("corner", LEFT_EDGE),
]
each_contact = pytest.mark.parametrize(("kind", "side"), KINDS)


@each_contact
def test_depth_is_the_distance_from_the_face(kind, side, p, random_states):
    for state in random_states(20):
        expected = depth_of(kind, side, state, p)
        assert contact_of(kind, side, state, p).depth == pytest.approx(expected, abs=ROUNDING)


def test_signs_of_the_depths_by_hand(p):
    # Upright, bottom face 0.1 below the plane: both edges and both corners are 0.1 deep; the part
    # stands 0.25 left of the middle, so A2 at -l is l - a - 0.25 outside the left face.
    state = State(-0.25, p.half_height - 0.1, 0.0, 0.0, 0.0, 0.0)
    for side in SIDES:
        assert edge_on_face(side, state, p).depth == pytest.approx(0.1, abs=ROUNDING)
        assert corner_on_flat(side, state, p).depth == pytest.approx(0.1, abs=ROUNDING)
    overlap = 0.25 - (p.slot_half_width - p.half_width)
    assert edge_on_side(LEFT_EDGE, state, p).depth == pytest.approx(overlap, abs=ROUNDING)


@each_contact
def test_closing_rate_is_the_rate_of_depth(kind, side, p, random_states):
    for state in random_states(20):
        ahead = depth_of(kind, side, along(state, STEP), p)
        behind = depth_of(kind, side, along(state, -STEP), p)
        rate = (ahead - behind) / (2 * STEP)
        assert contact_of(kind, side, state, p).closing_rate == pytest.approx(rate, abs=DIFFERENCE)


@each_contact
def test_slip_is_the_touching_points_velocity_along_the_tangent(kind, side, p, random_states):
    for state in random_states(20):
        expected = slip_of(kind, side, state, p)
        assert contact_of(kind, side, state, p).slip == pytest.approx(expected, abs=DIFFERENCE)


@pytest.mark.parametrize("side", SIDES)
def test_edge_moves_along_the_face_against_the_slip(side, p, random_states):
    for state in random_states(20):
        places = [
            Part(along(state, time), p).own(Part(state, p).edges[side])[0] for time in (STEP, -STEP)
        ]
        s_rate = (places[0] - places[1]) / (2 * STEP)
        assert edge_on_face(side, State(*state), p).slip == pytest.approx(-s_rate, abs=DIFFERENCE)


@each_contact
def test_slip_drift_is_the_slips_rate_without_accelerations(kind, side, p, random_states):
    h = 1e-3  # nested differences: (1e-3)²/6 times a derivative of order 10, plus 1e-10/1e-3
    for state in random_states(20):
        ahead = slip_of(kind, side, [*along(state, h), *state[3:]], p)
        behind = slip_of(kind, side, [*along(state, -h), *state[3:]], p)
        drift = contact_of(kind, side, state, p).slip_drift
        assert drift == pytest.approx((ahead - behind) / (2 * h), abs=2e-5)


@each_contact
def test_force_rows_do_virtual_work(kind, side, p, random_states):
    for state in random_states(20):
        velocity = point_velocity(kind, side, state, p)
        normal, tangent = directions(kind, Part(state, p))
        contact = contact_of(kind, side, state, p)
        assert dot(contact.normal, *state[3:]) == pytest.approx(velocity @ normal, abs=DIFFERENCE)
        assert dot(contact.tangent, *state[3:]) == pytest.approx(velocity @ tangent, abs=DIFFERENCE)
        assert contact.slip_row == contact.tangent


@each_contact
def test_force_rows_are_the_direction_and_its_torque(kind, side, p, random_states):
    for state in random_states(20):
        part = Part(state, p)
        arm = touching_point(kind, side, part) - part.centre
        contact = contact_of(kind, side, state, p)
        for row, direction in zip(
            (contact.normal, contact.tangent), directions(kind, part), strict=True
        ):
            assert row == pytest.approx((*direction, cross(arm, direction)), abs=ROUNDING)


def test_pressing_face_pushes_the_part_up_and_to_the_slot(p):
    # The physical sign: tilted counter-clockwise on A1, the normal force has a component to the
    # left (R1) and turns the part further counter-clockwise, since A1 stands right of C (s > 0).
    contact = edge_on_face(RIGHT_EDGE, State(0.2, p.half_height, 0.1, 0.0, 0.0, 0.0), p)
    assert contact.normal[0] < 0.0 < contact.normal[1]
    assert contact.normal[2] > 0.0


@pytest.mark.parametrize("kind", ["face", "corner"])
def test_mirror_image_swaps_the_sides(kind, p, random_states):
    flip_state = np.array([-1, 1, -1, -1, 1, -1])
    for state in random_states(20):
        right = contact_of(kind, RIGHT_EDGE, state, p)
        left = contact_of(kind, LEFT_EDGE, flip_state * state, p)
        assert left.depth == pytest.approx(right.depth, abs=ROUNDING)
        assert left.closing_rate == pytest.approx(right.closing_rate, abs=ROUNDING)
        assert left.slip == pytest.approx(-right.slip, abs=ROUNDING)
        assert left.slip_drift == pytest.approx(-right.slip_drift, abs=ROUNDING)
        # A mirrored force has (-x, y), and so has the moment the other sign; tangents point the
        # same way in both, so that theirs change in y instead.
        assert left.normal == pytest.approx(np.multiply(right.normal, (-1, 1, -1)), abs=ROUNDING)
        assert left.tangent == pytest.approx(np.multiply(right.tangent, (1, -1, 1)), abs=ROUNDING)


# ---------------------------------------------------------------------------- the load and its laws


def test_load_is_stiffness_times_depth_plus_damping_times_closing_rate(device, constants):
    p = constants(device.replace(contact_stiffness=50.0, contact_damping=4.0))
    q = State(0.0, 0.0, 0.0, 3.0, 4.0, 9.0)
    assert contact_load(0.02, 0.25, q, p) == pytest.approx(50 * 0.02 + 4 * 0.25, rel=ROUNDING)
    assert contact_load(0.02, -0.25, q, p) == pytest.approx(1.0 - 1.0, abs=ROUNDING)


def test_printed_load_is_damped_by_the_centres_speed(device, constants):
    changed = device.replace(contact_stiffness=50.0, contact_damping=4.0)
    p = constants(changed, Variants(contact_damping_law="printed"))
    q = State(0.0, 0.0, 0.0, 3.0, 4.0, 9.0)  # speed 5, whatever the closing rate
    for closing_rate in (0.25, -0.25):
        assert contact_load(2.0, closing_rate, q, p) == pytest.approx(100.0 - 20.0, rel=ROUNDING)


# ----------------------------------------------------------- the printed formulas, letter by letter


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


def test_printed_n_is_made_of_printed_d1_and_the_speed(device, constants, random_states):
    p = constants(device, Variants.printed())
    for state in random_states(20):
        contact = edge_on_face(RIGHT_EDGE, State(*state), p)
        speed = np.sqrt(state[4] ** 2 + state[3] ** 2)
        printed = -printed_d1(Part(state, p)) * 100.0 - 1.0 * speed  # K_a = 100, H_a = 1
        load = contact_load(contact.depth, contact.closing_rate, State(*state), p)
        assert load == pytest.approx(printed, abs=100 * ROUNDING)


def test_printed_d2_is_the_side_gap_as_printed_and_no_distance(device, constants, random_states):
    p = constants(device, Variants(side_gap="printed"))
    furthest = 0.0
    for state in random_states(20):
        depth = edge_on_side(LEFT_EDGE, State(*state), p).depth
        assert depth == pytest.approx(-printed_d2(Part(state, p)), abs=ROUNDING)
        furthest = max(furthest, abs(depth - depth_of("side", LEFT_EDGE, state, p)))
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
        assert contact.slip == pytest.approx(slip_of("face", LEFT_EDGE, state, p), abs=DIFFERENCE)
        assert contact.depth == pytest.approx(depth_of("side", LEFT_EDGE, state, p), abs=ROUNDING)
