"""Equations (3): each force alone, and their sum beside that of the independent solution."""

from dataclasses import replace
from math import pi, sin

import numpy as np
import pytest

from model.physics.contacts import corner_on_flat, edge_on_face
from model.physics.modes import (
    CLOSED,
    OPEN,
    RELEASED,
    SLIP_NEGATIVE,
    SLIP_POSITIVE,
    START,
    STICKING,
)
from model.physics.motion import motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.variants import VARIANT_NAMES
from verification.independent.motion import Mode as TheirMode
from verification.independent.printed import PrintedDevice
from vibralign import Parameters, Variants

ROUNDING = 1e-13  # relative to forces of order 1 to 100, a few hundred roundings
FREE = START._replace(face=OPEN)
ON_CORNER = START._replace(face=OPEN, corner=CLOSED, slip_at_corner=True)
NOTHING = Parameters(
    half_width=1.0, half_height=4.0, inertia=2.0, lateral_stiffness=0.0, tilt_stiffness=0.0,
    lateral_damping=0.0, axial_damping=0.0, tilt_damping=0.0, friction=0.0, press_force=0.0,
    frequency=0.0, clearance=0.1, misalignment=0.2, rest_y=5.0,
)  # fmt: skip
"""No force at y = 5: k_y = 1 by scaling, so the axial spring can only be relaxed."""


def accelerations(at):
    return (at.x, at.y, at.tilt)


# --------------------------------------------------------------------------------- each force alone


@pytest.fixture
def force_alone(constants):
    """Accelerations of the part without contact at ``state``, when only ``changes`` act."""

    def make(state, time=0.0, **changes):
        q = State(*map(float, state))  # whole numbers would be compiled for anew
        return accelerations(motion(time, q, constants(NOTHING.replace(**changes)), FREE))

    return make


@pytest.mark.parametrize(
    ("state", "changes", "expected"),
    [
        ((0.7, 5, 0.3, 1, -2, 0.5), {}, (0, 0, 0)),
        ((0.7, 5, 0, 0, 0, 0), {"lateral_stiffness": 3.0, "rest_x": 0.2}, (-1.5, 0, 0)),
        ((0, 5, 0, 2, 0, 0), {"lateral_damping": 0.25}, (-0.5, 0, 0)),
        ((0, 5.5, 0, 0, 0, 0), {}, (0, -0.5, 0)),
        ((0, 5, 0, 0, 2, 0), {"axial_damping": 0.25}, (0, -0.5, 0)),
        ((0, 5, 0.3, 0, 0, 0), {"tilt_stiffness": 8.0, "rest_tilt": 0.05}, (0, 0, -1.0)),
        ((0, 5, 0, 0, 0, 3), {"tilt_damping": 4.0}, (0, 0, -6.0)),
        ((0, 5, 0, 0, 0, 0), {"press_force": 2.5}, (0, -2.5, 0)),
        ((0, 5, 0, 0, 0, 0), {"phase": pi / 2}, (0, -1.0, 0)),
    ],
    ids=["nothing", "k_x", "h_x", "k_y", "h_y", "k_phi / I", "h_phi / I", "f0", "excitation"],
)
def test_each_suspension_force_alone(force_alone, state, changes, expected):
    assert force_alone(state, **changes) == pytest.approx(expected, abs=ROUNDING)


def test_excitation_alone_follows_the_sine(force_alone):
    at = force_alone((0, 5, 0, 0, 0, 0), time=0.7, frequency=3.0, phase=0.2)
    assert at == pytest.approx((0.0, -sin(3.0 * 0.7 + 0.2), 0.0), abs=ROUNDING)


def test_released_contacts_push_nothing(constants, random_states):
    p = constants(NOTHING)
    released = START._replace(face=RELEASED, side=RELEASED, corner=RELEASED)
    for state in random_states(5):
        expected = motion(0.3, State(*state), p, FREE)
        assert motion(0.3, State(*state), p, released) == expected


# ------------------------------------------------------- the sum, beside the independent solution


class Independent:
    """What the independent solution says of a mode in one state; slips that are not given stick."""

    def __init__(self, time, state, parameters, readings, mode):
        self.state = time, np.array(state)
        printed = [name for name in VARIANT_NAMES if readings.is_printed(name)]
        self.device, self.readings, self.mode = PrintedDevice(parameters, printed), readings, mode

    def at(self, *slips):
        """Return accelerations, and (load, slip, friction, drive) of support and side."""
        mode = replace(self.mode, **dict(zip(("slides", "side_slides"), slips, strict=False)))
        force, turn, groups, frictions, drives = self.device.rates(*self.state, mode)
        contacts = [
            (load, touches[0].slip, frictions[i], drives[i])
            for i, (touches, _, _, load) in enumerate(groups)
            if touches
        ]
        return (force.real, force.imag, turn), contacts

    def signs(self):
        """Return the signs of the slips; printed, T = +μ n as if every slip were negative."""
        printed = self.readings.friction_law == "printed"
        slips = [slip for _, slip, *_ in self.at(1, 1)[1]]
        return [SLIP_NEGATIVE if printed or slip < 0.0 else SLIP_POSITIVE for slip in slips]


READINGS = {
    "consistent": Variants.consistent(),
    "printed": Variants.printed(),
    **{name: Variants(**{name: "printed"}) for name in VARIANT_NAMES},
}
every_reading = pytest.mark.parametrize("readings", READINGS.values(), ids=list(READINGS))
ON_FACE, BESIDE = TheirMode(), TheirMode(side="on")
one_contact = pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (mode._replace(edge=edge), replace(their, edge=edge))
        for mode, their in ((START, ON_FACE), (ON_CORNER, TheirMode(face="off", corner="on")))
        for edge in (RIGHT_EDGE, LEFT_EDGE)
    ],
    ids=["face", "left face", "corner", "left corner"],
)


@every_reading
@one_contact
def test_sum_of_forces_on_one_sliding_contact(
    device, constants, random_states, ours, theirs, readings
):
    p = constants(device, readings)
    signs = set()
    for state in random_states(30, seed=2):
        here = Independent(1.3, state, device, readings, theirs)
        (sign,) = here.signs()
        total, [(load, slip, friction, drive)] = here.at(sign)
        signs.add(np.sign(slip))
        at = motion(1.3, State(*state), p, ours._replace(support_slip=sign))
        assert accelerations(at) == pytest.approx(total, rel=1e-11, abs=1e-11)
        found = at.support_load, at.support_slip, at.support_friction
        assert found == pytest.approx((load, slip, friction), rel=1e-11, abs=1e-11)
        assert at.support_drive == pytest.approx(drive, rel=1e-10, abs=1e-10)
    assert signs == {-1.0, 1.0}  # both directions were tried


@every_reading
def test_sum_of_forces_with_face_and_side(device, constants, random_states, readings):
    p = constants(device, readings)
    for state in random_states(30, seed=3):
        here = Independent(0.4, state, device, readings, BESIDE)
        signs = here.signs()
        total, [(*_, drive), (load, slip, _, side_drive)] = here.at(*signs)
        mode = START._replace(support_slip=signs[0], side=CLOSED, side_slip=signs[1])
        at = motion(0.4, State(*state), p, mode)
        assert accelerations(at) == pytest.approx(total, rel=1e-11, abs=1e-11)
        assert (at.side_load, at.side_slip) == pytest.approx((load, slip), rel=1e-11, abs=1e-11)
        drives = at.support_drive, at.side_drive
        assert drives == pytest.approx((drive, side_drive), rel=1e-10, abs=1e-10)


def test_edge_and_corner_under_one_face_share_friction_by_their_loads(device, constants):
    # Upright, 0.05 deep, corner from 0.03: n_edge = 5, n_corner = 2, in all 7. Both frictions point
    # along x; the edge's stands b - 0.05 below C, the corner's b.
    p = constants(device)
    q = State(0.5, p.half_height - 0.05, 0.0, 0.4, 0.0, 0.0)
    mode = START._replace(corner=CLOSED, corner_offset=0.03, support_slip=SLIP_POSITIVE)
    at = motion(0.0, q, p, mode)
    assert at.support_load == pytest.approx(7.0, abs=1e-12)
    assert at.support_friction == pytest.approx(-0.12 * 7.0, abs=1e-12)
    lateral = -device.lateral_damping * 0.4 - device.lateral_stiffness * 0.3
    assert at.x == pytest.approx(lateral - 0.84, abs=1e-12)
    moment = 5.0 * (p.slot_half_width - 0.5) + 2.0 * p.half_width
    moment -= 0.12 * (5.0 * (p.half_height - 0.05) + 2.0 * p.half_height)
    assert at.tilt == pytest.approx(moment / p.inertia, abs=1e-12)


@pytest.mark.parametrize("slip_at_corner", [False, True])
def test_under_one_face_the_slip_is_that_of_the_deciding_contact(
    device, constants, random_states, slip_at_corner
):
    p = constants(device)
    for state in random_states(10, seed=9):
        q = State(*state)
        mode = START._replace(corner=CLOSED, slip_at_corner=slip_at_corner)
        counts = corner_on_flat(1.0, q, p) if slip_at_corner else edge_on_face(1.0, q, p)
        at = motion(0.2, q, p, mode)
        assert at.support_slip == counts.slip
        assert at.support_drive == pytest.approx(0.0, abs=1e-9)  # and it sticks


# ----------------------------------------------------------------------------------------- sticking


@one_contact
def test_sticking_keeps_the_slip_acceleration_zero(device, constants, random_states, ours, theirs):
    p = constants(device)
    for state in random_states(20, seed=5):
        total, [(*_, friction, drive)] = Independent(0.6, state, device, Variants(), theirs).at()
        at = motion(0.6, State(*state), p, ours)
        assert drive == pytest.approx(0.0, abs=1e-9)
        assert at.support_friction == pytest.approx(friction, rel=1e-10, abs=1e-10)
        assert accelerations(at) == pytest.approx(total, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("side_slides", [False, True])
def test_two_contacts_sticking_keep_both_slips(device, constants, random_states, side_slides):
    p = constants(device)
    for state in random_states(20, seed=6):
        here = Independent(0.6, state, device, Variants(), BESIDE)
        sign = here.signs()[1] if side_slides else STICKING
        total, contacts = here.at(STICKING, sign)
        at = motion(0.6, State(*state), p, START._replace(side=CLOSED, side_slip=sign))
        assert accelerations(at) == pytest.approx(total, rel=1e-9, abs=1e-9)
        frictions = at.support_friction, at.side_friction
        assert frictions == pytest.approx([each[2] for each in contacts], rel=1e-9, abs=1e-9)
        drives = at.support_drive, at.side_drive
        assert drives == pytest.approx([each[3] for each in contacts], abs=1e-9)


def test_mobility_of_a_sliding_contact(device, constants, random_states):
    p = constants(device)
    for state in random_states(10, seed=7):
        mode = START._replace(support_slip=SLIP_POSITIVE)
        at = motion(0.6, State(*state), p, mode)
        # A unit force along e_t at the edge: 1 from the mass, (b - d)² / I from the inertia.
        depth = edge_on_face(RIGHT_EDGE, State(*state), p).depth
        mobility = 1.0 + (p.half_height - depth) ** 2 / p.inertia
        assert at.support_mobility == pytest.approx(mobility, rel=1e-12)
