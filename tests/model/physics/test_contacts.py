"""The printed variants of the contacts, letter by letter as in the paper.

All contacts, consistent and printed, are compared with the independent solution in test_motion.py.
"""

from math import cos, sin, tan

import numpy as np
import pytest

from model.physics.contacts import edge_on_face, edge_on_side
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from vibralign import Variants

ROUNDING = 1e-13


def printed_d2(state, p):
    """D2 of the paper, from the corners B2 and D2 of a rigid body and the edge A2."""
    x, y, tilt = state[:3]
    turn = np.array([[cos(tilt), -sin(tilt)], [sin(tilt), cos(tilt)]])
    x_a, y_a = -p.slot_half_width, 0.0
    (x_b, y_b), (x_d, y_d) = (
        np.array([x, y]) + turn @ [-p.half_width, side * p.half_height] for side in (-1.0, 1.0)
    )
    bracket = x_a * (y_d - y_b) + y_a * (y_d - y_b) + x_b * (y_b - y_d) + y_b * (y_d - y_b)
    return -bracket / np.sqrt((y_d - y_b) ** 2 + (x_d - x_b) ** 2)


def test_printed_d2_is_the_side_gap_as_printed_and_no_distance(device, constants, random_states):
    p = constants(device, Variants(side_gap="printed"))
    furthest = 0.0
    for state in random_states(20):
        depth = edge_on_side(LEFT_EDGE, State(*state), p).depth
        assert depth == pytest.approx(-printed_d2(state, p), abs=ROUNDING)
        distance = edge_on_side(LEFT_EDGE, State(*state), constants(device)).depth
        furthest = max(furthest, abs(depth - distance))
    assert furthest > 0.1  # the misprint matters


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
