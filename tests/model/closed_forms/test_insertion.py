"""A peg in the slot: depth of two-point contact, wedging, jamming, and the energy of a smooth fall.

D. E. Whitney, J. Dyn. Syst. Meas. Control 104 (1982) 65-77. A peg of width d = 2a, tilted by θ in a
hole of width D = 2l, touches both sides at the depth h with D = d cos θ + h sin θ. It is wedged
where friction can hold it between the two points: μ d sin θ >= D - d cos θ, about θ >= c/μ. It is
jammed while the press stays below the friction that the lateral force of its suspension causes.
"""

from math import acos, atan, cos, hypot, radians, sin

import numpy as np
import pytest

from model.events.event_functions import edge_inside
from model.events.friction import decide_friction
from model.events.outcomes import Reason
from model.events.sources import corner_positions
from model.physics.contacts import corner_on_wall, edge_on_face, edge_on_side
from model.physics.modes import CLOSED, OPEN, START, STICKING
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from vibralign import INSERTION, Outcome

LOCKED = 1e12  # an inertia with which nothing turns the peg
NEVER = {"insertion_depth": 1e3}
FREE = START._replace(face=OPEN, dropped=True, corners_inside=True)


@pytest.fixture
def peg(device):
    def make(**changes):
        bare = {
            "half_width": 1.0, "half_height": 4.0, "misalignment": 0.2, "lateral_stiffness": 0.0,
            "lateral_damping": 0.0, "axial_damping": 0.0, "tilt_damping": 0.0, "friction": 0.0,
            "tilt_stiffness": 0.0, "press_force": 0.0, "frequency": 0.0, "contact_stiffness": 1e6,
        }  # fmt: skip
        return device.replace(**bare | changes)

    return make


def placed(parameters, tilt, corner_x, corner_y):
    """State at rest, tilted by ``tilt`` > 0, with the corner B1 at (``corner_x``, ``corner_y``)."""
    a, b = parameters.half_width, parameters.half_height
    x = corner_x - a * cos(tilt) - b * sin(tilt)
    y = corner_y - a * sin(tilt) + b * cos(tilt)
    return np.array([x, y, tilt, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("side", [RIGHT_EDGE, LEFT_EDGE])
@pytest.mark.parametrize(("degrees", "clearance"), [(2.0, 0.02), (5.0, 0.09), (10.0, 0.09)])
def test_two_point_contact_depth(stepped_run, peg, side, degrees, clearance):
    tilt, away = radians(degrees), 1e-9  # from the wall
    wide = 2.0 * (1.0 + clearance)
    depth = (wide - away - 2.0 * cos(tilt)) / sin(tilt)
    begins = 0.5 * (depth + wide * sin(tilt))
    corner_y = ((wide - away) * sin(tilt) - begins) / cos(tilt)
    mirror = np.array([side, 1.0, side] * 2)
    device = peg(clearance=clearance, inertia=LOCKED)
    state = placed(device, tilt, 0.5 * wide - away, corner_y)
    device = device.replace(rest_y=state[1], press_force=3.0)
    run = stepped_run(
        device, mirror * state, FREE, horizon=10.0, scene=INSERTION, tau_align=0.0, **NEVER,
        until=lambda run: run.steps[-1].end_mode != FREE,
    )  # fmt: skip
    mode, q = run.steps[-1].end_mode, State(*run.state[-1])
    assert (mode.side if side == RIGHT_EDGE else mode.face) == CLOSED  # opposite of the corner
    assert mode.in_slot == (side == LEFT_EDGE)
    assert edge_inside(-side, corner_positions(q, run.p), run.p)[0] == pytest.approx(
        depth, rel=1e-9
    )


@pytest.mark.parametrize(("friction", "clearance"), [(0.1, 2e-3), (0.3, 2e-3), (0.3, 2e-2)])
@pytest.mark.parametrize("factor", [1.001, 0.999])
def test_wedging_limit(stepped_run, constants, peg, friction, clearance, factor):
    load, wide = 1e-3, 2.0 * (1.0 + clearance)
    limit = atan(friction) - acos((1.0 + clearance) / hypot(1.0, friction))
    tilt = factor * limit
    assert limit == pytest.approx(clearance / (1.0 + clearance) / friction, rel=limit / friction)
    device = peg(friction=friction, clearance=clearance, inertia=1.0)
    # Loads in balance are as the two places' lever arms: d on the side, D on the wall.
    at_edge, in_wall = load * 2.0 / 1e6, load * wide / 1e6
    corner_y = (2.0 - at_edge - (wide + in_wall) * cos(tilt)) / sin(tilt)
    state = placed(device, tilt, 0.5 * wide + in_wall, corner_y)
    device = device.replace(rest_x=state[0], rest_y=state[1])
    mode = FREE._replace(in_slot=True, corner=CLOSED, side=CLOSED, slip_at_corner=True)
    assert mode.support_slip == mode.side_slip == STICKING
    held, possible = decide_friction(0.0, State(*state), constants(device), mode, True, True)
    assert possible
    slips = sorted(abs(slip) for slip in (held.support_slip, held.side_slip))
    assert slips == ([0, 0] if factor > 1.0 else [0, 1])  # STICKING is 0
    run = stepped_run(device, state, mode, horizon=20.0, scene=INSERTION, tau_align=0.0, **NEVER)
    if factor > 1.0:
        assert (run.outcome, run.reason) == (Outcome.JAMMED, Reason.WEDGED)
        assert run.state[-1] == pytest.approx(state, abs=1e-10)
    else:
        assert run.reason is not Reason.WEDGED
        assert run.state[:, 1].max() > state[1] + 1e-9  # outward


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_jammed_by_too_little_force(stepped_run, peg, factor):
    friction, push = 0.2, 3.0  # by the lateral spring, onto the right side of the slot
    device = peg(friction=friction, inertia=1e16, lateral_stiffness=1.0, contact_stiffness=1e4)
    depth = push / 2e4  # half on A1, half on B1
    state = placed(device, 0.0, 1.09 + depth, -2.0)
    device = device.replace(
        rest_x=state[0] + push, rest_y=state[1], press_force=factor * friction * push
    )
    mode = FREE._replace(in_slot=True, face=CLOSED, corner=CLOSED)
    run = stepped_run(device, state, mode, horizon=60.0, scene=INSERTION, tau_align=0.0, **NEVER)
    if factor < 1.0:
        assert (run.outcome, run.reason) == (Outcome.JAMMED, Reason.LACK_OF_FORCE)
        assert run.state[-1] == pytest.approx(state, abs=1e-9)
    else:
        # It slides until the axial spring takes the rest of the press: twice the excess, undamped.
        excess = (factor - 1.0) * friction * push
        assert state[1] - run.state[:, 1].min() == pytest.approx(2.0 * excess, rel=1e-6)


def test_energy_of_a_smooth_part_that_slides_in(stepped_run, device):
    smooth = device.replace(
        friction=0.0, contact_damping=0.0, lateral_damping=0.0, axial_damping=0.0,
        tilt_damping=0.0, frequency=0.0, tilt_stiffness=10.0, half_height=2.0, inertia=3.0,
    )  # fmt: skip
    run = stepped_run(smooth, horizon=300.0, scene=INSERTION)
    p = run.p
    assert run.outcome is Outcome.INSERTED

    def energy(state, mode):
        q = State(*state)
        kinetic = q.x_rate**2 + q.y_rate**2 + p.inertia * q.tilt_rate**2
        springs = p.lateral_stiffness * (q.x - p.rest_x) ** 2 + (q.y - p.rest_y) ** 2
        springs += p.tilt_stiffness * (q.tilt - p.rest_tilt) ** 2
        at_edge = edge_on_side if mode.in_slot else edge_on_face
        bases = sum(
            p.contact_stiffness * contact(side, q, p).depth ** 2
            for state, contact, side in (
                (mode.face, at_edge, RIGHT_EDGE), (mode.side, edge_on_side, LEFT_EDGE),
                (mode.corner, corner_on_wall, RIGHT_EDGE), (mode.wall, corner_on_wall, LEFT_EDGE),
            )
            if state == CLOSED
        )  # fmt: skip
        return 0.5 * (kinetic + springs + bases) + p.press_force * q.y

    after = [each for each in run.steps if each.mode.dropped]
    free = next(i for i, each in enumerate(after) if each.end_mode[1:3] == (OPEN, OPEN))
    found = [energy(each.end_state, each.end_mode) for each in after[free:]]
    assert sum(each.mode.in_slot or each.mode.side for each in after[free:]) > 10
    assert np.ptp(found) < 1e-8 * max(map(abs, found))
