"""The right-hand side without modes: at rest, at the fall, and the order of fixed steps."""

from math import cos, sin

import numpy as np
import pytest

from model.compile.entries import compiled
from model.physics.contacts import contact_load, edge_on_face
from model.physics.notation import RIGHT_EDGE
from verification.bench.methods import by_hand
from verification.bench.methods.by_hand import state_of
from vibralign import Variants


def rates(time, y, p):
    out = np.empty(6)
    by_hand.write_rates(np.array([time, *y]), np.array(p), out)
    return out


def outside(y, p):
    return by_hand.outside_of(np.array([0.0, *y]), np.array(p))


def standing(edge, along_face, depth, tilt, p):
    """(x, y) of the mass centre with an edge at s = ``along_face``, ``depth`` inside the face."""
    along_axis = depth - p.half_height
    c, s = cos(tilt), sin(tilt)
    r_x, r_y = along_face * c - along_axis * s, along_face * s + along_axis * c
    return edge * p.slot_half_width - r_x, -r_y


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
