"""Round parts against closed forms: the largest misalignment, slow pushes, and the vertex."""

from math import cos, hypot, pi, sin, sqrt, tan

import numpy as np
import pytest

from model.physics.contacts import corner_on_flat, tips_on_face
from model.physics.geometry import edge_place
from model.physics.modes import CLOSED, OPEN, STICKING
from model.physics.notation import RIGHT_EDGE, State
from vibralign import Batch, Outcome, align

LOCKED = 1e12


@pytest.fixture(scope="module")
def bare(device):
    """A part of radius 1 pressed with 1 on a stiff, dead base, without springs or vibration."""
    return device.replace(
        half_width=1.0, half_height=4.0, inertia=15.0, clearance=0.04, lateral_stiffness=0.0,
        tilt_stiffness=0.0, lateral_damping=0.0, axial_damping=0.0, tilt_damping=0.0, friction=1.0,
        contact_stiffness=1e5, contact_damping=600.0, press_force=1.0, frequency=0.0, rest_y=4.0,
    )  # fmt: skip


@pytest.mark.parametrize("tilt", [1e-3, 0.03, 0.1])
def test_the_press_alone_tilts_a_part_up_to_the_largest_misalignment(bare, tilt):
    """The mass centre is right over the tips at √(l² - a² + (b tan φ)²).

    The part falls back or tilts on, exponentially. On this base it stands 1e-5 deep, which moves
    the tips by the half of 1e-5 / φ, 0.5 % of their place at the smallest tilt.
    """
    largest = hypot(sqrt(1.04**2 - 1.0), 4.0 * tan(tilt))
    shares = np.array([0.98, 1.02])
    parts = Batch.of(bare.replace(initial_tilt=tilt), misalignment=shares * largest)
    found = align(parts, shape="round", horizon=20.0)
    assert (found.tilt_max > 1.2 * tilt).tolist() == [True, False]
    assert found.outcome[1] != Outcome.ALIGNED


def rims(x, tilt, p):
    """Return (y, normal) of a part whose rims just touch, by bisection.

    ``normal`` is the unit vector, shape (3,), perpendicular to both rims at one of the tips.
    """
    s, c, hole = sin(tilt), cos(tilt), 1.0 + p.clearance
    low, high = x, hole
    for _ in range(60):  # where the point of the hole's rim, on the face, is a radius off its axis
        rim_x = 0.5 * (low + high)
        y = (p.half_height - (rim_x - x) * s) / c
        along = (rim_x - x) * c - y * s
        outside = along * along + hole * hole - rim_x * rim_x > 1.0
        low, high = (rim_x, high) if outside else (low, rim_x)
    z = sqrt(hole * hole - rim_x * rim_x)
    normal = np.cross([-z, 0.0, rim_x], [-z * c, -z * s, along])
    normal *= np.sign(normal[1]) / np.linalg.norm(normal)
    return y, normal


@pytest.mark.parametrize("outward", [True, False], ids=["outward", "inward"])
@pytest.mark.parametrize("x", [-0.22, -0.1, 0.05])
def test_a_slow_push_slides_tips_at_the_friction_of_the_wedge(stepped_run, bare, x, outward):
    """Both tips take push and press by normal forces of n in all, and by friction in the plane.

    In the plane they press by n/w, so that the part slides where the force is beyond the friction
    angle atan(μ w) against the normal there. The press changes slowly under a push that does not.
    The base is 3e-5 deep, some 3e-4 of the tips' places.
    """
    tilt, slow = 0.08, 1e-2
    y, normal = rims(x, tilt, bare)
    wedge = 1.0 / hypot(*normal[:2])
    slope = -normal[0] / normal[1]
    friction = (0.15 if outward else -0.15) * wedge
    ratio = (slope + friction) / (1.0 - slope * friction)  # push over press where it slides
    rises = ratio > 0.0 and not outward  # the press: away from where the part sticks
    push, start = 2.0 * ratio, 1.0 if rises else 3.0
    p = bare.replace(
        inertia=LOCKED, friction=0.15, misalignment=0.2, initial_tilt=tilt, press_force=2.0,
        frequency=slow, phase=-0.5 * pi if rises else 0.5 * pi, rest_y=y,
        lateral_stiffness=1e-6, rest_x=x + push * 1e6,
    )  # fmt: skip
    plane = normal[:2] * wedge
    load = wedge * (start * plane[1] - push * plane[0])
    sunk = load / p.contact_stiffness / (normal @ [-sin(tilt), cos(tilt), 0.0])
    state = np.array([x + sunk * sin(tilt), y - sunk * cos(tilt), tilt, 0.0, 0.0, 0.0])
    run = stepped_run(
        p, state, horizon=pi / slow, shape="round",
        until=lambda run: run.steps[-1].end_mode.support_slip != STICKING,
    )  # fmt: skip
    end = run.steps[-1]
    assert end.end_mode.support_slip == (1 if outward else -1)
    press = 2.0 + sin(slow * end.end + p.phase)
    assert push / press == pytest.approx(ratio, rel=2e-3)
    found = tips_on_face(RIGHT_EDGE, State(*end.end_state), run.p)
    # Both normal forces in all, by the factor more than what they press in the plane.
    expected = wedge * (press * plane[1] - push * plane[0])
    assert run.p.contact_stiffness * found.depth == pytest.approx(expected, rel=2e-3)


def test_the_tips_merge_at_the_vertex_where_the_part_aligns(stepped_run, bare):
    """They meet in the edge; the part then aligns by the conditions of a plane part."""
    p = bare.replace(
        inertia=LOCKED, initial_tilt=0.08, misalignment=0.1, friction=0.02, lateral_damping=5.0
    )
    run = stepped_run(p, horizon=100.0, shape="round")
    assert run.outcome is Outcome.ALIGNED
    end = next(step for step in run.steps if step.end == run.tau_align)
    assert end.mode.face == CLOSED
    x, y, tilt = end.end_state[:3]
    edge = edge_place(RIGHT_EDGE, x, y, tilt, run.p)
    assert edge.along_face == pytest.approx(p.half_width, abs=1e-9)
    tips = tips_on_face(RIGHT_EDGE, State(*end.end_state), run.p)
    assert tips.along == pytest.approx(p.half_width, abs=1e-9)
    b2 = x - cos(tilt) + 4.0 * sin(tilt), y - sin(tilt) - 4.0 * cos(tilt)
    assert b2[0] > -p.slot_half_width
    assert b2[1] < 0.0


def test_the_load_passes_from_tips_to_the_rim_and_back_as_the_tilt_passes_zero(stepped_run, bare):
    """Without damping of the base nothing jumps; the part rocks on both."""
    p = bare.replace(
        misalignment=0.32, friction=0.3, contact_stiffness=3e3, contact_damping=0.0,
        tilt_damping=0.5, tilt_stiffness=0.05, frequency=2.0, initial_tilt=1e-3, press_force=2.0,
        axial_damping=0.2,
    )  # fmt: skip
    run = stepped_run(p, horizon=60.0, shape="round")

    def load(state, mode):
        q, found = State(*state), 0.0
        if mode.face == CLOSED:
            found += tips_on_face(mode.edge, q, run.p).depth
        if mode.corner == CLOSED:
            found += corner_on_flat(mode.edge, q, run.p).depth - mode.corner_offset
        return p.contact_stiffness * found

    for step in run.steps:
        was, now = load(step.end_state, step.mode), load(step.end_state, step.end_mode)
        assert now == pytest.approx(was, abs=1e-8)
    landings = run.mode_changes("corner", OPEN, CLOSED)
    assert sum(step.mode.face == CLOSED for step in landings) > 5
    assert max(abs(step.end_state[2]) for step in landings) < 1e-3
    assert run.mode_changes("corner", CLOSED, OPEN)
