"""Limits at which a pressed part sticks for ever, or slow excitation moves it, against statics.

Tilt locked at φ (an immense inertia) on the edge A1, excitation f0 + sin ντ so slow that every
force is balanced. Let P be the press force less what the axial spring gives, and F = k_x (x_st - x)
the pull of the lateral spring along +x. On the part act, besides n e_n + T e_t, the forces F along
x and -P along y. Balance along e_n = (-sin φ, cos φ) and e_t = (cos φ, sin φ):

    n = P cos φ + F sin φ        T = P sin φ - F cos φ

so sticking, |T| <= μ n, is |P tan φ - F| <= μ (P + F tan φ). While tan φ < μ it is hardest to meet
where P is least, P = W = f0 - 1: with Δx = x_st - x the part sticks for ever iff

    |W tan φ - k_x Δx| <= μ (W + k_x Δx tan φ).

In the mirror image, tilt counted clockwise, this is |W tan φ + k_x Δx| <= μ (W - k_x Δx tan φ).
"""

from math import cos, pi, sin, tan

import numpy as np
import pytest

from vibralign import simulate

TILT, FRICTION, PRESS, STIFFNESS, FREQUENCY = 0.05, 0.12, 3.0, 0.5, 0.1
W = PRESS - 1.0
AWAY = W * (FRICTION + tan(TILT)) / (1.0 - FRICTION * tan(TILT))
"""F at which the part starts to slide in +x, away from the slot: F - W tan φ = μ (W + F tan φ)."""
INWARD = W * (tan(TILT) - FRICTION) / (1.0 + FRICTION * tan(TILT))
"""F at which it starts to slide to the slot, in -x: W tan φ - F = μ (W + F tan φ)."""
# The base, k_a = 1e4, gives way by n / k_a = 2e-4, which the axial spring, relaxed at the height of
# first touch, takes from P: a relative 1e-4. Inertia forces are of order n ν² / k_a = 1e-6.
CLOSE = 5e-3


@pytest.fixture
def run(device):
    """Distance slid along the face after the start, for a lateral pull F at the start."""

    def make(pull):
        r_x = device.slot_half_width - device.misalignment
        touch = (device.half_height - r_x * sin(TILT)) / cos(TILT)
        p = device.replace(
            inertia=1e12, tilt_damping=0.0, initial_tilt=TILT, rest_tilt=TILT,
            friction=FRICTION, press_force=PRESS, frequency=FREQUENCY, phase=pi / 2,
            lateral_stiffness=STIFFNESS, rest_x=device.misalignment + pull / STIFFNESS,
            contact_stiffness=1e4, contact_damping=200.0, rest_y=touch,
        )  # fmt: skip
        # The phase starts the run where P is largest: it settles on the base (n needs 0.1 to build
        # up, and meanwhile the part may slip) before P falls to W, half a period later.
        result = simulate(p, horizon=1.2 * 2.0 * pi / FREQUENCY, may_settle=False)
        assert np.ptp(result.state[:, 2]) < 1e-7  # locked indeed
        along = result.state[:, 0] * cos(TILT) + result.state[:, 1] * sin(TILT)
        settled = result.time > 5.0
        return along[settled][-1] - along[settled][0], np.ptp(along[settled]), result

    return make


def test_the_limits_lie_on_both_sides_of_no_pull():
    assert INWARD < 0.0 < AWAY  # φ < atan μ: at rest without a pull
    for pull in (INWARD, AWAY):  # both make the condition an equality
        limit = FRICTION * (W + pull * tan(TILT))
        assert abs(W * tan(TILT) - pull) == pytest.approx(limit, rel=1e-14)


@pytest.mark.parametrize("limit", [AWAY, INWARD], ids=["away", "inward"])
@pytest.mark.parametrize("margin", [CLOSE, 0.02, 0.5])
def test_inside_the_limit_it_sticks_for_ever(run, limit, margin):
    _, moved, result = run(limit * (1.0 - margin))
    # What moves is the tilt that is not quite locked: moment of 10 on 1e12 over 75 time units gives
    # 3e-8 rad on an arm of 4.
    assert moved < 3e-7
    assert result.sticking_share > 0.999


@pytest.mark.parametrize(("limit", "sign"), [(AWAY, 1), (INWARD, -1)], ids=["away", "inward"])
@pytest.mark.parametrize("margin", [CLOSE, 0.02])
def test_outside_the_limit_it_slides_the_way_it_is_pulled(run, limit, sign, margin):
    distance, moved, result = run(limit * (1.0 + margin))
    # It slides for the part of the period in which P is below its limit; against what a stuck part
    # moves the distance is large.
    assert moved > 1e-4
    assert np.sign(distance) == sign
    assert result.sticking_share < 0.98
