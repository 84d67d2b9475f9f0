"""Tips of a round part: the rims are circles in space, and the tips are found by a root search.

No formula of the page on round parts is used: tips are where a rim crosses the other as seen along
the axis of the part, normals are perpendicular to both rims, rates are central differences.
"""

from math import cos, hypot, pi, sin, sqrt, tan

import numpy as np
import pytest
from scipy.optimize import brentq

from model.events.event_functions import before_face_end, tips_outside
from model.events.sources import corner_positions, face_state
from model.physics.contacts import edge_on_face, tips_on_face
from model.physics.geometry import (
    crescent,
    edge_place,
    farthest_tilted,
    lever_doubt,
    lever_if_flat,
    press_lever,
    resting_height,
    tips_depth,
)
from model.physics.modes import CLOSED, OPEN, RELEASED, START
from model.physics.motion import motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.parameters import Constants, RoundConstants
from verification.independent.motion import Mode
from verification.independent.round import RoundDevice

STEP = 1e-5
EXACT = 1e-12
SIDES = pytest.mark.parametrize("side", [RIGHT_EDGE, LEFT_EDGE], ids=["right", "left"])


@pytest.fixture(scope="module")
def p(device, constants):
    """A part of radius 1 with its mass centre 4 over the face, in a hole of radius 1.1."""
    changed = device.replace(half_width=1.0, half_height=4.0, clearance=0.1)
    return RoundConstants(*constants(changed))


class Rims:
    """Part and hole in one pose, tilted towards the hole on ``side``."""

    def __init__(self, pose, p, side=RIGHT_EDGE):
        x, y, tilt = pose[:3]
        self.centre = np.array([x, y, 0.0])
        self.along = np.array([cos(tilt), sin(tilt), 0.0])
        self.up = np.array([-sin(tilt), cos(tilt), 0.0])
        self.p, self.side = p, side
        self.angle = self.crossing()

    def hole(self, angle):
        """Point of the hole's rim; angle 0 is the edge on the side."""
        radius = self.p.slot_half_width
        return radius * np.array([self.side * cos(angle), 0.0, sin(angle)])

    def place(self, angle):
        """(along the face, along the axis, across) of a point of the hole's rim in the part."""
        r = self.hole(angle) - self.centre
        return r @ self.along, r @ self.up, r[2]

    def outside(self, angle):
        xi, _, z = self.place(angle)
        return hypot(xi, z) - self.p.half_width

    def crossing(self):
        """Angle of the tip with Z > 0, where the rim passes from outside the part to inside."""
        return brentq(self.outside, 0.0, pi, xtol=1e-16, rtol=4 * np.finfo(float).eps)

    @property
    def tip(self):
        return self.hole(self.angle)

    @property
    def behind(self):
        """Depth of the tips behind the face."""
        return self.p.half_height + self.place(self.angle)[1]

    @property
    def normal(self):
        """Unit vector perpendicular to both rims at the tip, upward."""
        xi, _, z = self.place(self.angle)
        own = -z * self.along + np.array([0.0, 0.0, xi])
        across = np.cross(np.array([-self.tip[2], 0.0, self.tip[0]]), own)
        across /= np.linalg.norm(across)
        return across if across[1] > 0.0 else -across

    @property
    def tangent(self):
        """Unit vector in the plane, perpendicular to the normals of both tips, to the right."""
        x, y, _ = self.normal
        return np.array([y, -x, 0.0]) / hypot(x, y)


def poses(count, side=RIGHT_EDGE):
    """Return states over the rim with tips, small depths, and the tilt towards the hole."""
    rng, found = np.random.default_rng(3), []
    while len(found) < count:
        x, tilt, lower = rng.uniform((-0.4, 0.01, -0.02), (0.9, 0.5, 0.02))
        y = (4.0 - (1.05 - x) * sin(tilt)) / cos(tilt) - lower
        edge = (1.1 - x) * cos(tilt) - y * sin(tilt)
        if abs(edge) < 0.9:
            rates = rng.uniform(-1.0, 1.0, 3)
            found.append(State(side * x, y, side * tilt, *rates.tolist()))
    return found


def touching(state, p, side):
    """Return the state, lifted until its rims just touch, and the ``Rims`` there."""
    rims = Rims(state, p, side)
    while abs(rims.behind) > 1e-14:
        state = state._replace(y=state.y + rims.behind / cos(state.tilt))
        rims = Rims(state, p, side)
    return state, rims


def moved(state, time):
    """State after ``time`` without accelerations."""
    pose = np.asarray(state[:3]) + time * np.asarray(state[3:])
    return State(*pose.tolist(), *state[3:])


def rate(function, state):
    return (function(moved(state, STEP)) - function(moved(state, -STEP))) / (2 * STEP)


@SIDES
def test_tips_are_where_the_rims_cross(p, side):
    for state in poses(30, side):
        rims = Rims(state, p, side)
        s, c = sin(side * state.tilt), cos(state.tilt)
        found = crescent(side * state.x, state.y, s, c, p)
        assert side * found.rim_x == pytest.approx(rims.tip[0], abs=EXACT)
        assert found.behind == pytest.approx(rims.behind, abs=EXACT)
        # Q has the sign of the depth, and vanishes with it.
        assert side * tips_depth(state.x, state.y, state.tilt, p) * rims.behind > 0.0
        along = tips_on_face(side, state, p).along
        assert along == pytest.approx(rims.place(rims.angle)[0], abs=EXACT)


def test_no_other_point_of_the_hole_is_as_deep_behind_the_face(p):
    for state in poses(10):
        rims = Rims(state, p)
        angles = np.linspace(0.0, pi, 2001)
        places = np.array([rims.place(angle) for angle in angles])
        under = np.hypot(places[:, 0], places[:, 2]) <= p.half_width
        assert under.any()
        assert (p.half_height + places[under, 1]).max() <= rims.behind + EXACT


@SIDES
def test_the_force_is_along_the_common_normal_of_both_rims(p, side):
    for sunken in poses(30, side):
        # Where the rims just touch, the arm of the normal is that of a force at the tip.
        state, rims = touching(sunken, p, side)
        contact = tips_on_face(side, state, p)
        arm = rims.tip - rims.centre
        moment = arm[0] * rims.normal[1] - arm[1] * rims.normal[0]
        assert contact.normal == pytest.approx((*rims.normal[:2], moment), abs=1e-10)
        assert contact.depth == pytest.approx(0.0, abs=1e-10)
        # A part that sinks by 1e-6 along its axis penetrates by less along the normal.
        sunk = state._replace(x=state.x - 1e-6 * rims.up[0], y=state.y - 1e-6 * rims.up[1])
        depth = tips_on_face(side, sunk, p).depth
        assert depth == pytest.approx(1e-6 * (rims.normal @ rims.up), rel=1e-4)


@SIDES
@pytest.mark.parametrize("slides", [-1, 0, 1])
def test_tips_press_slip_and_stick_as_in_the_independent_solution(device, p, side, slides):
    """There the normal is the gradient of the depth by complex steps, and the drift of the slip."""
    theirs = RoundDevice(device.replace(half_width=1.0, half_height=4.0, clearance=0.1))
    ours, their_mode = START._replace(edge=side, support_slip=slides), Mode(side, slides=slides)
    for state in poses(30, side):
        force, turn, groups, frictions, drives = theirs.rates(0.3, np.array(state), their_mode)
        ((touch,), _, _, load), _ = groups
        at, contact = motion(0.3, state, p, ours), tips_on_face(side, state, p)
        assert (at.x, at.y, at.tilt) == pytest.approx((force.real, force.imag, turn), rel=1e-9)
        found = at.support_load, at.support_friction, at.support_slip, contact.depth, contact.slip
        expected = load, frictions[0], touch.slip, touch.depth, touch.slip
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
        assert at.support_drive == pytest.approx(drives[0], rel=1e-9, abs=1e-9)
        assert contact.slip_row == contact.tangent


# -------------------------------------------------------------------- the vertex, and the other end


def with_edge_at(along, tilt, p):
    """State without rates in which A1 is on the face, at ``along`` of it."""
    s, c = sin(tilt), cos(tilt)
    return State(
        p.slot_half_width - along * c - p.half_height * s, -along * s + p.half_height * c,
        tilt, 0.0, 0.0, 0.0,
    )  # fmt: skip


@pytest.mark.parametrize("tilt", [0.01, 0.1, 0.4])
def test_tips_merge_in_the_edge_where_it_reaches_the_end_of_the_face(p, tilt):
    q = with_edge_at(p.half_width, tilt, p)
    tips, edge = tips_on_face(RIGHT_EDGE, q, p), edge_on_face(RIGHT_EDGE, q, p)
    found = crescent(q.x, q.y, sin(tilt), cos(tilt), p)
    assert found.rim_x == pytest.approx(p.slot_half_width, abs=EXACT)
    assert tips.along == pytest.approx(edge.along, abs=EXACT)
    assert tips.depth == pytest.approx(edge.depth, abs=EXACT)
    # The normal is not that of the face.
    lying, standing = p.slot_half_width * sin(tilt), p.slot_half_width * cos(tilt) - p.half_width
    expected = np.array([-lying, standing]) / hypot(lying, standing)
    assert tips.normal[:2] == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("tilt", [0.01, 0.1, 0.4])
def test_tips_end_where_the_face_lies_inside_the_hole(p, tilt):
    """The contact of the face ends on the edge's place, as a plane part's does: with the tips."""
    for along, ends in [(0.999, False), (1.001, True)]:
        q = with_edge_at(along * p.half_width, tilt, p)
        state = face_state(0.0, q, p, START)
        assert (before_face_end(state, p, START) < 0.0) == ends
        assert state.along == edge_place(RIGHT_EDGE, q.x, q.y, tilt, p).along_face
        if not ends:
            # Just before it, the tips are close to the vertex, and nearly as deep.
            rims = Rims(q, p)
            assert rims.tip[0] == pytest.approx(p.slot_half_width, abs=0.02)
            assert state.depth * rims.behind >= -EXACT


@SIDES
def test_tips_begin_to_press_where_they_meet_the_face(p, side):
    for sunken in poses(30, side):
        state, _ = touching(sunken, p, side)
        for lift, presses in [(-1e-9, True), (1e-9, False), (-1e-3, True), (1e-3, False)]:
            places = corner_positions(state._replace(y=state.y + lift), p)
            assert (max(tips_outside(side, places, p, START)) < 0.0) == presses


@SIDES
def test_an_edge_less_far_behind_the_side_than_the_face_meets_the_side(p, side):
    for tilt in (0.05, 0.2):
        for beside, sunk, presses in [(1e-4, 1e-2, False), (1e-1, 1e-5, True)]:
            q = with_edge_at(p.half_width - beside, tilt, p)
            q = q._replace(x=side * (q.x + sunk * sin(tilt)), y=q.y - sunk * cos(tilt))
            places = corner_positions(q._replace(tilt=side * tilt), p)
            assert (max(tips_outside(side, places, p, START)) < 0.0) == presses


def test_released_tips_push_nothing(p):
    state = poses(1)[0]
    free = motion(0.3, state, p, START._replace(face=OPEN))
    assert motion(0.3, state, p, START._replace(face=RELEASED)) == free
    assert motion(0.3, state, p, START._replace(face=CLOSED)) != free


# ------------------------------------------------------------------------------------ at the start


@pytest.mark.parametrize(("misalignment", "tilt"), [(0.3, 1e-3), (0.4, 0.05), (0.2, 0.2)])
def test_the_press_pushes_with_the_lever_of_the_tips(p, misalignment, tilt):
    start = p._replace(misalignment=misalignment, initial_tilt=tilt)
    pose = misalignment, resting_height(start), tilt
    rims = Rims(pose, p)
    assert rims.behind == pytest.approx(0.0, abs=1e-11)
    assert press_lever(start) == pytest.approx(rims.tip[0] - misalignment, abs=1e-11)


@pytest.mark.parametrize("shape", ["square", "round"])
def test_the_lever_of_a_flat_part_is_that_without_a_tilt(p, shape):
    flat = p._replace(misalignment=0.3, initial_tilt=0.0)
    flat = flat if shape == "round" else Constants(*flat)
    assert lever_if_flat(1.0, 1.1, 0.3, shape) == pytest.approx(press_lever(flat), rel=EXACT)


@pytest.mark.parametrize("tilt", [1e-3, 0.05, 0.2])
def test_the_press_has_no_lever_at_the_largest_misalignment(p, tilt):
    """There the tips stand right under the mass centre, as in the plane of the centre's height.

    The mass centre is b tan φ along the face from the point above which it stands, so that the
    half chord of the face there is √(a² - (b tan φ)²) and that of the hole √(l² - x²).
    """
    largest = farthest_tilted(p._replace(initial_tilt=tilt))
    chord = sqrt(p.half_width**2 - (p.half_height * tan(tilt)) ** 2)
    assert chord == pytest.approx(sqrt(p.slot_half_width**2 - largest**2), rel=EXACT)
    for share, towards in [(0.999, 1.0), (1.001, -1.0)]:
        lever = press_lever(p._replace(initial_tilt=tilt, misalignment=share * largest))
        assert lever * towards > 0.0


def test_the_doubt_of_the_lever_is_the_overlap_of_the_rims(p):
    """Rims that overlap by the depth d do so over a length of a d / x, x the face's middle."""
    down = p.half_height * sin(p.initial_tilt)
    soft = p._replace(misalignment=0.3 - down, press_force=2.0, contact_stiffness=3000.0)
    gap, x = p.slot_half_width**2 - p.half_width**2, 0.3
    lever, depth = (gap - x * x) / (2.0 * x), 3.0 / 3000.0
    assert lever_doubt(soft) == pytest.approx(p.half_width * depth / x / lever, rel=EXACT)
    far = p._replace(misalignment=1.01 * sqrt(gap))
    assert lever_doubt(far) == np.inf
