"""Each force besides contact, against its formula with round numbers."""

from math import pi, sin

import pytest

from model.physics.forces import (
    axial_suspension,
    excitation,
    lateral_suspension,
    press,
    tilt_suspension,
)
from model.physics.notation import State

ROUNDING = 1e-14
AT = State(x=0.5, y=5.0, tilt=0.25, x_rate=2.0, y_rate=-3.0, tilt_rate=0.5)


@pytest.fixture
def p(device, constants):
    return constants(
        device.replace(
            lateral_stiffness=3.0, lateral_damping=0.25, rest_x=0.1,
            axial_damping=0.125, rest_y=4.0,
            tilt_stiffness=8.0, tilt_damping=1.5, rest_tilt=0.05,
            press_force=2.5, frequency=2.0, phase=0.3,
        )
    )  # fmt: skip


def test_lateral_suspension_pulls_back_and_brakes(p):
    assert lateral_suspension(AT, p) == pytest.approx(-0.25 * 2.0 - 3.0 * 0.4, rel=ROUNDING)


def test_axial_suspension_has_unit_stiffness(p):
    assert axial_suspension(AT, p) == pytest.approx(0.125 * 3.0 - 1.0, rel=ROUNDING)


def test_tilt_suspension_turns_back_and_brakes(p):
    assert tilt_suspension(AT, p) == pytest.approx(-1.5 * 0.5 - 8.0 * 0.2, rel=ROUNDING)


def test_press_points_down(p):
    assert press(p) == -2.5


def test_excitation_starts_downward_with_amplitude_one(p):
    assert excitation(0.0, p) == pytest.approx(-sin(0.3), rel=ROUNDING)
    # ντ + phase = π/2: the largest force down.
    assert excitation((pi / 2 - 0.3) / 2.0, p) == pytest.approx(-1.0, rel=ROUNDING)
