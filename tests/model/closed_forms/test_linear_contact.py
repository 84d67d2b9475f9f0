"""In one mode the motion of a part that cannot tilt is linear: against the matrix exponential."""

from math import cos, sin

import numpy as np
import pytest
from scipy.linalg import expm

from model.physics.modes import CLOSED, START, STICKING

TILT, LOCKED = 0.1, 1e14


def system(p, slides):
    """d/dτ of (x - x0, y - y0, ẋ, ẏ, sin, cos, 1) of the sliding part; x0, y0 touch the base."""
    c, s = cos(TILT), sin(TILT)
    normal, tangent = np.array([-s, c]), np.array([c, s])
    push = normal - slides * p.friction * tangent  # direction of n and T together
    matrix = np.zeros((7, 7))
    matrix[0, 2] = matrix[1, 3] = 1.0
    # n = -k_a e_n·(C - C0) - h_a e_n·Ċ
    matrix[2:4, 0:2] = -p.contact_stiffness * np.outer(push, normal)
    matrix[2:4, 2:4] = -p.contact_damping * np.outer(push, normal)
    matrix[2, 0] -= p.lateral_stiffness
    matrix[3, 1] -= 1.0
    matrix[2, 2] -= p.lateral_damping
    matrix[3, 3] -= p.axial_damping
    matrix[3, 4] = -1.0
    matrix[4, 5], matrix[5, 4] = p.frequency, -p.frequency
    return matrix


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("stiffness", "damping"), [(100.0, 1.0), (1e4, 100.0), (1e6, 10.0)])
def test_sliding_contact_follows_the_matrix_exponential(
    stepped_run, device, friction, stiffness, damping
):
    p = device.replace(
        inertia=LOCKED, initial_tilt=TILT, rest_tilt=TILT, friction=friction, press_force=3.0,
        contact_stiffness=stiffness, contact_damping=damping, frequency=7.0, phase=0.4,
    )  # fmt: skip
    reach = p.slot_half_width - p.misalignment
    y0 = (p.half_height - reach * sin(TILT)) / cos(TILT)
    p = p.replace(rest_y=y0)
    # It slides up the face at 1: friction, at most 0.3 · 4, cannot stop it within the horizon.
    start = np.array([p.misalignment, y0, TILT, cos(TILT), sin(TILT), 0.0])
    run = stepped_run(p, start, START._replace(support_slip=1), horizon=0.3, tolerance=1e-13)
    assert {(step.mode.face, step.mode.support_slip) for step in run.steps} <= {
        (CLOSED, 1),
        (1, -1),
    }
    matrix = system(p, 1.0)
    matrix[3, 6] = -p.press_force
    z0 = np.array([0.0, 0.0, cos(TILT), sin(TILT), sin(p.phase), cos(p.phase), 1.0])
    for step in run.steps[:: max(1, len(run.steps) // 30)]:
        z = expm(step.end * matrix) @ z0
        # 1e-13 a step relative to 2, and as many steps as the base's frequency asks for.
        found = step.end_state - np.array([p.misalignment, y0, 0.0, 0.0, 0.0, 0.0])
        assert found[[0, 1]] == pytest.approx(z[:2], abs=1e-10)
        assert found[[3, 4]] == pytest.approx(z[2:4], abs=1e-10 * max(1.0, stiffness**0.5 / 10))


def test_sticking_contact_follows_the_matrix_exponential(stepped_run, device):
    # Sticking takes away the motion along the face: one degree of freedom across it is left.
    p = device.replace(
        inertia=LOCKED, initial_tilt=TILT, rest_tilt=TILT, friction=2.0, press_force=3.0,
        frequency=5.0, phase=0.0, lateral_damping=0.7,
    )  # fmt: skip
    reach = p.slot_half_width - p.misalignment
    y0 = (p.half_height - reach * sin(TILT)) / cos(TILT)
    p = p.replace(rest_y=y0)
    c, s = cos(TILT), sin(TILT)
    depth = 0.02
    start = np.array([p.misalignment + s * depth, y0 - c * depth, TILT, 0.0, 0.0, 0.0])
    run = stepped_run(p, start, START._replace(support_slip=STICKING), horizon=1.5, tolerance=1e-13)
    assert {step.mode.support_slip for step in run.steps} == {STICKING}
    # Of ζ = e_n·(C - C0): -(k_a + k_x s² + c²) ζ - (h_a + h_x s² + h_y c²) ζ' - c (f0 + sin ντ).
    stiffness = p.contact_stiffness + p.lateral_stiffness * s * s + c * c
    damping = p.contact_damping + p.lateral_damping * s * s + p.axial_damping * c * c
    matrix = np.array([
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [-stiffness, -damping, -c, 0.0, -c * p.press_force],
        [0.0, 0.0, 0.0, p.frequency, 0.0],
        [0.0, 0.0, -p.frequency, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0],
    ])  # fmt: skip
    z0 = np.array([-depth, 0.0, 0.0, 1.0, 1.0])
    for step in run.steps:
        z = expm(step.end * matrix) @ z0
        moved = step.end_state[:2] - [p.misalignment, y0]
        assert moved @ [-s, c] == pytest.approx(z[0], abs=1e-11)
        assert moved @ [c, s] == pytest.approx(0.0, abs=1e-11)
        assert step.end_state[3:5] @ [-s, c] == pytest.approx(z[1], abs=1e-10)
