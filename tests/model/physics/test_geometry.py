"""Corners and edges, against rotated points of the part."""

from math import atan2, cos, hypot, sin

import numpy as np
import pytest

from model.physics.geometry import bottom_corner, edge_place, face_coordinate, resting_height
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE

EXACT = 1e-14  # a handful of roundings of numbers of order one to ten


@pytest.fixture(scope="module")
def square(device, constants):
    """a = 3, b = 4, l = 3.3: a part whose half-diagonal is 5."""
    return constants(device.replace(half_width=3.0, half_height=4.0, clearance=0.1))


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


@pytest.mark.parametrize(("misalignment", "tilt"), [(0.2, 0.001), (0.9, 0.3), (0.5, -0.2)])
def test_resting_height_puts_the_bottom_face_through_the_edge(
    device, constants, misalignment, tilt
):
    p = constants(device.replace(misalignment=misalignment, initial_tilt=tilt))
    place = edge_place(RIGHT_EDGE, misalignment, resting_height(p), tilt, p)
    assert p.half_height + place.along_axis == pytest.approx(0.0, abs=10 * EXACT)
