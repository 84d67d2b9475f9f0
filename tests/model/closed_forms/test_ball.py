"""A ball on a base with a spring and a dashpot: restitution, impact times, accumulation of bounces.

Sources: T. Schwager and T. Pöschel, Coefficient of restitution and linear-dashpot model revisited,
Granular Matter 9 (2007) 465-469, for the restitution; the rest is elementary.
"""

from itertools import pairwise
from math import acos, atan2, exp, log, pi, sqrt

import numpy as np
import pytest

from model.physics.modes import CLOSED, OPEN, RELEASED, START
from tests.model.closed_forms.restitution import damping_for, pushing
from vibralign import Outcome

FLIGHT = START._replace(face=OPEN)


def pulling(stiffness, damping):
    """Restitution of a dashpot that also pulls, until the ball leaves the undeformed surface."""
    decay = damping / 2
    return exp(-pi * decay / sqrt(stiffness - decay**2))


def test_the_published_numbers_are_those_of_the_formulas():
    assert pulling(100.0, 1.0) == pytest.approx(0.8545, abs=5e-5)
    assert pushing(100.0, 1.0) == pytest.approx(0.8588, abs=5e-5)


@pytest.mark.parametrize("stiffness", [1e4, 1e6, 1e8])
def test_restitution_of_a_contact_that_only_pushes(stepped_run, ball, at, stiffness):
    # The damping ratio of k = 100, h = 1, on a base so stiff that the axial spring, of stiffness 1,
    # is weak beside it.
    p = ball(stiffness, sqrt(stiffness) / 10.0)
    run = stepped_run(p, at(0.0, -1.0), horizon=5.0 / sqrt(stiffness))
    (end,) = run.mode_changes("face", RELEASED, OPEN)
    # The axial spring adds 1/k to the stiffness and decelerates by 1 over a depth of 1/√k.
    assert end.end_state[4] == pytest.approx(pushing(100.0, 1.0), abs=2.0 / stiffness + 1e-10)


def test_restitution_on_the_base_of_the_paper_with_its_axial_spring(stepped_run, ball, at):
    # k = 100, h = 1, and the axial spring relaxed at the touch: while the base presses, the
    # oscillator has stiffness 101; after its force has vanished at (d, v), stiffness 1 alone.
    decay = 0.5
    omega = sqrt(101.0 - decay**2)
    # d(t) = e^(-βt) sin(ωt)/ω; k d + h ḋ = 0 is (100 - β) sin ωt + ω cos ωt = 0.
    free = (pi - atan2(omega, 100.0 - decay)) / omega
    depth = exp(-decay * free) * np.sin(omega * free) / omega
    closing = exp(-decay * free) * (np.cos(omega * free) - decay * np.sin(omega * free) / omega)
    rebound = sqrt(closing**2 + depth**2)  # energy over the way out, z'' = -z
    run = stepped_run(ball(100.0, 1.0), at(0.0, -1.0), horizon=0.6)
    (release,) = run.mode_changes("face", CLOSED, RELEASED)
    (end,) = run.mode_changes("face", RELEASED, OPEN)
    assert release.end == pytest.approx(free, abs=1e-11)
    assert end.end_state[4] == pytest.approx(rebound, abs=1e-11)
    assert rebound == pytest.approx(pushing(100.0, 1.0), abs=2e-2 * 100.0 / 101.0)


@pytest.mark.parametrize("stiffness", [1e4, 1e8])
def test_restitution_of_a_contact_that_also_pulls(stepped_run, ball, at, stiffness):
    # The vector field of the closed mode does not clamp the load: continued, the base pulls.
    p = ball(stiffness, sqrt(stiffness) / 10.0)
    run = stepped_run(p, at(0.0, -1.0), horizon=1e-9)
    out = pi / sqrt(stiffness * (1.0 - 0.05**2))
    first = run.steps[0]._replace(end=out / 8)
    for _ in range(8):  # eight steps of π/8 each, of error 1e-2 (π/8)^9 / 9!
        ((_, q),) = run.places(first, np.array([1.0]))
        first = first._replace(time=first.end, end=first.end + out / 8, state=np.array(q))
    assert q.y - run.p.half_height == pytest.approx(0.0, abs=(2.0 / stiffness + 1e-9) * out)
    assert q.y_rate == pytest.approx(pulling(100.0, 1.0), abs=2.0 / stiffness + 1e-8)


@pytest.mark.parametrize(("height", "gravity"), [(0.5, 3.0), (0.01, 1e4)])
def test_impact_time(stepped_run, ball, at, height, gravity):
    p = ball(1e4, 1.0, press_force=gravity)
    run = stepped_run(
        p, at(height), FLIGHT, horizon=10.0, until=lambda run: len(run.impacts()) == 1
    )
    # z'' = -g - z, z = height at rest: with the axial spring a cosine about -g.
    met = run.impacts()[0].end
    assert met == pytest.approx(acos(gravity / (gravity + height)), rel=1e-11)
    # Without it √(2h/g): less by a share of some h/g.
    assert met == pytest.approx(sqrt(2 * height / gravity), rel=height / gravity)


RESTITUTION = 0.6


@pytest.fixture(scope="module")
def accumulations(stepped_run, ball, at):
    """By stiffness: time of the last impact over t∞, number of impacts, and the run."""
    height, gravity = 0.01, 1e4
    limit = sqrt(2 * height / gravity) * (1 + RESTITUTION) / (1 - RESTITUTION)
    found = {}
    for stiffness in (1e9, 1e11, 1e13):
        p = ball(stiffness, damping_for(RESTITUTION, stiffness), press_force=gravity)
        run = stepped_run(p, at(height), FLIGHT, horizon=1.02 * limit)
        impacts = run.impacts()
        found[stiffness] = impacts[-1].end / limit, len(impacts), run
    return found


def test_bounces_accumulate_at_the_zeno_time_as_the_base_stiffens(accumulations):
    # Every contact lasts some π/√k, which delays the end. Bounces cease where the rebound no longer
    # lifts the ball over its static depth g/k, at v ~ g/√k, which is early by some 1/√k.
    for stiffness, (share, count, run) in accumulations.items():
        limit = run.impacts()[-1].end / share
        assert abs(share - 1.0) < count * pi / sqrt(stiffness) / limit
    assert abs(accumulations[1e13][0] - 1.0) < 2e-4


def test_the_number_of_bounces_grows_as_the_logarithm_of_the_stiffness(accumulations):
    # Bounces go on while v0 e^n > g/√k, up to a factor that depends on e alone: a hundredfold
    # stiffness makes ln(10)/ln(1/e) = 4.5 more.
    counts = [count for _, count, _ in accumulations.values()]
    more = log(10.0) / log(1.0 / RESTITUTION)
    for fewer, rest in pairwise(counts):
        assert rest - fewer == pytest.approx(more, abs=1.0)


def test_successive_rebounds_lose_the_same_share(accumulations):
    _, _, run = accumulations[1e13]
    speeds = np.array([-step.end_state[4] for step in run.impacts()])
    # The weight acts during contact, too: an error of g/(√k v), which grows by the factor 1/e.
    assert speeds[1:4] / speeds[:3] == pytest.approx(RESTITUTION, rel=1e-3)


def test_after_the_bounces_the_ball_lies_in_the_base(stepped_run, ball, at):
    # A depth of g/k, less what the axial spring takes; a damping ratio of 1/2 damps the rest.
    run = stepped_run(ball(1e4, 100.0, press_force=50.0), at(0.01), FLIGHT, horizon=1.0)
    assert run.outcome is Outcome.HORIZON_REACHED
    assert run.p.half_height - run.state[-1, 1] == pytest.approx(50.0 / (1e4 + 1.0), rel=1e-10)
