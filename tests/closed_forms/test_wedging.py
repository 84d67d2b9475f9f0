"""Statics of a tilted peg in a hole, and whether friction lets a contact press at all.

Two-point contact and wedging: D. E. Whitney, Quasi-static assembly of compliantly supported rigid
parts, J. Dyn. Syst. Meas. Control 104 (1982) 65-77. A peg of width d = 2a, tilted by θ in a hole of
width D = 2l, touches the edge on one side and the wall on the other at the depth h with
D = d cos θ + h sin θ, about cD/θ with c = (D - d)/D. It wedges where friction can hold it between
these two points without any outer force: for small θ below c/μ, where h > μ D, it cannot.

No run gets that far: a part with both corners in the slot has aligned, and the scene ends there; a
corner that meets the wall before has left the scene. What is tried is what these ends are found by,
the switching functions and contact rows themselves.

Painlevé's paradox: P. Painlevé (1895); the effective inverse mass of a sliding contact, n·(n - μ t)
in the metric of the masses, see D. E. Stewart, SIAM Review 42 (2000) 3-39.
"""

from math import atan, cos, radians, sin, tan

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

from model import Outcome, simulate
from model.physics.contacts import corner_on_flat, dot, edge_on_face, edge_on_side
from model.physics.geometry import bottom_corner
from model.physics.notation import RIGHT_EDGE, State
from model.solver.switching import corner_off_wall, edge_inside
from model.study.config import load_study, study_path
from model.study.independent import solve
from model.study.trials import trial_of


@pytest.fixture
def peg(device, constants):
    """(constants, state) of a peg at rest that touches the edge A2 and, with B1, the right wall."""

    def make(clearance, tilt):
        p = constants(device.replace(half_height=40.0, clearance=clearance, initial_tilt=0.0))
        along, up = np.array([cos(tilt), sin(tilt)]), np.array([-sin(tilt), cos(tilt)])

        def state(place):  # A2 on the side face, ``place`` above the mass centre
            centre = [-p.slot_half_width, 0.0] + p.half_width * along - place * up
            return State(*centre, tilt, 0.0, 0.0, 0.0)

        def gap(place):
            return p.slot_half_width - bottom_corner(RIGHT_EDGE, *state(place)[:3], p)[0]

        return p, state(brentq(gap, -p.half_height, p.half_height, xtol=1e-13))

    return make


@pytest.mark.parametrize("clearance", [0.02, 0.09])
@pytest.mark.parametrize("degrees", [2.0, 5.0, 10.0])
def test_two_point_contact_depth(peg, clearance, degrees):
    tilt = radians(degrees)
    p, q = peg(clearance, tilt)
    assert edge_on_side(q, p).depth == pytest.approx(0.0, abs=1e-12)
    wide, narrow = 2 * p.slot_half_width, 2 * p.half_width
    depth, _, _, above = edge_inside(-RIGHT_EDGE, q, p)
    assert above > 0.0  # the edge is on the side, not above it
    assert depth == pytest.approx((wide - narrow * cos(tilt)) / sin(tilt), rel=1e-12)
    # The switch that ends a run on the wall is met here: a little further in it is behind.
    # The corner must stand below the plane, else it leans on the base from above.
    below = bottom_corner(RIGHT_EDGE, q.x, q.y, q.tilt, p)[1] < 0.0
    assert (max(corner_off_wall(RIGHT_EDGE, q._replace(x=q.x + 1e-9), p)) < 0.0) is below
    assert max(corner_off_wall(RIGHT_EDGE, q._replace(x=q.x - 1e-9), p)) > 0.0


def wall_rows(q, p):
    """(normal, tangent) rows of B1 on the right wall: those of a flat, turned by 90 degrees."""
    turned = State(q.y, -q.x, q.tilt - 0.5 * np.pi, q.y_rate, -q.x_rate, q.tilt_rate)
    contact = corner_on_flat(RIGHT_EDGE, turned, p)
    return tuple((-y, x, moment) for x, y, moment in (contact.normal, contact.tangent))


def wedges(q, p, friction):
    """Whether forces at both places, within their friction cones, can balance by themselves."""
    side, (wall, along_wall) = edge_on_side(q, p), wall_rows(q, p)
    rows = np.array([side.normal, side.tangent, wall, along_wall]).T  # times (n1, T1, n2, T2)
    cones = np.array([
        [-friction, 1.0, 0.0, 0.0], [-friction, -1.0, 0.0, 0.0],
        [0.0, 0.0, -friction, 1.0], [0.0, 0.0, -friction, -1.0],
    ])  # fmt: skip
    # Balanced, with n1 = 1. Moments are of forces over lengths of 100: scaled.
    balanced = np.vstack([rows, [1.0, 0.0, 0.0, 0.0]])
    found = linprog(
        np.zeros(4), A_ub=cones, b_ub=np.zeros(4), A_eq=balanced, b_eq=[0, 0, 0, 1],
        bounds=[(0, None), (None, None)] * 2, method="highs",
    )  # fmt: skip
    return found.status == 0


@pytest.mark.parametrize("clearance", [0.0002, 0.002])
@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_wedging_limit(peg, clearance, friction):
    def margin(tilt):
        # A force along the line between the two places must lie in both cones; the edge's normal is
        # turned by the tilt toward it: θ + β <= atan μ, β the line's slope.
        p, q = peg(clearance, tilt)
        depth = edge_inside(-RIGHT_EDGE, q, p)[0]
        low = depth * cos(tilt) - 2 * p.half_width * sin(tilt)
        return atan(friction) - tilt - atan(low / (2 * p.slot_half_width))

    wide = clearance / (1 + clearance)  # c = (D - d)/D
    limit = brentq(margin, 0.5 * wide / friction, 2.0 * wide / friction)
    # To the next order θ + β is c/θ + θ/2, so that θ is later by a share θ/2μ; atan μ is μ - μ³/3.
    share = 0.5 * limit / friction
    assert limit == pytest.approx(wide / friction * (1.0 + share), rel=4.0 * share**2 + friction**2)
    for factor, expected in ((1.0 + 1e-6, True), (1.0 - 1e-6, False)):
        p, q = peg(clearance, factor * limit)
        assert wedges(q, p, friction) is expected


# --------------------------------------------------------------------------------------- Painlevé


def inverse_mass(contact, friction, inertia):
    """Least acceleration of a contact apart by a unit normal force, sliding either way."""

    def along(force):
        return dot(contact.normal, force[0], force[1], force[2] / inertia)

    return along(contact.normal) - friction * abs(along(contact.tangent))


def test_the_study_has_no_paradox():
    study = load_study(study_path())
    trial = trial_of(study, "error")
    batch = trial.batch(np.arange(trial.sets))
    rows = batch.constants(trial.settings.settings.readings)
    from model.physics.parameters import Constants  # noqa: PLC0415

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
            for other in (corner_on_flat(RIGHT_EDGE, q, p), edge_on_side(q, p)):
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
