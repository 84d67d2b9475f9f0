"""Corners and edges, against cases worked by hand and against rotated points of the part."""

from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
import pytest

from model.physics.geometry import bottom_corner, edge_place, face_coordinate, resting_height
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

EXACT = 1e-14  # a handful of roundings of numbers of order one to ten


@pytest.fixture(scope="module")
def square(device, constants):
    """a = 3, b = 4, l = 3.3: a part whose half-diagonal is 5."""
    return constants(device.replace(half_width=3.0, half_height=4.0, clearance=0.1))


def test_slot_is_wider_by_the_clearance(square):
    assert square.slot_half_width == pytest.approx(3.3, rel=EXACT)  # a (1 + δ)


def test_upright_corners_stand_half_a_side_away(square):
    assert bottom_corner(RIGHT_EDGE, 1.0, 10.0, 0.0, square) == (4.0, 6.0)
    assert bottom_corner(LEFT_EDGE, 1.0, 10.0, 0.0, square) == (-2.0, 6.0)


def test_quarter_turn_counter_clockwise_carries_the_bottom_face_to_the_right(square):
    # φ = 90°: e_t = (0, 1), e_n = (-1, 0): B1 = C + (0, 3) + (4, 0), B2 = C - (0, 3) + (4, 0).
    right = bottom_corner(RIGHT_EDGE, 1.0, 10.0, pi / 2, square)
    left = bottom_corner(LEFT_EDGE, 1.0, 10.0, pi / 2, square)
    assert right == pytest.approx((5.0, 13.0), abs=10 * EXACT)
    assert left == pytest.approx((5.0, 7.0), abs=10 * EXACT)


def test_positive_tilt_dips_the_left_corner(square):
    _, left = bottom_corner(LEFT_EDGE, 0.0, 4.0, 0.01, square)
    _, right = bottom_corner(RIGHT_EDGE, 0.0, 4.0, 0.01, square)
    assert left < 0.0 < right


@pytest.mark.parametrize("side", [RIGHT_EDGE, LEFT_EDGE])
def test_corner_keeps_its_distance_and_turns_with_the_part(square, side, random_states):
    at_rest = atan2(-4.0, side * 3.0)
    for x, y, tilt, *_ in random_states(20):
        corner = bottom_corner(side, x, y, tilt, square)
        r_x, r_y = corner[0] - x, corner[1] - y
        assert hypot(r_x, r_y) == pytest.approx(5.0, rel=EXACT)
        turned = atan2(r_y, r_x) - at_rest - tilt
        assert sin(turned) == pytest.approx(0.0, abs=10 * EXACT)
        assert cos(turned) > 0.0


@pytest.mark.parametrize("side", [RIGHT_EDGE, LEFT_EDGE])
def test_edge_place_is_the_edge_in_the_frame_of_the_part(square, side, random_states):
    for x, y, tilt, *_ in random_states(20):
        turn_back = np.array([[cos(tilt), sin(tilt)], [-sin(tilt), cos(tilt)]])
        expected = turn_back @ (np.array([side * 3.3, 0.0]) - np.array([x, y]))
        place = edge_place(side, x, y, tilt, square)
        assert (place.along_face, place.along_axis) == pytest.approx(expected, abs=10 * EXACT)
        assert (place.cos, place.sin) == pytest.approx((cos(tilt), sin(tilt)), rel=EXACT)


def test_edge_place_by_hand_at_thirty_degrees(square):
    # A1 - C = (3.3 - 0.3, -2) = (3, -2); cos = √3/2, sin = 1/2.
    place = edge_place(RIGHT_EDGE, 0.3, 2.0, pi / 6, square)
    assert place.along_face == pytest.approx(3.0 * sqrt(3) / 2 - 1.0, rel=10 * EXACT)
    assert place.along_axis == pytest.approx(-1.5 - sqrt(3), rel=10 * EXACT)


@pytest.mark.parametrize("side", [RIGHT_EDGE, LEFT_EDGE])
def test_face_coordinate_is_the_edge_place_when_the_face_passes_through_the_edge(square, side):
    # The face passes through A = (±l, 0) when b + (A - C)·e_n = 0; solved for y.
    for x, tilt in [(0.2, 0.001), (0.7, 0.4), (-0.5, -0.3)]:
        y = (square.half_height - (side * 3.3 - x) * sin(tilt)) / cos(tilt)
        on_face = edge_place(side, x, y, tilt, square)
        assert square.half_height + on_face.along_axis == pytest.approx(0.0, abs=10 * EXACT)
        q = (side * 3.3 - x) / cos(tilt) - 4.0 * sin(tilt) / cos(tilt)  # as the paper prints it
        assert face_coordinate(side, x, tilt, square) == pytest.approx(q, abs=10 * EXACT)
        assert on_face.along_face == pytest.approx(q, abs=10 * EXACT)


def test_off_the_face_the_edge_coordinate_is_q_plus_depth_times_tangent(square, random_states):
    for x, y, tilt, *_ in random_states(20):
        place = edge_place(RIGHT_EDGE, x, y, tilt, square)
        depth = square.half_height + place.along_axis
        s = face_coordinate(RIGHT_EDGE, x, tilt, square) + depth * sin(tilt) / cos(tilt)
        assert place.along_face == pytest.approx(s, abs=100 * EXACT)


@pytest.mark.parametrize(("misalignment", "tilt"), [(0.2, 0.001), (0.9, 0.3), (0.5, -0.2)])
def test_resting_height_puts_the_bottom_face_through_the_edge(
    device, constants, misalignment, tilt
):
    p = constants(device.replace(misalignment=misalignment, initial_tilt=tilt))
    place = edge_place(RIGHT_EDGE, misalignment, resting_height(p), tilt, p)
    assert p.half_height + place.along_axis == pytest.approx(0.0, abs=10 * EXACT)
