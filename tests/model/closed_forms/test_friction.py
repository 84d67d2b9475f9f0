"""Dry friction: an oscillator that comes to rest, and a part that creeps under vibration.

Sources: the oscillator is J. P. Den Hartog's, Trans. ASME 53 (1931) 107; the creep is I. I.
Blekhman, Vibrational Mechanics (2000), the mean of friction under a fast longitudinal vibration.
"""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from model.physics.geometry import edge_place
from model.physics.modes import START, STICKING
from model.physics.notation import RIGHT_EDGE

LOCKED = 1e12


def test_coulomb_oscillator_comes_to_rest_where_it_must(stepped_run, device):
    # m = k = μN = 1, from x = 12 at v = 6. Each half period is a half circle in the plane of x and
    # v about x = -sign(v): about -1 with radius √(13² + 6²) = √205 first, then 2 less each. It
    # turns at √205 - 1, 3 - √205, … and sticks at the first |x| <= 1: 15 - √205.
    far = 50.0  # the edge stays on one side of the mass centre, so that the part never rocks
    p = device.replace(
        half_width=100.0, half_height=1.0, inertia=1e4 * LOCKED, initial_tilt=0.0, friction=0.25,
        press_force=4.0, frequency=0.0, lateral_stiffness=1.0, lateral_damping=0.0,
        axial_damping=0.0, tilt_damping=0.0, tilt_stiffness=0.0, clearance=0.01, misalignment=10.0,
    )  # fmt: skip
    centre = p.slot_half_width - far
    p = p.replace(rest_x=centre)
    # In the base as deep as it must be to carry the weight: n + depth = f0 with n = k_a depth.
    depth = 4.0 / 101.0
    p = p.replace(friction=1.0 / (100.0 * depth))
    state = np.array([centre + 12.0, p.half_height - depth, 0.0, 6.0, 0.0, 0.0])
    run = stepped_run(p, state, START._replace(support_slip=1), horizon=30.0)
    x, radius = run.state[:, 0] - centre, sqrt(205.0)
    turns = [step for step in run.steps if step.mode.support_slip != step.end_mode.support_slip]
    expected = [(-1) ** i * (radius - 1.0 - 2.0 * i) for i in range(8)]
    assert [step.end_state[0] - centre for step in turns] == pytest.approx(expected, abs=1e-8)
    # A quarter circle and what the start lies before it, then half circles.
    first = pi / 2 - np.arctan2(13.0, 6.0)
    times = [first + pi * i for i in range(8)]
    assert [step.end for step in turns] == pytest.approx(times, abs=1e-9)
    assert run.steps[-1].mode.support_slip == STICKING
    assert x[-1] == pytest.approx(15.0 - radius, abs=1e-8)
    assert abs(run.state[-1, 3]) < 1e-12


TILT, CREEP_FREQUENCY = pi / 2 - 2e-3, 1e4
PERIOD = 2 * pi / CREEP_FREQUENCY


@pytest.fixture(scope="module")
def creep(stepped_run, device):
    """Mean velocity along the face over Aω, at a slope of tan α = ``slope`` times ``friction``."""

    def make(slope, friction):
        # The part lies on its side, tilted until its bottom face is all but upright, and locked:
        # the excitation is then along the face. The lateral spring, relaxed far away, presses it
        # on the edge with N = 1, the press force pulls it along with tan α.
        along = slope * friction
        pull = sin(TILT) + along * cos(TILT), -cos(TILT) + along * sin(TILT)
        p = device.replace(
            half_height=0.1, inertia=LOCKED, initial_tilt=TILT, rest_tilt=TILT, tilt_damping=0.0,
            friction=friction, press_force=-pull[1], frequency=CREEP_FREQUENCY, phase=pi / 2,
            lateral_stiffness=1e-9, lateral_damping=0.0, axial_damping=0.0,
            contact_stiffness=1e4, contact_damping=10.0,
        )  # fmt: skip
        # The mass centre behind the edge, b - N/k_a from it along the face's normal.
        away = p.half_height - 1.0 / p.contact_stiffness
        x, y = p.slot_half_width - away * sin(TILT), away * cos(TILT)
        p = p.replace(rest_x=x + 1e9 * pull[0], rest_y=y)
        # A start that is a fifth too slow; what is off decays within (π/2) Aω/μN = 25 periods.
        start = 0.8 * sin(pi * slope / 2.0) / CREEP_FREQUENCY
        periods, last = 150, 50
        run = stepped_run(
            p, np.array([x, y, TILT, 0.0, start, 0.0]), START._replace(support_slip=1),
            horizon=periods * PERIOD, tolerance=1e-13,
        )  # fmt: skip
        place = edge_place(RIGHT_EDGE, x, y, TILT, run.p).along_face
        assert abs(place) < 1e-3
        begin = (periods - last) * PERIOD
        step = next(each for each in run.steps if each.end > begin)
        part = (begin - step.time) / (step.end - step.time)
        ((_, q),) = run.places(step, np.array([part]))
        way = run.state[-1, :2] - (q.x, q.y)
        moved = way[0] * cos(TILT) + way[1] * sin(TILT)
        return moved / (last * PERIOD) * CREEP_FREQUENCY

    return make


@pytest.mark.parametrize("slope", [0.0, 0.3, 0.6, 0.9])
def test_vibro_creep(creep, slope):
    # V = Aω sin(π tan α/2μ), where friction is weak against the vibration: μN/Aω² = 0.01 here.
    assert creep(slope, 0.01) == pytest.approx(sin(pi * slope / 2.0), abs=5e-3)
