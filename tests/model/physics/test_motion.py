"""Equations (3): each force alone, and their sum against a second right-hand side written here."""

from math import copysign, cos, hypot, pi, sin, tan

import numpy as np
import pytest

from model.physics.contacts import corner_on_flat, edge_on_face, edge_on_side
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


# ---------------------------------------------------------------- the sum, written a second time


def cross(r, force):
    return r[0] * force[1] - r[1] * force[0]


class Reference:
    """Equations (3) in vectors: unit directions, points, and r × F."""

    def __init__(self, time, state, parameters, readings):
        self.time, self.state = time, state
        self.set, self.readings = parameters, readings
        x, y, tilt, *rates = state
        self.centre, self.rates = np.array([x, y]), np.array(rates)
        self.e_t = np.array([cos(tilt), sin(tilt)])
        self.e_n = np.array([-sin(tilt), cos(tilt)])

    def printed(self, name):
        return getattr(self.readings, name) == "printed"

    def load(self, depth, rate):
        if self.printed("contact_damping_law"):
            rate = -hypot(*self.rates[:2])
        return self.set.contact_stiffness * depth + self.set.contact_damping * rate

    def velocity(self, r):
        return self.rates[:2] + self.rates[2] * np.array([-r[1], r[0]])

    def q(self, side):
        x, tilt = self.state[0], self.state[2]
        mirrored = (self.set.slot_half_width - side * x) / cos(tilt)
        return side * mirrored - self.set.half_height * tan(tilt)

    def with_sign(self, force):
        """Force on the bottom face as it enters (3): in print U1 has the other sign."""
        return force * [-1, 1] if self.printed("normal_sign") else force

    def face(self, side):
        """(load, slip, generalized force of a normal force n and a friction T) at an edge."""
        r = np.array([side * self.set.slot_half_width, 0.0]) - self.centre
        u = self.velocity(r)
        depth = self.set.half_height + r @ self.e_n

        def force(n, t):
            vector = n * self.e_n + t * self.e_t
            torque = cross(r, vector)
            if self.printed("moment_arms"):
                torque = self.q(side) * n + self.set.half_height * t
            return np.array([*self.with_sign(vector), torque])

        return self.load(depth, -u @ self.e_n), u @ self.e_t, force

    def side(self):
        r = np.array([-self.set.slot_half_width, 0.0]) - self.centre
        u = self.velocity(r)
        depth, rate = r @ self.e_t + self.set.half_width, -u @ self.e_t
        if self.printed("side_gap"):
            # D2 as printed, with y_A2 = 0 and y_D2 - y_B2 = 2b cos φ over the length 2b; its rate
            # by the chain rule through B2 and φ.
            own = -self.set.half_width * self.e_t - self.set.half_height * self.e_n
            corner, v = self.centre + own, self.velocity(own)
            bracket = -self.set.slot_half_width - corner[0] + corner[1]
            bracket_rate = v[1] - v[0]
            depth = self.e_t[0] * bracket
            rate = self.e_t[0] * bracket_rate - self.e_t[1] * self.rates[2] * bracket

        def force(n, t):
            if self.printed("side_force"):
                vector = self.with_sign(n * self.e_n + t * self.e_t)
                torque = self.q(LEFT_EDGE) * n + self.set.half_height * t
                return np.array([*vector, torque])
            vector = n * self.e_t + t * self.e_n
            return np.array([*vector, cross(r, vector)])

        slip = u @ (self.e_t if self.printed("side_force") else self.e_n)
        return self.load(depth, rate), slip, force

    def corner(self, side):
        r = side * self.set.half_width * self.e_t - self.set.half_height * self.e_n
        u = self.velocity(r)

        def force(n, t):
            return np.array([t, n, cross(r, [t, n])])

        return self.load(-(self.centre + r)[1], -u[1]), u[0], force

    def suspension(self):
        x, y, tilt = self.state[:3]
        dx, dy, dtilt = self.rates
        s = self.set
        rest_x = s.misalignment if s.rest_x is None else s.rest_x
        rest_y = s.half_height if s.rest_y is None else s.rest_y
        if self.printed("preload"):
            rest_y = 0.0
        wave = sin(s.frequency * self.time + s.phase)
        return np.array(
            [
                -s.lateral_damping * dx - s.lateral_stiffness * (x - rest_x),
                -s.axial_damping * dy - (y - rest_y) - s.press_force - wave,
                -s.tilt_damping * dtilt - s.tilt_stiffness * (tilt - s.rest_tilt),
            ]
        )

    def friction(self, load, slip):
        if self.printed("friction_law"):
            return self.set.friction * load
        return -self.set.friction * load * copysign(1.0, slip)

    def accelerations(self, *contacts):
        """Accelerations with all ``contacts`` sliding."""
        total = self.suspension()
        for load, slip, force in contacts:
            total = total + force(load, self.friction(load, slip))
        return total / [1.0, 1.0, self.set.inertia]


def slip_sign(reading, slip):
    # The printed law is T = +μ n: in the code's terms, a slip that is always negative.
    return SLIP_NEGATIVE if reading.friction_law == "printed" or slip < 0.0 else SLIP_POSITIVE


READINGS = {
    "consistent": Variants.consistent(),
    "printed": Variants.printed(),
    **{name: Variants(**{name: "printed"}) for name in VARIANT_NAMES},
}
every_reading = pytest.mark.parametrize("readings", READINGS.values(), ids=list(READINGS))


@every_reading
@pytest.mark.parametrize("edge", [RIGHT_EDGE, LEFT_EDGE])
@pytest.mark.parametrize("at_edge", [START, ON_CORNER], ids=["face", "corner"])
def test_sum_of_forces_on_one_sliding_contact(
    device, constants, random_states, at_edge, edge, readings
):
    p = constants(device, readings)
    signs = set()
    for state in random_states(30, seed=2):
        here = Reference(1.3, state, device, readings)
        contact = here.face(edge) if at_edge is START else here.corner(edge)
        sign = slip_sign(readings, contact[1])
        signs.add(np.sign(contact[1]))
        at = motion(1.3, State(*state), p, at_edge._replace(edge=edge, support_slip=sign))
        assert accelerations(at) == pytest.approx(here.accelerations(contact), rel=1e-11, abs=1e-11)
        assert (at.support_load, at.support_slip) == pytest.approx(
            contact[:2], rel=1e-11, abs=1e-11
        )
    assert signs == {-1.0, 1.0}  # both directions were tried


@every_reading
def test_sum_of_forces_with_face_and_side(device, constants, random_states, readings):
    p = constants(device, readings)
    for state in random_states(30, seed=3):
        here = Reference(0.4, state, device, readings)
        face, side = here.face(RIGHT_EDGE), here.side()
        mode = START._replace(
            support_slip=slip_sign(readings, face[1]),
            side=CLOSED,
            side_slip=slip_sign(readings, side[1]),
        )
        at = motion(0.4, State(*state), p, mode)
        expected = here.accelerations(face, side)
        assert accelerations(at) == pytest.approx(expected, rel=1e-11, abs=1e-11)
        assert (at.side_load, at.side_slip) == pytest.approx(side[:2], rel=1e-11, abs=1e-11)


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


def slip_acceleration(slip, state, at, h=1e-5):
    """d slip / dτ along the motion with the accelerations ``at``, by central difference.

    Error: h²/6 times a third derivative of up to 1e5 (tilt accelerations reach 50), and 1e-9 from
    rounding: a few 1e-6.
    """
    a = np.array(accelerations(at))
    ends = []
    for time in (h, -h):
        pose = state[:3] + time * state[3:] + 0.5 * time**2 * a
        ends.append(slip(State(*pose, *(state[3:] + time * a))))
    return (ends[0] - ends[1]) / (2 * h)


STICKY = [
    ("face", START, lambda p: lambda q: edge_on_face(RIGHT_EDGE, q, p).slip),
    (
        "left face",
        START._replace(edge=LEFT_EDGE),
        lambda p: lambda q: edge_on_face(-1.0, q, p).slip,
    ),
    ("corner", ON_CORNER, lambda p: lambda q: corner_on_flat(1.0, q, p).slip),
]


@pytest.mark.parametrize(("name", "mode", "slip"), STICKY, ids=[case[0] for case in STICKY])
def test_sticking_keeps_the_slip_acceleration_zero(
    device, constants, random_states, name, mode, slip
):
    p = constants(device)
    for state in random_states(20, seed=5):
        at = motion(0.6, State(*state), p, mode)
        assert slip_acceleration(slip(p), state, at) == pytest.approx(0.0, abs=1e-5)
        # The sticking force acts like sliding friction: the same sum with T in place of ∓μ n.
        here = Reference(0.6, state, device, Variants())
        edge = mode.edge
        load, _, force = here.face(edge) if name != "corner" else here.corner(edge)
        total = here.suspension() + force(load, at.support_friction)
        expected = total / [1.0, 1.0, device.inertia]
        assert accelerations(at) == pytest.approx(expected, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("side_slides", [False, True])
def test_two_contacts_sticking_keep_both_slips(device, constants, random_states, side_slides):
    p = constants(device)
    for state in random_states(20, seed=6):
        here = Reference(0.6, state, device, Variants())
        side_slip = here.side()[1]
        side_state = slip_sign(here.readings, side_slip) if side_slides else STICKING
        mode = START._replace(side=CLOSED, side_slip=side_state)
        at = motion(0.6, State(*state), p, mode)
        face = slip_acceleration(lambda q: edge_on_face(RIGHT_EDGE, q, p).slip, state, at)
        side = slip_acceleration(lambda q: edge_on_side(LEFT_EDGE, q, p).slip, state, at)
        # Both tangents are nearly perpendicular: G is far from singular, but forces reach 100.
        assert face == pytest.approx(0.0, abs=1e-4)
        assert at.support_drive == pytest.approx(0.0, abs=1e-9)
        if side_slides:
            limit = device.friction * at.side_load
            assert at.side_friction == pytest.approx(-copysign(1, side_slip) * limit, abs=1e-9)
            assert at.side_drive == pytest.approx(side, abs=1e-4)
        else:
            assert side == pytest.approx(0.0, abs=1e-4)
            assert at.side_drive == pytest.approx(0.0, abs=1e-9)


def test_drive_and_mobility_of_a_sliding_contact(device, constants, random_states):
    p = constants(device)
    for state in random_states(10, seed=7):
        mode = START._replace(support_slip=SLIP_POSITIVE)
        at = motion(0.6, State(*state), p, mode)
        drive = slip_acceleration(lambda q: edge_on_face(RIGHT_EDGE, q, p).slip, state, at)
        assert at.support_drive == pytest.approx(drive, abs=1e-5)
        # A unit force along e_t at the edge: 1 from the mass, (b - d)² / I from the inertia.
        depth = edge_on_face(RIGHT_EDGE, State(*state), p).depth
        mobility = 1.0 + (p.half_height - depth) ** 2 / p.inertia
        assert at.support_mobility == pytest.approx(mobility, rel=1e-12)


# ---------------------------------------------------------------------------------- mirror symmetry
