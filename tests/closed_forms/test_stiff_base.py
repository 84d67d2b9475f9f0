"""A part that is pressed on a hard, well damped base: a linear motion."""

import numpy as np
import pytest
from scipy.linalg import expm

from model import Outcome, simulate


@pytest.mark.parametrize(("stiffness", "damping"), [(1e8, 1e4), (1e6, 1e4), (100.0, 1e4)])
def test_a_pressed_ball_follows_the_closed_form(ball, stiffness, damping):
    p = ball(stiffness, damping, press_force=3.0, frequency=5.0)
    run = simulate(p, horizon=2.0, may_settle=False)
    assert run.outcome is Outcome.HORIZON_REACHED
    # Of y - b: -(k_a + 1) y - h_a y' - f0 - sin ντ, from rest.
    matrix = np.array([
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [-stiffness - 1.0, -damping, -1.0, 0.0, -p.press_force],
        [0.0, 0.0, 0.0, p.frequency, 0.0],
        [0.0, 0.0, -p.frequency, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0],
    ])  # fmt: skip
    z = expm(2.0 * matrix) @ [0.0, 0.0, 0.0, 1.0, 1.0]
    assert run.state[-1, 1] - p.half_height == pytest.approx(z[0], abs=1e-10)
    assert run.state[-1, 4] == pytest.approx(z[1], abs=1e-9)
    assert run.contact_force[-1] == pytest.approx(
        -stiffness * z[0] - damping * z[1], abs=1e-5
    )  # rounding of y times the stiffness
