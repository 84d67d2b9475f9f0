"""Rest under a slow press: against the linear formula, the equations of motion, and slow runs."""

import math

import numpy as np
import pytest

from model.physics.modes import START, STICKING
from model.physics.motion import motion
from model.physics.notation import State
from model.physics.rest import rest_under_press
from vibralign import Outcome, simulate


@pytest.fixture(scope="module")
def rest(constants):
    return lambda p: rest_under_press(constants(p))


def first_order(p):
    """φ = n s / (k_φ + s² + k_x b² - n b), of a part that sticks where it touched.

    The axial spring takes a share of f0: n = f0 k_a / (k_a + 1).
    """
    s, b = p.slot_half_width - p.misalignment, p.half_height
    n = p.press_force * p.contact_stiffness / (p.contact_stiffness + 1.0)
    return n * s / (p.tilt_stiffness + s * s + p.lateral_stiffness * b * b - n * b)


@pytest.mark.parametrize("tilt_stiffness", [5.0, 10.0, 20.0])
def test_a_light_press_tilts_as_the_linear_formula(device, rest, tilt_stiffness):
    # The formula leaves out squares of the tilt, and of the depth over the lengths: below 1e-3.
    p = device.replace(press_force=0.005, tilt_stiffness=tilt_stiffness, friction=1.0)
    found = rest(p)
    assert found.found
    assert found.tilt == pytest.approx(first_order(p), rel=2e-3)


@pytest.mark.parametrize("friction", [0.0, 0.03, 0.12])
def test_it_is_an_equilibrium_of_the_equations_of_motion(device, constants, rest, friction):
    p = device.replace(press_force=0.3, friction=friction, frequency=0.0)
    x, y, tilt, found = rest(p)
    assert found
    mode = START if friction else START._replace(support_slip=1)  # without friction it slides
    at = motion(0.0, State(x, y, tilt, 0.0, 0.0, 0.0), constants(p), mode)
    assert mode.support_slip == (STICKING if friction else 1)
    np.testing.assert_allclose([at.x, at.y, at.tilt], 0.0, atol=1e-11)  # forces of order 1 to 10
    assert abs(at.support_friction) <= friction * at.support_load * (1.0 + 1e-11)


@pytest.mark.parametrize("friction", [0.0, 0.02, 0.05, 0.3])
@pytest.mark.parametrize("tilt_stiffness", [5.0, 10.0, 20.0])
def test_a_run_that_is_pressed_slowly_ends_there(device, rest, friction, tilt_stiffness):
    """Half a period of the excitation raises the force from 0 to 2, with slip on the way.

    It lasts 314 units of time, and the slowest motion of the part some 15: the run lags by a few
    thousandths. The equilibria at 16 loads miss a reversal of the slip by as much.
    """
    slow = device.replace(friction=friction, tilt_stiffness=tilt_stiffness, initial_tilt=0.0)
    frequency = 0.01
    ramp = slow.replace(press_force=1.0, frequency=frequency, phase=-0.5 * math.pi)
    run = simulate(ramp, horizon=math.pi / frequency)
    found = rest(slow.replace(press_force=2.0))
    falls = run.outcome is not Outcome.HORIZON_REACHED
    assert found.found != falls
    if not falls:
        np.testing.assert_allclose(run.state[-1, :3], found[:3], rtol=5e-3, atol=5e-3)


def test_a_part_with_a_short_arm_buckles(device, rest):
    """The tilt is small until the stiffness k_φ + s² + k_x b² - f0 b is used up, then large."""
    p = device.replace(friction=1.0, misalignment=1.13, clearance=0.09)
    s, b = p.slot_half_width - p.misalignment, p.half_height  # s = 0.012
    limit = (p.tilt_stiffness + s * s + p.lateral_stiffness * b * b) / b
    assert rest(p.replace(press_force=0.8 * limit)).tilt < 2.0 * s
    assert rest(p.replace(press_force=1.1 * limit)).tilt > 20.0 * s


def test_a_part_pressed_right_of_its_centre_finds_no_rest_on_the_edge(device, rest):
    # The mass centre is right of A1: the press lays the part on the flat base.
    assert not rest(device.replace(misalignment=1.3, press_force=1.0)).found
