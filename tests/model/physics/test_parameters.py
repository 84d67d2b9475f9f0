"""Parameter sets and batches: values accepted, refused and resolved."""

import dataclasses
import math

import numpy as np
import pytest

from model.physics.parameters import FIELDS, PARAMETER_NAMES
from vibralign import Batch, Parameters, Variants

POSITIVE = [
    "half_width", "half_height", "clearance", "inertia", "contact_stiffness", "approach_speed",
]  # fmt: skip
NOT_NEGATIVE = [
    "lateral_stiffness", "tilt_stiffness", "lateral_damping", "axial_damping", "tilt_damping",
    "contact_damping", "friction", "frequency",
]  # fmt: skip
ANY_SIGN = ["initial_tilt", "press_force", "phase", "rest_x", "rest_y", "rest_tilt"]


def test_the_table_names_every_parameter_of_the_dataclass():
    assert set(PARAMETER_NAMES) == {field.name for field in dataclasses.fields(Parameters)}
    assert {*POSITIVE, *NOT_NEGATIVE, *ANY_SIGN, "misalignment"} == set(PARAMETER_NAMES)
    assert len({field.symbol for field in FIELDS.values()}) == len(FIELDS)


@pytest.mark.parametrize("name", POSITIVE)
def test_zero_is_refused_where_a_quantity_must_be_positive(device, name):
    with pytest.raises(ValueError, match=rf"{name} = 0\.0: must be a finite number > 0"):
        device.replace(**{name: 0.0})


@pytest.mark.parametrize("name", NOT_NEGATIVE)
def test_zero_is_admitted_and_less_refused(device, name):
    assert getattr(device.replace(**{name: 0}), name) == 0.0
    with pytest.raises(ValueError, match=rf"{name} = -1e-09: must be a finite number >= 0"):
        device.replace(**{name: -1e-9})


@pytest.mark.parametrize("name", PARAMETER_NAMES)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_value_that_is_not_finite_is_refused(device, name, value):
    with pytest.raises(ValueError, match=f"{name} = .*must be a finite number"):
        device.replace(**{name: value})


@pytest.mark.parametrize("value", ["1", True, [1.0], 1 + 0j])
def test_a_value_that_is_not_a_number_is_refused(device, value):
    with pytest.raises(TypeError, match="friction = "):
        device.replace(friction=value)


def test_none_stands_for_a_derived_rest_only(device):
    assert device.rest_x is None
    assert device.replace(rest_x=0.5).replace(rest_x=None).rest_x is None
    with pytest.raises(TypeError, match="rest_tilt = None"):
        device.replace(rest_tilt=None)


def test_a_part_wholly_beside_the_slot_is_refused(device):
    # Its left corner x - a must stand left of A1 = l = a (1 + δ): x < a (2 + δ).
    limit = device.half_width * (2.0 + device.clearance)
    assert device.replace(misalignment=limit * (1 - 1e-12)).misalignment < limit
    with pytest.raises(ValueError, match=r"misalignment = .*half_width \* \(2 \+ clearance\)"):
        device.replace(misalignment=limit)


def test_the_mass_centre_may_stand_left_of_the_middle_if_the_face_does_not(device):
    # The face of a part that is tilted by φ has its middle at x + b sin φ.
    tilted, out = device.replace(initial_tilt=0.02), 0.999 * device.half_height * math.sin(0.02)
    assert tilted.replace(misalignment=-out).misalignment == -out
    for wrong in (tilted.replace, lambda **changes: Batch.of(tilted, **changes)):
        far = -1.01 * out / 0.999
        with pytest.raises(ValueError, match=r"misalignment.*= -.*half_height \* sin"):
            wrong(misalignment=far if wrong == tilted.replace else [far])


def test_parameters_are_frozen_and_replace_makes_a_copy(device):
    with pytest.raises(dataclasses.FrozenInstanceError):
        device.friction = 0.5
    changed = device.replace(friction=0.5)
    assert (changed.friction, device.friction) == (0.5, 0.12)
    assert changed.given() == {**device.given(), "friction": 0.5}


# ------------------------------------------------------------------------------------------ batches


def test_batch_varies_its_columns_together_over_the_baseline(device):
    batch = Batch.of(device, press_force=[1.0, 2.0, 3.0], tilt_stiffness=np.array([5, 6, 7]))
    assert len(batch) == 3
    assert batch[1] == device.replace(press_force=2.0, tilt_stiffness=6.0)


def test_batch_does_not_follow_later_changes_of_its_input(device):
    values = np.array([1.0, 2.0])
    batch = Batch.of(device, press_force=values)
    values[:] = 9.0
    assert batch[0].press_force == 1.0


def test_stack_and_item_are_a_round_trip(device):
    rows = [device, device.replace(rest_x=0.1, rest_y=-2.0), device.replace(friction=0)]
    batch = Batch.stack(rows)
    assert [batch[i] for i in range(len(batch))] == rows
    assert batch[-1] == rows[-1]
    with pytest.raises(IndexError):
        batch[3]


@pytest.mark.parametrize(
    ("swept", "message"),
    [
        ({"friction": [0.1, -0.1]}, r"friction\[1\] = -0\.1: must be a finite number >= 0"),
        ({"inertia": [1.0, 0.0]}, r"inertia\[1\] = 0\.0: must be a finite number > 0"),
        ({"press_force": [math.inf]}, r"press_force\[0\] = inf: must be a finite number"),
        ({"press_force": [math.nan]}, r"press_force\[0\] = nan: must be a finite number"),
        ({"misalignment": [0.1, 9.0]}, r"misalignment\[1\] = 9\.0: must be smaller"),
        ({"half_width": [1.0, 0.05]}, r"misalignment\[1\] = 0\.2: must be smaller"),
        ({"press_force": [1.0], "frequency": [1.0, 2.0]}, "press_force: 1, frequency: 2"),
        ({"press_force": [[1.0]]}, "press_force: must be a non-empty array of one dimension"),
        ({"press_force": 1.0}, "press_force: must be a non-empty array of one dimension"),
        ({"press_force": []}, "press_force: must be a non-empty array of one dimension"),
        ({"pres_force": [1.0]}, "Did you mean 'press_force'"),
    ],
)
def test_batch_applies_the_rules_of_parameters_and_names_the_row(device, swept, message):
    with pytest.raises(ValueError, match=message):
        Batch.of(device, **swept)


# ---------------------------------------------------------------------------------------- constants


def test_rests_default_to_the_start_and_the_half_height(device, constants):
    p = constants(device)
    assert (p.rest_x, p.rest_y) == (device.misalignment, device.half_height)
    p = constants(device.replace(rest_x=0.0, rest_y=1.0))
    assert (p.rest_x, p.rest_y) == (0.0, 1.0)


def test_printed_preload_relaxes_the_axial_spring_at_zero(device, constants):
    p = constants(device.replace(rest_y=2.0), Variants(preload="printed"))
    assert (p.rest_x, p.rest_y) == (device.misalignment, 0.0)


def test_constants_carry_each_parameter_and_switch_in_its_own_place(constants):
    distinct = {name: 1.0 + 0.01 * i for i, name in enumerate(PARAMETER_NAMES)}
    p = constants(Parameters(**distinct), Variants(side_gap="printed"))
    for name, value in distinct.items():
        if name != "clearance":
            assert getattr(p, {"approach_speed": "press_rate"}.get(name, name)) == value
    switches = {name: value for name, value in p._asdict().items() if name.startswith("printed_")}
    assert switches.pop("printed_side_gap") == 1.0
    assert set(switches.values()) == {0.0}
