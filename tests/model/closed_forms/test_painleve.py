"""Painlevé's paradox: whether friction lets a contact press at all.

P. Painlevé (1895); the effective inverse mass of a sliding contact, n·(n - μ t) in the metric of
the masses, see D. E. Stewart, SIAM Review 42 (2000) 3-39.
"""

from math import cos, sin

import numpy as np
import pytest

from model.physics.contacts import corner_on_flat, dot, edge_on_face, edge_on_side
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.parameters import Constants
from study.config import load_study, study_path
from verification.independent import solve
from verification.trials import trial_of
from vibralign import Outcome, simulate


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
    solution = solve(p, run.tau_align + 1.0, tolerance=1e-13)
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
