"""A tilted peg in a hole, and whether friction lets a contact press at all.

Two-point contact and wedging: D. E. Whitney, Quasi-static assembly of compliantly supported rigid
parts, J. Dyn. Syst. Meas. Control 104 (1982) 65-77. A peg of width d = 2a, tilted by θ in a hole of
width D = 2l, touches the edge on one side and the wall on the other at the depth h with
D = d cos θ + h sin θ, about cD/θ with c = (D - d)/D. It wedges where friction can hold it between
these two points without any outer force: for small θ above c/μ, where h < μ D.

The scene lies on its side. A part turned by θ - 90° shows its left side to the sky, so that A2
presses down on it, as an edge of the hole does; the flat base carries the corner B1, as the wall
across the hole does, if it is taken to lie D lower, which is a mode's ``corner_offset``. The hole
is to the left of A2: the two edges change places, and the corner B1 stands right of its edge A1.

Painlevé's paradox: P. Painlevé (1895); the effective inverse mass of a sliding contact, n·(n - μ t)
in the metric of the masses, see D. E. Stewart, SIAM Review 42 (2000) 3-39.
"""

from math import acos, atan, cos, hypot, pi, radians, sin, tan
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

from model import Outcome, Parameters, simulate
from model.events.event_functions import corner_positions, edge_inside
from model.events.friction import decide_friction
from model.physics.contacts import corner_on_flat, dot, edge_on_face, edge_on_side
from model.physics.geometry import bottom_corner
from model.physics.modes import CLOSED, OPEN, SLIP_NEGATIVE, STICKING, Mode
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.parameters import Constants
from model.study.config import load_study, study_path
from verification.independent import solve
from verification.trials import trial_of

MOUTH = 10.0  # abscissa of A2; A1 is at -MOUTH, far behind the peg's end
NARROW, STIFFNESS = 2.0, 1e6  # the peg's width d, and the stiffness of edge and wall


class Hole(NamedTuple):
    """A peg in a hole that lies on its side, from a state and in a mode."""

    parameters: Parameters
    changes: dict[str, float]
    p: Constants
    state: np.ndarray
    mode: Mode


@pytest.fixture
def hole(device, constants):
    """A tilted peg at rest in the hole, with A2 and B1 at these depths in side face and wall.

    Either ``depth_at_edge`` or ``far``, the distance of the peg into the hole, is given; the other
    follows. Only ``press`` acts on the peg, across the hole: the axial spring is weak beside the
    contacts.
    """

    def make(tilt, depth_at_edge=0.0, depth_in_wall=0.0, far=None, press=0.0, **changes):
        bare = {
            "half_width": 0.5 * NARROW, "inertia": 1.0, "initial_tilt": 0.0,
            "frequency": 0.0, "phase": 0.0,
            "lateral_stiffness": 0.0, "tilt_stiffness": 0.0, "lateral_damping": 0.0,
            "axial_damping": 0.0, "tilt_damping": 0.0, "press_force": press,
            "contact_stiffness": STIFFNESS, "contact_damping": 300.0,
        }  # fmt: skip
        peg = device.replace(**bare | changes)
        a, b, width = peg.half_width, peg.half_height, 2.0 * peg.slot_half_width
        across, along = np.array([sin(tilt), -cos(tilt)]), np.array([cos(tilt), sin(tilt)])
        if far is None:
            far = width + depth_in_wall - (2.0 * a - depth_at_edge) * cos(tilt)
            far /= sin(tilt)
        else:
            depth_at_edge = 2.0 * a - (width + depth_in_wall - far * sin(tilt)) / cos(tilt)
        centre = np.array([MOUTH, 0.0]) + (a - depth_at_edge) * across + (b - far) * along
        mode = Mode(
            RIGHT_EDGE, OPEN, CLOSED, width, True, STICKING,
            CLOSED if depth_at_edge > 0.0 else OPEN, STICKING, False,
        )  # fmt: skip
        lies = {"slot_half_width": -MOUTH, "rest_y": centre[1]}
        state = np.array([*centre, tilt - 0.5 * pi, 0.0, 0.0, 0.0])
        return Hole(peg, lies, constants(peg)._replace(**lies), state, mode)

    return make


@pytest.mark.parametrize("clearance", [0.02, 0.09])
@pytest.mark.parametrize("degrees", [2.0, 5.0, 10.0])
def test_two_point_contact_depth(stepped_run, hole, clearance, degrees):
    # The peg slides into the hole on its corner, slowly turning upright, until its side meets the
    # edge. Its mass centre goes at a constant speed: no friction, and no moment turns it.
    tilt, speed, turning = radians(degrees), 1.0, 1e-3
    press = 3.0
    half_way = 0.5 * NARROW * (1.0 + clearance - cos(tilt)) / sin(tilt)
    scene = hole(
        tilt, depth_in_wall=press / STIFFNESS, far=half_way, press=press, inertia=1e15,
        friction=0.0, clearance=clearance,
    )  # fmt: skip
    corner, _ = bottom_corner(RIGHT_EDGE, *scene.state[:3], scene.p)
    lowering = turning * (corner - scene.state[0])  # so that the corner stays at its height
    start = scene.state + [0.0, 0.0, 0.0, -speed, lowering, -turning]
    slides = scene.mode._replace(support_slip=SLIP_NEGATIVE)
    run = stepped_run(
        scene.parameters, start, slides, horizon=20.0, **scene.changes,
        until=lambda run: run.steps[-1].end_mode.side == CLOSED,
    )  # fmt: skip
    step, q = run.steps[-1], State(*run.state[-1])
    assert step.mode.side == OPEN
    wide = -bottom_corner(RIGHT_EDGE, *q[:3], scene.p)[1]  # and what the corner is in the wall
    assert wide == pytest.approx(2.0 * scene.parameters.slot_half_width, abs=1e-5)

    def depth(time):
        return (wide - NARROW * cos(tilt - turning * time)) / sin(tilt - turning * time)

    def far(time):
        now, x = tilt - turning * time, scene.state[0] - speed * time
        return (MOUTH + 0.5 * NARROW * sin(now) - x) / cos(now) + scene.p.half_height

    meets = brentq(lambda time: far(time) - depth(time), 0.0, 20.0, xtol=1e-14)
    assert step.end == pytest.approx(meets, rel=1e-9)
    assert edge_inside(-RIGHT_EDGE, corner_positions(q, scene.p), scene.p)[0] == pytest.approx(
        depth(meets), rel=1e-9
    )


@pytest.mark.parametrize(
    ("friction", "clearance"), [(0.1, 5e-4), (0.1, 2e-3), (0.3, 5e-4), (0.3, 2e-3), (0.3, 2e-2)]
)
def test_wedging_limit(stepped_run, hole, friction, clearance):
    # Pressed together between edge and wall by equal and opposite forces and let go: beyond the
    # limit the peg stays as it is for ever, below it the forces push it out.
    load = 1e-3
    wide = NARROW * (1.0 + clearance)

    # The line between the two places is h/d off the side's normal: μ d sin θ = D - d cos θ.
    limit = atan(friction) - acos((1.0 + clearance) / hypot(1.0, friction))
    # Whitney's c/μ for small θ; the next order is a share θ/2μ.
    assert limit == pytest.approx((wide - NARROW) / wide / friction, rel=limit / friction)
    for factor in (1.001, 0.999):
        # Loads in balance are as the two places' lever arms: d on the side, D on the wall.
        scene = hole(
            factor * limit, load * NARROW / STIFFNESS, load * wide / STIFFNESS,
            half_height=1.0, friction=friction, clearance=clearance,
        )  # fmt: skip
        at_rest = State(*scene.state), scene.p, scene.mode, True, True
        mode, possible = decide_friction(0.0, *at_rest)
        assert possible
        run = stepped_run(scene.parameters, scene.state, mode, horizon=2.0, **scene.changes)
        assert run.outcome is Outcome.HORIZON_REACHED
        last = run.steps[-1]
        holds = run.forces(last.end, State(*last.end_state), last.end_mode)
        if factor > 1.0:
            assert last.end_mode == scene.mode
            assert last.end_state == pytest.approx(scene.state, abs=1e-11)
            assert holds.side_load == pytest.approx(load * NARROW, rel=1e-4)
            assert holds.support_load == pytest.approx(load * wide, rel=1e-4)
        else:
            assert STICKING in (mode.support_slip, mode.side_slip)
            assert mode.side_slip != STICKING or mode.support_slip != STICKING
            assert last.end_mode.corner == OPEN
            assert last.end_state[0] > scene.state[0]  # outward, out of the hole
            assert last.end_state[3] > 0.0


# --------------------------------------------------------------------------------------- Painlevé


def inverse_mass(contact, friction, inertia):
    """Least acceleration by which a unit normal force opens a contact that slides either way."""

    def along(force):
        return dot(contact.normal, force[0], force[1], force[2] / inertia)

    return along(contact.normal) - friction * abs(along(contact.tangent))


def test_the_study_has_no_paradox():
    study = load_study(study_path())
    trial = trial_of(study, "error")
    batch = trial.batch(np.arange(trial.sets))
    rows = batch.constants(trial.settings.settings.readings)
    rng = np.random.default_rng(5)
    least = np.inf
    for row in rows[:400]:
        p = Constants(*row.tolist())
        # On the face, d = 0, at any place and tilt: 1 + (s² - μ |s| b)/I.
        worst = 1.0 - (p.friction * p.half_height) ** 2 / (4.0 * p.inertia)
        for _ in range(5):
            s, tilt = rng.uniform(-1, 1) * p.half_width, rng.uniform(-0.5, 0.5)
            c, e = cos(tilt), sin(tilt)
            x = p.slot_half_width - s * c + -p.half_height * e
            q = State(x, -s * e + p.half_height * c, tilt, 0.0, 0.0, 0.0)
            contact = edge_on_face(RIGHT_EDGE, q, p)
            assert contact.depth == pytest.approx(0.0, abs=1e-12)
            found = inverse_mass(contact, p.friction, p.inertia)
            assert found >= worst - 1e-12
            for other in (corner_on_flat(RIGHT_EDGE, q, p), edge_on_side(LEFT_EDGE, q, p)):
                assert inverse_mass(other, p.friction, p.inertia) > 0.0
        least = min(least, worst)
    assert least > 0.5


PARADOX = {"inertia": 0.3, "half_height": 4.0, "friction": 1.0, "misalignment": 0.6}


def test_where_there_is_a_paradox_a_compliant_base_still_has_one_answer(device, constants):
    # 1 + (s² - μ s b)/I = -5 at s = 0.54: on a rigid base a contact that slides this way has none.
    p = device.replace(**PARADOX)
    c = constants(p)
    q = State(p.misalignment, p.half_height, 0.0, 0.0, 0.0, 0.0)
    assert inverse_mass(edge_on_face(RIGHT_EDGE, q, c), p.friction, p.inertia) < -4.0
    run = simulate(p, horizon=10.0)
    assert np.isfinite(run.state).all()
    assert run.outcome is Outcome.ALIGNED
    solution = solve(p, run.tau_align + 1.0, tolerance=1e-10)
    assert solution.tau == pytest.approx(run.tau_align, abs=10.0 * run.tau_error)
    assert not run.sensitive


def test_the_critical_friction_is_where_the_least_inverse_mass_vanishes(device, constants):
    p = device.replace(inertia=0.3, half_height=4.0)
    critical = 2.0 * p.inertia**0.5 / p.half_height
    s = critical * p.half_height / 2.0
    c = constants(p)
    q = State(p.slot_half_width - s, p.half_height, 0.0, 0.0, 0.0, 0.0)
    found = inverse_mass(edge_on_face(RIGHT_EDGE, q, c), critical, p.inertia)
    assert found == pytest.approx(0.0, abs=1e-12)
    assert tan(atan(critical)) == pytest.approx(critical)
