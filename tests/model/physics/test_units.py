"""Devices in SI units: scaled as in the paper's sect. 2; refusals name the value in SI."""

import math

import pytest

from model.physics.parameters import PARAMETER_NAMES
from model.physics.units import UNITS, Units, device

M, K_Y, Y = 0.3, 2700.0, 2e-3  # p = sqrt(9000) 1/s, F1 = 5.4 N
P, F1 = math.sqrt(K_Y / M), K_Y * Y
PEG = {
    "mass": M,
    "axial_stiffness": K_Y,
    "amplitude": Y,
    "half_width": 5e-3,
    "half_height": 20e-3,
    "clearance": 0.04,
    "misalignment": 0.8e-3,
    "inertia": 4.5e-5,
    "lateral_stiffness": 50.0,
    "tilt_stiffness": 0.5,
    "lateral_damping": 8.0,
    "axial_damping": 6.0,
    "tilt_damping": 4e-3,
    "friction": 0.15,
    "press_force": 10.0,
    "frequency": 50.0,
}

# The definitions as the paper prints them (sect. 2).
PRINTED = {
    "half_width": lambda value: K_Y * value / F1,
    "half_height": lambda value: K_Y * value / F1,
    "misalignment": lambda value: K_Y * value / F1,
    "inertia": lambda value: (value / M) / (F1 / K_Y) ** 2,
    "lateral_stiffness": lambda value: value / K_Y,
    "tilt_stiffness": lambda value: value * K_Y / F1**2,
    "approach_speed": lambda value: value * math.sqrt(K_Y * M) / F1,
    "lateral_damping": lambda value: value / math.sqrt(K_Y * M),
    "axial_damping": lambda value: value / math.sqrt(K_Y * M),
    "tilt_damping": lambda value: value * P**3 * M / F1**2,
    "contact_stiffness": lambda value: value / K_Y,
    "contact_damping": lambda value: value / math.sqrt(K_Y * M),
    "press_force": lambda value: value / F1,
    "frequency": lambda value: 2 * math.pi * value / P,
    "rest_x": lambda value: K_Y * value / F1,
    "rest_y": lambda value: K_Y * value / F1,
    "clearance": lambda value: value,
    "friction": lambda value: value,
    "initial_tilt": lambda value: value,
    "phase": lambda value: value,
    "rest_tilt": lambda value: value,
}


def test_every_parameter_has_a_quantity():
    assert set(PARAMETER_NAMES) == set(PRINTED)


@pytest.mark.parametrize("name", PARAMETER_NAMES)
def test_a_quantity_is_scaled_as_the_paper_defines_it(name):
    value = PEG.get(name, 0.0123)
    scaled = getattr(device({**PEG, name: value}).parameters, name)
    assert scaled == pytest.approx(PRINTED[name](value), rel=1e-14)


def test_results_scale_by_the_units():
    units = Units(M, K_Y, Y)
    assert units.time == pytest.approx(1.0 / P)
    assert units.force == pytest.approx(F1)


def test_a_device_goes_back_to_what_was_given():
    found = device(PEG)
    back = found.units.in_si(found.parameters).given()
    assert {name: back[name] for name in PEG.keys() & back.keys()} == pytest.approx(
        {name: PEG[name] for name in PEG.keys() & back.keys()}, rel=1e-14
    )
    assert back["rest_x"] is None  # a derived value stays derived


def test_a_device_takes_the_models_defaults():
    found = device(PEG).parameters
    assert (found.contact_stiffness, found.contact_damping) == (100.0, 1.0)
    assert found.rest_x is None
    assert found.rest_y is None


def test_the_same_device_in_larger_units_of_length_and_force_is_the_same_model():
    larger = dict(PEG)
    for name in ("amplitude", "half_width", "half_height", "misalignment", "press_force"):
        larger[name] *= 3.0
    for name in ("inertia", "tilt_stiffness", "tilt_damping"):
        larger[name] *= 9.0
    for name, value in device(larger).parameters.given().items():
        assert value == pytest.approx(getattr(device(PEG).parameters, name)), name


@pytest.mark.parametrize("name", UNITS)
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_unit_must_be_positive(name, value):
    with pytest.raises(ValueError, match=f"{name} = .*must be a finite number > 0"):
        device({**PEG, name: value})


@pytest.mark.parametrize("name", PEG)
def test_a_missing_quantity_is_named(name):
    with pytest.raises(ValueError, match=f"{name} is missing: a device needs mass, "):
        device({key: value for key, value in PEG.items() if key != name})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"friction": -0.1}, r"friction = -0\.1: must be a finite number >= 0"),
        ({"half_width": 0.0}, r"half_width = 0\.0: must be a finite number > 0"),
        ({"misalignment": 0.02}, r"misalignment = 0\.02: must be smaller than half_width"),
        ({"pressforce": 1.0}, "unknown quantity of a device 'pressforce'. Did you mean 'press_f"),
    ],
)
def test_a_refusal_names_the_value_that_was_given(change, message):
    with pytest.raises(ValueError, match=message):
        device({**PEG, **change})
